#include "acoustic_channel/channel_config.hpp"

#include "acoustic_channel/access/medium_access.hpp"
#include "acoustic_channel/models/propagation_model.hpp"

namespace stg::acoustics {

void Describe(ChannelConfig* c, config::Table* t) {
  t->Section("channel");
  t->Add("model", config::Name(&c->model, PropagationModels().Names()), config::kNone, "-",
         "propagation model: range is Eq. 5, extended Eq. 6");
  t->Add("access", config::Name(&c->access, MediumAccesses().Names()), config::kNone, "-",
         "medium access: when a packet that waits in a modem leaves it");
  Describe(static_cast<RangeConfig*>(c), t);
  Describe(static_cast<PeriodicConfig*>(c), t);
  Describe(static_cast<ExtendedConfig*>(c), t);
}

std::optional<config::Violation> FindConflict(const ChannelConfig& c, const RunConfig& run) {
  return MakeMediumAccess(c, run)->FindConflict();
}

void Describe(NetworkConfig* c, config::Table* t) {
  Describe(static_cast<RunConfig*>(c), t);
  Describe(&c->channel, t);
}

std::optional<config::Violation> FindConflict(const NetworkConfig& c) {
  if (auto violation = FindConflict(static_cast<const RunConfig&>(c))) return violation;
  return FindConflict(c.channel, c);
}

}  // namespace stg::acoustics
