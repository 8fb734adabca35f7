#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "marl_trainer/learn/swarm/swarm_recording.hpp"
#include "stg_agent/decider/decider.hpp"

namespace stg::learn {

/// The episode of a seed that the agents of an environment fly while they explore with a policy.
inline SwarmEpisode FlySwarm(const Scenario& scenario, const agent::EntityPolicy& policy,
                             std::uint64_t seed) {
  env::VectorEnvOptions o;
  o.seed = seed;
  o.envs = 1;
  // The environment starts the next episode at once. With a longer one, the end can be seen.
  Scenario longer = scenario;
  ++longer.run.time.episode_steps;
  env::VectorEnv env(longer, o);
  env::EnvMemory memory = env.MakeMemory();
  env.Reset(memory.arrays());
  agent::Decider decider;
  decider.entities = std::make_shared<const agent::EntityPolicy>(policy);
  const int n = env.agents(), size = env.action_size(), steps = scenario.run.time.episode_steps;
  std::vector<float> actions(static_cast<std::size_t>(n * size));
  SwarmEpisode episode;
  episode.source = "environment";
  for (int k = 0; k <= steps; ++k) {
    SwarmMoment moment;
    ReadTruth(env, 0, &moment.truth);
    for (int i = 0; i < n; ++i) {
      const task::Tracking<double> t = env.tracking(0, i);
      moment.outcomes.push_back(
          {memory.rewards[static_cast<std::size_t>(i)], t.distance, t.error, env.followed(0, i)});
    }
    episode.moments.push_back(moment);
    if (k == steps) break;
    for (int i = 0; i < n; ++i) {
      agent::EntityDecision decision;
      if (decider.Explore(seed, static_cast<std::uint32_t>(k), env.agent(0, i), &decision,
                          actions.data() + i * size)) {
        episode.commands.push_back(
            {true, policy.metadata().id, agent::CommandSize(policy.action()), decision});
      }
    }
    env.Step(actions.data(), memory.arrays());
  }
  return episode;
}

}  // namespace stg::learn
