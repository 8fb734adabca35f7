#include "acoustic_channel/channel_config.hpp"

#include <algorithm>
#include <utility>

#include "acoustic_channel/access/medium_access.hpp"
#include "acoustic_channel/models/propagation_model.hpp"
#include "auv_common/names.hpp"

namespace stg::acoustics {

void Describe(ChannelConfig* c, config::Table* t) {
  t->Section("channel");
  t->Add("model", config::Name(&c->model, PropagationModels().Names()), config::kNone, "-",
         "propagation model: range (Eq. 5), extended (Eq. 6), physical (a network of modems)");
  t->Add("access", config::Name(&c->access, MediumAccesses().Names()), config::kNone, "-",
         "medium access: the rule that decides when a modem sends a waiting packet");
  t->Add("range_m", &c->range_m, config::Positive(1e6), "m",
         "communication range R_c of Eq. 5, for the model range and for links in the mode truth");
  const auto describe = [](auto* options, config::Table* table) { Describe(options, table); };
  const auto model = [c] { return std::vector<std::string>{c->model}; };
  // A registered model may read the range, too.
  std::vector<std::string> by_range = PropagationModels().Names();
  for (const char* other : {"extended", "physical"}) {
    by_range.erase(std::find(by_range.begin(), by_range.end(), other));
  }
  // Files state it also for other models, because a command may choose `range` or the mode truth.
  t->Own("channel.range_m", {"propagation model", by_range, "channel.model", model, {}, true});
  const auto of_model = [&](const char* name) {
    return config::Owner{"propagation model", {name}, "channel.model", model};
  };
  t->Thing(of_model("range"), "channel.range", &c->range, describe);
  t->Thing(of_model("extended"), "channel.extended", &c->extended, describe);
  t->Thing(of_model("physical"), "channel.physical", &c->physical, describe);
  PropagationModels().Describe("channel", "channel.model", model, &c->models, t);

  const auto access = [c] { return std::vector<std::string>{c->access}; };
  const auto of_access = [&](std::vector<std::string> names) {
    return config::Owner{"medium access", std::move(names), "channel.access", access};
  };
  t->Thing(of_access({"periodic"}), "channel.periodic", &c->periodic, describe);
  t->Thing(of_access({"tdma", "slotted_aloha"}), "channel.slots", &c->slots, describe);
  t->Thing(of_access({"slotted_aloha"}), "channel.slots", &c->slots, DescribeDraw);
  t->Thing(of_access({"aloha", "csma"}), "channel.contention", &c->contention, describe);
  t->Thing(of_access({"csma"}), "channel.contention", &c->contention, DescribeBackoff);
  MediumAccesses().Describe("channel", "channel.access", access, &c->accesses, t);

  t->Moved("channel.transmit_period_s", "channel.periodic.transmit_period_s");
  for (const char* key : {"sound_speed_mps", "max_range_m", "attenuation_per_m", "loss_probability",
                          "loss_distance_m", "freshness_s"}) {
    t->Moved(std::string("channel.") + key, std::string("channel.extended.") + key);
  }
  for (const char* section : {"modem", "water", "noise", "propagation"}) {
    t->Moved(std::string("channel.") + section, std::string("channel.physical.") + section);
  }
}

std::optional<config::Violation> FindConflict(const ChannelConfig& c, const RunConfig& run) {
  const auto model = PropagationModels().Make(c.model, c.models, c);
  if (auto violation = model->FindConflict(c, run.agents)) return violation;
  const auto access = MakeMediumAccess(c, run);
  if (access->adapts() && !model->has_modems()) {
    return config::Violation{{"channel.access", "channel.model"},
                             "this medium access needs a model with modems, such as physical"};
  }
  return access->FindConflict(model->packet_time(c, run.agents));
}

void OwnByScenarios(const ChannelConfig* c, bool files_may, config::Table* t) {
  config::Owner ranged{"propagation model",
                       Without(PropagationModels().Names(), {"extended", "physical"}),
                       "channel.model", [c] { return std::vector<std::string>{c->model}; }};
  ranged.files_state_all = files_may;
  t->Own("channel.range_m", ranged);
  const auto own = [&](const std::string& key, const char* kind, std::vector<std::string> names) {
    config::Owner owner{kind, std::move(names), "scenario",
                        [] { return std::vector<std::string>(); }};
    owner.refusal = "belongs to scenarios, and this program runs the network alone";
    owner.files_state_all = files_may;
    t->Own(key, owner);
  };
  own("channel.physical.propagation.shadow_db", "sea", {"terrain", "obstacles"});
  for (const char* key : {"time.episode_steps", "time.tail_steps"})
    own(key, "run", {"in episodes"});
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
