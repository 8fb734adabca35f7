#include "acoustic_channel/channel_config.hpp"

#include "acoustic_channel/access/medium_access.hpp"
#include "acoustic_channel/models/propagation_model.hpp"

namespace stg::acoustics {

void Describe(ChannelConfig* c, config::Table* t) {
  t->Section("channel");
  t->Add("model", config::Name(&c->model, PropagationModels().Names()), config::kNone, "-",
         "propagation model: range is Eq. 5, extended Eq. 6, physical a network of modems");
  t->Add("access", config::Name(&c->access, MediumAccesses().Names()), config::kNone, "-",
         "medium access: when a packet that waits in a modem leaves it");
  Describe(static_cast<RangeConfig*>(c), t);
  Describe(static_cast<PeriodicConfig*>(c), t);
  Describe(static_cast<ExtendedConfig*>(c), t);
  Describe(static_cast<PhysicalConfig*>(c), t);
}

std::optional<config::Violation> FindConflict(const ChannelConfig& c, const RunConfig& run) {
  const auto model = PropagationModels().Make(c.model, c);
  if (auto violation = model->FindConflict(c, run.agents)) return violation;
  const auto access = MakeMediumAccess(c, run);
  if (access->adapts() && !model->has_modems()) {
    return config::Violation{{"channel.access", "channel.model"},
                             "this medium access needs modems, which the model has not"};
  }
  return access->FindConflict(model->packet_time(c, run.agents));
}

void Describe(NetworkConfig* c, config::Table* t) {
  Describe(&c->run, t);
  Describe(&c->channel, t);
}

std::optional<config::Violation> FindConflict(const NetworkConfig& c) {
  if (auto violation = FindConflict(c.run)) return violation;
  return FindConflict(c.channel, c.run);
}

}  // namespace stg::acoustics
