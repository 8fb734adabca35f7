#include <gtest/gtest.h>

#include <cstring>

#include "auv_common/error.hpp"
#include "env/env_fixture.hpp"
#include "stg_agent/entities/entity_pilot.hpp"
#include "stg_env/env/decide.hpp"
#include "stg_env/env/evaluation.hpp"

/// Flights of policies over entities.
namespace stg::env {
namespace {

/// A policy. Without a spread its commands are 0. With a spread they depend on all that it sees.
std::shared_ptr<const agent::EntityPolicy> PolicyOf(
    agent::EntityAction action, double spread,
    agent::EntityNetwork network = agent::EntityNetwork::kPool) {
  agent::EntityPolicy::Parameters p;
  p.action = action;
  p.network = network;
  p.numbers.resize(agent::EntityParameters(network, agent::CommandSize(action)));
  Random random(3, Stream::kInit, 0, 0, 0);
  for (float& x : p.numbers) x = static_cast<float>(spread * random.Normal());
  p.log_std.assign(static_cast<std::size_t>(agent::CommandSize(action)), -1.0F);
  return std::make_shared<agent::EntityPolicy>(p);
}

std::vector<double> Decided(const agent::Decider& c, TestEnv* env) {
  std::vector<double> a(static_cast<std::size_t>(env->envs() * env->agents() * env->action_size()));
  Decide(c, *env, env->memory.observations.data(), a.data());
  return a;
}

/// Returns the first of so many steps at which two deciders act differently, or -1. It flies two
/// copies of the same waters, because a law that searches writes its plan into the agent.
int FirstDifference(const agent::Decider& a, const agent::Decider& b, const Scenario& s,
                    int steps) {
  TestEnv env(s), other(s);
  env.Reset();
  other.Reset();
  for (int k = 0; k < steps; ++k) {
    const std::vector<double> ours = Decided(a, &env), theirs = Decided(b, &other);
    if (std::memcmp(ours.data(), theirs.data(), ours.size() * sizeof(double)) != 0) return k;
    env.VectorEnv::Step(ours.data(), env.memory.arrays());
    other.VectorEnv::Step(theirs.data(), other.memory.arrays());
  }
  return -1;
}

/// Commands of zero must give exactly the actions of `law`.
void ExpectZerosAre(agent::EntityAction action, const std::string& law, const Scenario& s,
                    agent::EntityNetwork network = agent::EntityNetwork::kPool) {
  agent::Decider guided;
  guided.entities = PolicyOf(action, 0.0, network);
  EXPECT_EQ(FirstDifference(guided, agent::MakeDecider(law, s.model()), s, 110), -1) << law;
}

TEST(EntityFlight, CommandsOfZeroAreEncircleBitForBit) {
  ExpectZerosAre(agent::EntityAction::kGuidance, "encircle",
                 Short(Shipped("field", "combined_stress"), 120));
}

TEST(EntityFlight, CommandsOfZeroAreTheLawOfTheSituationBitForBit) {
  const struct {
    const char *law, *scenario, *condition;
  } cases[] = {{"encircle", "field", "nominal"},
               {"formation", "field", "fast_target"},
               {"search_map", "field", "combined_stress"},
               {"search_map", "search", "nominal"},
               {"assign", "many8", "nominal"}};
  for (const auto& c : cases) {
    ExpectZerosAre(agent::EntityAction::kLaw5, c.law, Short(Shipped(c.scenario, c.condition), 120));
  }
  ExpectZerosAre(agent::EntityAction::kLaw5, "search_map", Short(Shipped("search"), 60),
                 agent::EntityNetwork::kGraph);
}

/// The defaults of `search_map` depend on the speed of the target and on the period of the sensor,
/// which is 5 s in `search` and 30 s in `sparse`.
TEST(EntityFlight, DefaultsOfTheSearchFitTargetAndSensor) {
  const auto first = [](const Scenario& s, const std::string& law) {
    return FirstDifference(agent::MakeDecider("search_map", s.model()),
                           agent::MakeDecider(law, s.model()), s, s.run.time.episode_steps);
  };
  const Scenario search = Short(Shipped("search"), 1500);
  EXPECT_EQ(first(search, "search_map:form=0,give-up=30"), -1);
  EXPECT_GT(first(search, "search_map:form=1,give-up=30"), 0);
  const Scenario sparse = Short(Shipped("field", "sparse"), 1500);
  EXPECT_EQ(first(sparse, "search_map:form=1,give-up=180"), -1);
  EXPECT_GT(first(sparse, "search_map:form=0,give-up=180"), 0);
  EXPECT_GT(first(sparse, "search_map:form=1,give-up=30"), 0);
}

TEST(EntityFlight, WhileItSearchesACommandTurnsTheCourse) {
  const Scenario s = Short(Shipped("search"), 60);
  TestEnv env(s);
  env.Reset();
  const agent::Decider law = agent::MakeDecider("search_map", s.model());
  for (int k = 0; k < 30; ++k) {
    env.VectorEnv::Step(Decided(law, &env).data(), env.memory.arrays());
  }
  const auto course_of = [&env](float phase) {
    const float command[agent::kCommandNumbers] = {0.0F, 0.0F, phase, 0.0F, 0.0F};
    float action[3];
    agent::TakeCommand(env.agent(0, 0), agent::EntityAction::kLaw5, command);
    agent::FollowCommand(env.agent(0, 0), agent::EntityAction::kLaw5, action);
    return std::atan2(static_cast<double>(action[1]), static_cast<double>(action[0]));
  };
  // 0.5 stands for 30 deg. The rule that keeps AUVs apart may change the turn a little.
  EXPECT_NEAR(std::remainder(course_of(0.5F) - course_of(0.0F), 2.0 * kPi), kPi / 6.0, 0.05);
}

TEST(EntityFlight, APolicyThatChoosesToSearchLeavesATargetThatIsSeen) {
  const Scenario s = Short(Shipped("search"), 60);
  TestEnv env(s);
  env.Reset();
  const agent::AgentView view = env.agent(0, 0);
  agent::Entities entities;
  entities.targets = 1;
  entities.target_of_row[0] = 0;
  agent::TakeChoice(view, entities, 0);
  EXPECT_FALSE(view.memory().search);
  agent::TakeChoice(view, entities, 1);
  EXPECT_TRUE(view.memory().search);
  entities.targets = 0;  // there is no target to leave
  agent::TakeChoice(view, entities, 0);
  EXPECT_FALSE(view.memory().search);
}

TEST(EntityFlight, EveryNumberOfACommandChangesTheFlight) {
  for (const agent::EntityAction action :
       {agent::EntityAction::kGuidance, agent::EntityAction::kLaw5, agent::EntityAction::kCourse3,
        agent::EntityAction::kVelocity3}) {
    const bool walls = action == agent::EntityAction::kVelocity3;
    const Scenario s = Short(Shipped(walls ? "medium" : "field"), 60);
    TestEnv env(s);
    env.Reset();
    // The AUVs fly to the circle first, because all numbers matter there.
    agent::Decider law = agent::MakeDecider(walls ? "pursuit" : "encircle", s.model());
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
  agent::Decider c;
  c.entities = PolicyOf(agent::EntityAction::kGuidance, 0.2);
  TestEnv env(s);
  env.Reset();
  for (int episode = 0; episode < 2; ++episode) {
    for (int k = 0; k < 20; ++k) {
      const agent::EntityMemory& memory = env.agent(0, 0).memory();
      EXPECT_EQ(agent::CommandDue(memory, agent::EntityAction::kGuidance), k % 5 == 0) << k;
      EXPECT_TRUE(agent::CommandDue(memory, agent::EntityAction::kVelocity3)) << k;
      env.VectorEnv::Step(Decided(c, &env).data(), env.memory.arrays());
    }
  }
}

/// Flies `pursuit`, whose velocity is far below the limits near the target. As commands of
/// velocity3 it must be the same flight, although the AUVs have turned in the meantime.
TEST(EntityFlight, AVelocityIsTheSameAsACommandAheadToPortAndUp) {
  const Scenario s = Short(Shipped("hard", "nominal", {"control.heading=along_velocity"}), 200);
  const agent::Decider pursuit = agent::MakeDecider("pursuit:cap=0.3", s.model());
  TestEnv env(s);
  env.Reset();
  double turned = 0.0;
  for (int k = 0; k < 100; ++k) {
    const std::vector<double> wanted = Decided(pursuit, &env);
    const agent::AgentView view = env.agent(0, 2);
    float command[agent::kCommandNumbers] = {}, action[3];
    agent::VelocityCommandOf(view, &wanted[6], command);
    agent::TakeCommand(view, agent::EntityAction::kVelocity3, command);
    agent::FollowCommand(view, agent::EntityAction::kVelocity3, action);
    for (std::size_t a = 0; a < 3; ++a) {
      EXPECT_NEAR(action[a], wanted[6 + a], 1e-6) << "step " << k << ", axis " << a;
    }
    turned = std::max(turned, std::abs(view.knowledge().trig.sin_psi));
    env.VectorEnv::Step(wanted.data(), env.memory.arrays());
  }
  EXPECT_GT(turned, 0.1) << "the heading must matter";
}

/// A command straight ahead moves the AUV along its heading.
TEST(EntityFlight, ACommandAheadMovesAlongTheHeading) {
  const Scenario s = Short(Shipped("medium", "nominal", {"control.heading=along_velocity"}), 60);
  const agent::Decider pursuit = agent::MakeDecider("pursuit", s.model());
  TestEnv env(s);
  env.Reset();
  for (int k = 0; k < 30; ++k) {
    env.VectorEnv::Step(Decided(pursuit, &env).data(), env.memory.arrays());
  }
  const agent::AgentView view = env.agent(0, 0);
  const float ahead[agent::kCommandNumbers] = {0.2F, 0.0F, 0.0F, 0.0F, 0.0F};
  float action[3];
  agent::TakeCommand(view, agent::EntityAction::kVelocity3, ahead);
  agent::FollowCommand(view, agent::EntityAction::kVelocity3, action);
  const auto& most = s.model().vehicle.max_velocity_mps;
  const agent::Knowledge<double>& k = view.knowledge();
  const double x = static_cast<double>(action[0]) * most[0],
               y = static_cast<double>(action[1]) * most[1];
  EXPECT_NEAR(std::hypot(x, y), 0.2 * 0.75 * most[0], 1e-6);
  EXPECT_NEAR(std::atan2(y, x), std::atan2(k.trig.sin_psi, k.trig.cos_psi), 1e-5);
  EXPECT_GT(std::abs(k.trig.sin_psi), 0.1) << "the heading must matter";
  EXPECT_EQ(action[2], 0.0F);
}

TEST(EntityFlight, AnActionFliesWhereItIsMeantFor) {
  const agent::AgentModel walls = Shipped("medium").model(), open = Shipped("field").model();
  for (const std::string& name : agent::EntityActionNames()) {
    const auto policy = PolicyOf(agent::EntityActionNamed(name), 0.0);
    const bool velocity = name == "velocity3";
    EXPECT_NO_THROW(policy->RequireFits(velocity ? walls : open)) << name;
    EXPECT_THROW(policy->RequireFits(velocity ? open : walls), UserError) << name;
  }
}

TEST(EntityFlight, OneFileFliesSwarmsOfOneToTwentyAndIsTheSameOnAnyBlock) {
  agent::Decider field, walls;
  field.entities = PolicyOf(agent::EntityAction::kGuidance, 0.2);
  walls.entities = PolicyOf(agent::EntityAction::kVelocity3, 0.2);
  for (const int agents : {1, 2, 8, 20, -1, -12}) {
    const std::string count = "agents=" + std::to_string(std::abs(agents));
    const Scenario s = Short(Shipped(agents > 0 ? "field" : "hard", "nominal", {count}), 30);
    const agent::Decider& c = agents > 0 ? field : walls;
    EvaluationOptions o;
    o.episodes = 4;
    const auto metrics = Evaluate(EnvFactory(s), c, o, nullptr);
    ASSERT_EQ(metrics.size(), 4u);
    EXPECT_TRUE(std::isfinite(metrics.front().episode_return));
    o.block = 8;
    EXPECT_EQ(Evaluate(EnvFactory(s), c, o, nullptr).front().episode_return,
              metrics.front().episode_return);
  }
}

TEST(EntityFlight, NeedsWhatAnAuvFindsOutByItself) {
  const Scenario s = Short(Shipped("medium", "nominal", {"mode=truth"}), 20);
  agent::Decider c;
  c.entities = PolicyOf(agent::EntityAction::kGuidance, 0.0);
  TestEnv env(s);
  env.Reset();
  EXPECT_THROW(Decided(c, &env), UserError);
}

}  // namespace
}  // namespace stg::env
