#include "acoustic_channel/access/periodic.hpp"

#include <algorithm>
#include <cmath>

#include "acoustic_channel/channel_config.hpp"

namespace stg::acoustics {

void Describe(PeriodicConfig* c, config::Table* t) {
  t->Add("transmit_period_s", &c->transmit_period_s, config::Positive(1e4), "s",
         "each AUV sends one packet per period, at a time of its own in the period; at least one "
         "decision");
}

Periodic::Periodic(const PeriodicConfig& config, const RunConfig& run)
    : transmit_period_s_(config.transmit_period_s),
      decision_s_(run.decision_dt_s()),
      period_(run.decision_period()),
      slots_(static_cast<TimeNs>(std::max(1.0, std::round(transmit_period_s_ / decision_s_)))) {}

std::optional<config::Violation> Periodic::FindConflict(const PacketTime& /*packet*/) const {
  if (transmit_period_s_ >= decision_s_ * (1.0 - 1e-9)) return {};
  return config::Violation{
      {"channel.periodic.transmit_period_s", "time.dt_s", "time.decision_steps"},
      "an AUV sends at most one packet per decision, so the period cannot be shorter than a "
      "decision"};
}

TimeNs Periodic::Next(int node, TimeNs from, const Attempt& /*attempt*/) const {
  const TimeNs decision = (from + period_ - 1) / period_;
  return (decision + (node + slots_ - decision % slots_) % slots_) * period_;
}

std::unique_ptr<MediumAccess> MakePeriodic(const ChannelConfig& config, const RunConfig& run) {
  return std::make_unique<Periodic>(config.periodic, run);
}

}  // namespace stg::acoustics
