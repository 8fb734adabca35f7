#include "acoustic_channel/access/slotted_aloha.hpp"

#include <cmath>

#include "acoustic_channel/access/tdma.hpp"
#include "acoustic_channel/channel_config.hpp"
#include "auv_common/numbers/random.hpp"

namespace stg::acoustics {

SlottedAloha::SlottedAloha(const SlotsConfig& config)
    : config_(config), slot_(std::llround(config.length_s * 1e9)) {}

void SlottedAloha::Reset(std::uint64_t seed, std::uint32_t episode) {
  seed_ = seed;
  episode_ = episode;
}

TimeNs SlottedAloha::Next(int node, TimeNs from, const Attempt& /*attempt*/) const {
  TimeNs slot = (from + slot_ - 1) / slot_;
  if (config_.send_probability < 1.0) {
    const auto draw = [&] {
      return Random(seed_, Stream::kMediumAccess, episode_, static_cast<std::uint32_t>(slot),
                    static_cast<std::uint32_t>(node))
          .Uniform();
    };
    while (draw() >= config_.send_probability) ++slot;
  }
  return slot * slot_;
}

std::optional<config::Violation> SlottedAloha::FindConflict(const PacketTime& packet) const {
  return FindSlotConflict(config_, packet.airtime);
}

std::unique_ptr<MediumAccess> MakeSlottedAloha(const ChannelConfig& config, const RunConfig&) {
  return std::make_unique<SlottedAloha>(config.slots);
}

}  // namespace stg::acoustics
