#include "marl_trainer/learn/algorithms/ippo/ippo.hpp"

#include <cassert>

#include "auv_common/error.hpp"
#include "marl_trainer/learn/train_config.hpp"

namespace stg::learn {
namespace {

/// Each AUV as a swarm of one, which has only the AUV's own observation.
Problem Single(const Problem& swarm) {
  Problem single = swarm;
  single.agents = 1;
  single.state_size = swarm.observation_size;
  return single;
}

/// Keeps the number of environment steps per gradient step. Each of them is one sample for every
/// AUV.
MappoConfig PerAgent(const IppoConfig& config, int agents) {
  MappoConfig single = config;
  single.minibatch *= agents;
  return single;
}

}  // namespace

void IppoConfig::ApplyRecordings(const TrainConfig&) {
  throw UserError("ippo does not learn from recordings: they lack the last observations");
}

std::unique_ptr<Algorithm> IppoConfig::Make(const TrainConfig& common, const Problem& problem,
                                            const Team& team) const {
  return std::make_unique<Ippo>(*this, common, problem, team);
}

Ippo::Ippo(const IppoConfig& config, const TrainConfig& common, const Problem& problem,
           const Team& team)
    : agents_(problem.agents),
      single_(PerAgent(config, problem.agents), common, Single(problem), team) {}

void Ippo::Begin(const Collection& collection) {
  Collection singles = collection;
  row_values_.resize(collection.shards.size());
  for (std::size_t s = 0; s < singles.shards.size(); ++s) {
    Shard& shard = singles.shards[s];
    shard.first_env *= agents_;
    shard.envs *= agents_;
    row_values_[s].rewards.resize(static_cast<std::size_t>(shard.envs));
    row_values_[s].truncated.resize(static_cast<std::size_t>(shard.envs));
  }
  single_.Begin(singles);
}

void Ippo::Act(const Decision& decision, const Actions& out) {
  Decision single = decision;
  single.envs *= agents_;
  if (decision.explore == nullptr) {
    single_.Act(single, out);
    return;
  }
  DrawKeys keys = *decision.explore;
  keys.first_env *= agents_;
  single.explore = &keys;
  single_.Act(single, out);
}

void Ippo::Observe(const Transition& t) {
  assert(t.final_observations != nullptr);
  RowValues& values = row_values_[static_cast<std::size_t>(t.shard)];
  for (int row = 0; row < t.envs * agents_; ++row) {
    values.rewards[static_cast<std::size_t>(row)] = t.team_rewards[row / agents_];
    values.truncated[static_cast<std::size_t>(row)] = t.truncated[row / agents_];
  }
  Transition single = t;
  single.envs *= agents_;
  single.states = t.observations;
  single.rewards = single.team_rewards = values.rewards.data();
  single.truncated = values.truncated.data();
  single.next_states = t.next_observations;
  single.final_states = t.final_observations;
  single_.Observe(single);
}

}  // namespace stg::learn
