#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "marl_trainer/learn/recorded/recorded.hpp"
#include "marl_trainer/learn/swarm/swarm_shard.hpp"
#include "stg_agent/entities/entity_draw.hpp"

namespace stg::learn {

/// A swarm when a decision is due, and the result of the decision that led there.
struct SwarmMoment {
  SwarmTruth truth;
  std::vector<Outcome> outcomes;  ///< [agents]; at the start of an episode without rewards
};

/// A command that one AUV drew.
struct SwarmCommand {
  bool recorded = false;  ///< false: it was not recorded, or its sizes do not fit the layout
  std::string policy_id;
  int command_size = 0;
  agent::EntityDecision decision;
};

/// A whole episode that a swarm flew with a policy over entities.
struct SwarmEpisode {
  std::uint32_t number = 0;
  std::string source;
  Finding finding;                     ///< flaw that was found while it was assembled
  std::vector<SwarmMoment> moments;    ///< [decisions + 1]
  std::vector<SwarmCommand> commands;  ///< [commands, agents]
};

/// Throws UserError unless swarms of this scenario can learn from recordings: it must have open
/// water, no AUV joins or leaves, and its episodes last whole commands.
void RequireRecordable(const task::JudgeConfig& scenario);

/// The first flaw of an episode for on-policy learning with `policy`, or kNone.
Finding CheckSwarmEpisode(const RunConfig& run, const SwarmEpisode& episode,
                          const agent::EntityPolicy& policy);

/// The rollout of an episode that has passed the check. It equals the rollout that SwarmShard
/// collects from the same flight, with one difference: after the last decision, SwarmShard already
/// sees the next episode, so its last reward of the band is from the wrong place.
SwarmRollout RolloutOf(const SwarmConfig& config, const task::JudgeConfig& scenario,
                       const SwarmEpisode& episode);

}  // namespace stg::learn
