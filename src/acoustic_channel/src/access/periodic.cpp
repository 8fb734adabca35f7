#include "acoustic_channel/access/periodic.hpp"

#include <algorithm>
#include <cmath>

#include "acoustic_channel/channel/channel_config.hpp"

namespace stg::acoustics {

void Describe(PeriodicConfig* c, config::Table* t) {
  t->Add("transmit_period_s", &c->transmit_period_s, config::Positive(1e4), "s",
         "periodic: every AUV sends one packet per period, staggered; at least one decision");
}

std::optional<config::Violation> FindConflict(const PeriodicConfig& c, const RunConfig& run) {
  if (c.transmit_period_s < run.decision_dt_s() * (1.0 - 1e-9)) {
    return config::Violation{{"channel.transmit_period_s", "time.dt_s", "time.decision_steps"},
                             "an AUV sends at most one packet per decision"};
  }
  return {};
}

Periodic::Periodic(const PeriodicConfig& config, const RunConfig& run)
    : period_(run.decision_period()),
      slots_(static_cast<TimeNs>(
          std::max(1.0, std::round(config.transmit_period_s / run.decision_dt_s())))) {}

void Periodic::Plan(TimeNs from, TimeNs /*until*/, std::vector<TimeNs>* start) const {
  std::fill(start->begin(), start->end(), kNever);
  const TimeNs slot = from / period_ % slots_;
  for (auto node = static_cast<std::size_t>(slot); node < start->size();
       node += static_cast<std::size_t>(slots_)) {
    (*start)[node] = from;
  }
}

std::unique_ptr<MediumAccess> MakePeriodic(const ChannelConfig& config, const RunConfig& run) {
  return std::make_unique<Periodic>(config, run);
}

}  // namespace stg::acoustics
