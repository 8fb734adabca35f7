#include "acoustic_channel/access/medium_access.hpp"

#include "acoustic_channel/access/periodic.hpp"
#include "acoustic_channel/channel_config.hpp"

namespace stg::acoustics {

MediumAccessRegistry& MediumAccesses() {
  // clang-format off
  static MediumAccessRegistry registry("medium access", {
      {"periodic", MakePeriodic},
  });
  // clang-format on
  return registry;
}

std::unique_ptr<MediumAccess> MakeMediumAccess(const ChannelConfig& config, const RunConfig& run) {
  return MediumAccesses().Make(config.access, config, run);
}

Turns::Turns(const ChannelConfig& config, const RunConfig& run)
    : access_(MakeMediumAccess(config, run)),
      period_(run.decision_period()),
      start_(static_cast<std::size_t>(run.agents), kNever) {}

void Turns::Reset(std::uint64_t seed, std::uint32_t episode) {
  access_->Reset(seed, episode);
  planned_ = kNever;
}

void Turns::Plan(TimeNs t) {
  access_->Plan(t, t + period_, &start_);
  planned_ = t;
}

}  // namespace stg::acoustics
