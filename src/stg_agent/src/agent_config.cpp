#include "stg_agent/agent_config.hpp"

#include <string>

#include "acoustic_channel/models/propagation_model.hpp"
#include "stg_agent/estimation/target_filter.hpp"
#include "stg_agent/packet/packet.hpp"

namespace stg::agent {

void Describe(TaskConfig* c, config::Table* t) {
  t->Section("task");
  t->Add("desired_distance_m", &c->desired_distance_m, config::NonNegative(1e4), "m",
         "desired distance d* from the target");
  t->Add("lost_distance_m", &c->lost_distance_m, config::Positive(1e5), "m",
         "farther from the target than this, it counts as lost");
  t->AddOptional("lost_error_m", &c->lost_error_m, "0.0", config::NonNegative(1e5), "m",
                 "in open water a target whose own estimate is off by more counts as lost, too; 0: "
                 "no matter how far off");
  t->Moved("reward.desired_distance_m", "task.desired_distance_m");
  t->Moved("reward.lost_distance_m", "task.lost_distance_m");
}

void Describe(AgentConfig* c, config::Table* t) {
  Describe(static_cast<dynamics::WorldConfig*>(c), t);
  Describe(&c->channel, t);
  Describe(&c->track, t);
  Describe(&c->observation, t);
  Describe(&c->task, t);
}

std::optional<config::Violation> FindConflict(const AgentConfig& c) {
  if (auto violation = FindConflict(static_cast<const dynamics::WorldConfig&>(c))) {
    return violation;
  }
  if (auto violation = FindConflict(c.channel, c)) return violation;
  if (acoustics::MaxPayload(c.channel, c.agents) < kPacketBytes) {
    return config::Violation{
        {"channel.modem.packet_bytes", "channel.modem.profile"},
        "the packet of an agent has " + std::to_string(kPacketBytes) + " bytes"};
  }
  if (auto violation = FindFilterConflict(c)) return violation;
  if (c.observation.quality_medium > c.observation.quality_high) {
    return config::Violation{{"observation.quality_medium", "observation.quality_high"},
                             "medium quality cannot begin above high quality"};
  }
  return {};
}

}  // namespace stg::agent
