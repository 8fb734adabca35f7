#include "acoustic_channel/access/medium_access.hpp"

#include <algorithm>

#include "acoustic_channel/access/aloha.hpp"
#include "acoustic_channel/access/csma.hpp"
#include "acoustic_channel/access/periodic.hpp"
#include "acoustic_channel/access/slotted_aloha.hpp"
#include "acoustic_channel/access/tdma.hpp"
#include "acoustic_channel/channel_config.hpp"

namespace stg::acoustics {

MediumAccessRegistry& MediumAccesses() {
  // clang-format off
  static MediumAccessRegistry registry("medium access", {
      {"periodic", MakePeriodic},
      {"tdma", MakeTdma},
      {"aloha", MakeAloha},
      {"slotted_aloha", MakeSlottedAloha},
      {"csma", MakeCsma},
  });
  // clang-format on
  return registry;
}

std::unique_ptr<MediumAccess> MakeMediumAccess(const ChannelConfig& config, const RunConfig& run) {
  return MediumAccesses().Make(config.access, config.accesses, config, run);
}

TimeNs RoundOf(const ChannelConfig& config, const RunConfig& run) {
  const auto access = MakeMediumAccess(config, run);
  if (access->adapts()) return 0;
  access->Reset(0, 0);
  const TimeNs turn = access->Next(0, 0, {});
  return access->Next(0, turn + 1, {}) - turn;
}

double SlotOfKeys(const ChannelConfig& c) {
  return c.access == "tdma" || c.access == "slotted_aloha" ? c.slots.length_s : 0.0;
}

double RoundOfKeys(const ChannelConfig& c, int nodes) {
  return c.access == "periodic" ? c.periodic.transmit_period_s : SlotOfKeys(c) * nodes;
}

Turns::Turns(const ChannelConfig& config, const RunConfig& run)
    : access_(MakeMediumAccess(config, run)),
      period_(run.decision_period()),
      adapts_(access_->adapts()),
      memos_(static_cast<std::size_t>(run.agents)) {}

void Turns::Reset(std::uint64_t seed, std::uint32_t episode) {
  access_->Reset(seed, episode);
  std::fill(memos_.begin(), memos_.end(), Memo{});
}

void Turns::Ask(int node, TimeNs t) {
  memos_[static_cast<std::size_t>(node)] = {t, access_->Next(node, t, Attempt{})};
}

}  // namespace stg::acoustics
