#include <gtest/gtest.h>

#include <cstring>

#include "auv_common/error.hpp"
#include "env/env_fixture.hpp"
#include "stg_agent/entities/entity_pilot.hpp"
#include "stg_env/env/controller.hpp"
#include "stg_env/env/evaluation.hpp"

/// Policies over entities, flown.
namespace stg::env {
namespace {

/// A policy whose commands are `bias` always, or, with a spread, depend on all it sees.
std::shared_ptr<const agent::EntityPolicy> PolicyOf(agent::EntityAction action, double spread,
                                                    double bias = 0.0) {
  agent::EntityPolicy::Parameters p;
  p.action = action;
  const agent::PoolBlocks blocks(agent::EntityActorSpec(agent::CommandSize(action)));
  p.numbers.resize(blocks.size);
  Random random(3, Stream::kInit, 0, 0, 0);
  for (float& x : p.numbers) x = static_cast<float>(spread * random.Normal());
  for (int k = 0; k < blocks.head.bias.rows; ++k) {
    p.numbers[blocks.head.bias.offset + static_cast<std::size_t>(k)] += static_cast<float>(bias);
  }
  p.log_std.assign(static_cast<std::size_t>(agent::CommandSize(action)), -1.0F);
  return std::make_shared<agent::EntityPolicy>(p);
}

std::vector<double> Decided(const Controller& c, TestEnv* env) {
  std::vector<double> a(static_cast<std::size_t>(env->envs() * env->agents() * env->action_size()));
  Decide(c, *env, env->memory.observations.data(), a.data());
  return a;
}

TEST(EntityFlight, CommandsOfZeroAreEncircleBitForBit) {
  const Scenario s = Short(Shipped("field", "combined_stress"), 120);
  Controller guided, law;
  guided.entities = PolicyOf(agent::EntityAction::kGuidance, 0.0);
  law = MakeController("encircle", s.model());
  TestEnv env(s);
  env.Reset();
  for (int k = 0; k < 110; ++k) {
    const std::vector<double> ours = Decided(guided, &env), theirs = Decided(law, &env);
    ASSERT_EQ(std::memcmp(ours.data(), theirs.data(), ours.size() * sizeof(double)), 0) << k;
    env.VectorEnv::Step(ours.data(), env.memory.arrays());
  }
}

TEST(EntityFlight, EveryNumberOfACommandChangesTheFlight) {
  const Scenario s = Short(Shipped("field"), 60);
  for (const agent::EntityAction action :
       {agent::EntityAction::kGuidance, agent::EntityAction::kCourse3}) {
    TestEnv env(s);
    env.Reset();
    // On the circle, where all of them matter.
    Controller law = MakeController("encircle", s.model());
    for (int k = 0; k < 50; ++k) {
      env.VectorEnv::Step(Decided(law, &env).data(), env.memory.arrays());
    }
    const agent::AgentView view = env.agent(0, 1);
    float zero[agent::kCommandNumbers] = {}, neutral[3], changed[3];
    agent::TakeCommand(view, action, zero);
    agent::FollowCommand(view, action, neutral);
    for (int k = 0; k < agent::CommandSize(action); ++k) {
      bool differs = false;
      for (const float value : {-0.9F, 0.9F}) {
        float command[agent::kCommandNumbers] = {};
        command[k] = value;
        agent::TakeCommand(view, action, command);
        agent::FollowCommand(view, action, changed);
        differs = differs || std::memcmp(neutral, changed, sizeof changed) != 0;
      }
      EXPECT_TRUE(differs) << agent::EntityActionName(action) << " " << k;
    }
  }
}

TEST(EntityFlight, ACommandLastsFiveSecondsAndAnEpisodeStartsWithANewOne) {
  const Scenario s = Short(Shipped("field"), 20);
  Controller c;
  c.entities = PolicyOf(agent::EntityAction::kGuidance, 0.2);
  TestEnv env(s);
  env.Reset();
  for (int episode = 0; episode < 2; ++episode) {
    for (int k = 0; k < 20; ++k) {
      EXPECT_EQ(agent::CommandDue(env.agent(0, 0).memory()), k % 5 == 0) << k;
      env.VectorEnv::Step(Decided(c, &env).data(), env.memory.arrays());
    }
  }
}

TEST(EntityFlight, OneFileFliesSwarmsOfOneToTwentyAndIsTheSameOnAnyBlock) {
  Controller c;
  c.entities = PolicyOf(agent::EntityAction::kGuidance, 0.2);
  for (const int agents : {1, 2, 8, 20}) {
    const Scenario s = Short(Shipped("field", "nominal", {"agents=" + std::to_string(agents)}), 30);
    EvaluationOptions o;
    o.episodes = 4;
    const auto metrics = Evaluate(s, c, o, nullptr);
    ASSERT_EQ(metrics.size(), 4u);
    EXPECT_TRUE(std::isfinite(metrics.front().episode_return));
    o.block = 8;
    EXPECT_EQ(Evaluate(s, c, o, nullptr).front().episode_return, metrics.front().episode_return);
  }
}

TEST(EntityFlight, NeedsWhatAnAuvFindsOutByItself) {
  const Scenario s = Short(Shipped("medium", "nominal", {"mode=truth"}), 20);
  Controller c;
  c.entities = PolicyOf(agent::EntityAction::kGuidance, 0.0);
  TestEnv env(s);
  env.Reset();
  EXPECT_THROW(Decided(c, &env), UserError);
}

}  // namespace
}  // namespace stg::env
