#include <gtest/gtest.h>

#include "algorithms/game.hpp"
#include "learn/draw.hpp"

/// IPPO equals MAPPO with every AUV as a swarm of one.
namespace stg::learn {
namespace {

/// Repeats the numbers of environments [envs] for each of their AUVs [envs, agents].
template <class T>
std::vector<T> ToEachAuv(const std::vector<T>& of_envs, std::size_t agents) {
  std::vector<T> sent;
  for (const T& x : of_envs) sent.insert(sent.end(), agents, x);
  return sent;
}

TEST(Ippo, IsMappoOfSwarmsOfOneWithTheTeamsReward) {
  constexpr int kEnvs = 6, kSteps = 4, kAgents = 3, kRows = kEnvs * kAgents;
  constexpr int kSeen = 2, kState = 5;
  Problem swarm;
  swarm.agents = kAgents;
  swarm.observation_size = kSeen;
  swarm.state_size = kState;
  Problem single = swarm;
  single.agents = 1;
  single.state_size = kSeen;
  WorkerPool pool(1);
  const TrainSetup ippo_setup = GameSetup("ippo", {{"minibatch", 8}});
  const TrainSetup mappo_setup = GameSetup("mappo", {{"minibatch", 8 * kAgents}});
  const auto ippo = ippo_setup.own->Make(ippo_setup.common, swarm, &pool);
  const auto mappo = mappo_setup.own->Make(mappo_setup.common, single, &pool);
  unsigned seed = 0;
  for (std::uint32_t number = 0; number < 3; ++number) {
    Collection collection;
    collection.number = number;
    collection.steps = kSteps;
    collection.shards = {{0, kEnvs}};
    ippo->Begin(collection);
    collection.shards = {{0, kRows}};
    mappo->Begin(collection);
    for (int t = 0; t < kSteps; ++t) {
      const std::vector<float> seen = Draw(kRows * kSeen, 1.0F, ++seed);
      const std::vector<float> next_seen = Draw(kRows * kSeen, 1.0F, ++seed);
      const std::vector<float> final_seen = Draw(kRows * kSeen, 1.0F, ++seed);
      const std::vector<float> states = Draw(kEnvs * kState, 1.0F, ++seed);
      const std::vector<float> team = Draw(kEnvs, 1.0F, ++seed), own = Draw(kRows, 1.0F, ++seed);
      std::vector<std::uint8_t> truncated(kEnvs, 0);
      truncated[number + static_cast<std::size_t>(t)] = 1;
      // The draws also differ in shards that do not begin with the first environment.
      std::vector<float> actions(kRows), log_prob(kRows), same(kRows), same_log_prob(kRows);
      DrawKeys keys{7, number, static_cast<std::uint32_t>(t), 2};
      Decision decision;
      decision.envs = kEnvs;
      decision.observations = seen.data();
      decision.explore = &keys;
      ippo->Act(decision, {actions.data(), log_prob.data()});
      keys.first_env *= kAgents;
      decision.envs = kRows;
      mappo->Act(decision, {same.data(), same_log_prob.data()});
      EXPECT_EQ(actions, same);
      EXPECT_EQ(log_prob, same_log_prob);
      Transition transition;
      transition.step = t;
      transition.envs = kEnvs;
      transition.observations = seen.data();
      transition.states = transition.next_states = transition.final_states = states.data();
      transition.actions = actions.data();
      transition.log_prob = log_prob.data();
      transition.rewards = own.data();
      transition.team_rewards = team.data();
      transition.truncated = truncated.data();
      transition.next_observations = next_seen.data();
      transition.final_observations = final_seen.data();
      ippo->Observe(transition);
      const std::vector<float> sent = ToEachAuv(team, kAgents);
      const std::vector<std::uint8_t> sent_truncated = ToEachAuv(truncated, kAgents);
      transition.envs = kRows;
      transition.states = seen.data();
      transition.team_rewards = sent.data();
      transition.truncated = sent_truncated.data();
      transition.next_states = next_seen.data();
      transition.final_states = final_seen.data();
      mappo->Observe(transition);
    }
    EXPECT_EQ(ippo->Update({}).values, mappo->Update({}).values);
  }
  Archive one, other;
  ippo->Save(&one);
  mappo->Save(&other);
  EXPECT_TRUE(one == other);
}

}  // namespace
}  // namespace stg::learn
