// The trainer node learns with a network over entities while agents fly over the graph. What they
// record, and the network that follows from it, are the same as in the environment.

#include <auv_msgs/EntityStep.h>
#include <auv_msgs/EpisodeSummary.h>
#include <gtest/gtest.h>
#include <ros/ros.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "auv_common/error.hpp"
#include "auv_common/nodes/node_main.hpp"
#include "auv_common/nodes/parameters.hpp"
#include "auv_dynamics/nodes/topics.hpp"
#include "learn/swarm/swarm_flight.hpp"
#include "marl_trainer/learn/swarm/recorded_swarm_trainer.hpp"
#include "stg_agent/entities/entity_pilot.hpp"
#include "stg_agent/nodes/entity_messages.hpp"
#include "stg_agent/nodes/topics.hpp"

namespace stg::nodes {
namespace {

/// Largest difference of a parameter after the update. The nodes divide a wrench by the limits to
/// get the shares back, and this rounds; rewards may differ in the last digit.
constexpr double kTolerance = 1e-5;

/// What a run published: commands by episode, step and AUV; summaries of complete episodes.
struct Heard {
  std::map<std::tuple<std::uint32_t, std::uint32_t, int>, auv_msgs::EntityStep> commands;
  std::map<std::uint32_t, auv_msgs::EpisodeSummary> summaries;
};

/// Listens until the trainer has written a policy with an update, and for a second after that.
Heard Listen(int agents, const std::string& policy_file) {
  Heard run;
  ros::NodeHandle node;
  std::vector<ros::Subscriber> subscribers;
  for (int i = 0; i < agents; ++i) {
    const boost::function<void(const auv_msgs::EntityStep::ConstPtr&)> on_command =
        [&run, i](const auv_msgs::EntityStep::ConstPtr& m) {
          run.commands[{m->episode, m->step, i}] = *m;
        };
    subscribers.push_back(node.subscribe<auv_msgs::EntityStep>(
        topics::AuvTopic(i, topics::kEntityStep), 0, on_command));
  }
  const boost::function<void(const auv_msgs::EpisodeSummary::ConstPtr&)> on_summary =
      [&run](const auv_msgs::EpisodeSummary::ConstPtr& m) {
        if (m->complete) run.summaries[m->episode] = *m;
      };
  subscribers.push_back(
      node.subscribe<auv_msgs::EpisodeSummary>(topics::kEpisodeSummary, 0, on_summary));
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(45.0);
  bool updated = false;
  while (ros::ok() && ros::WallTime::now() < end && !updated) {
    HandleMessages(0.2);
    try {
      updated = agent::EntityPolicy::LoadOnnx(policy_file).metadata().training_step > 0;
    } catch (const UserError&) {
      continue;  // the trainer has not started yet
    }
  }
  EXPECT_TRUE(updated) << "no update in time";
  const ros::WallTime rest = ros::WallTime::now() + ros::WallDuration(1.0);
  while (ros::WallTime::now() < rest) HandleMessages(0.1);
  return run;
}

void ExpectSame(const auv_msgs::EntityStep& flown, const learn::SwarmCommand& expected) {
  auv_msgs::EntityStep m;
  SetDecision(expected.decision, expected.command_size, &m);
  EXPECT_EQ(flown.layout, m.layout);
  EXPECT_EQ(flown.policy_id, expected.policy_id);
  EXPECT_EQ(flown.self, m.self);
  EXPECT_EQ(flown.search, m.search);
  EXPECT_EQ(flown.targets, m.targets);
  EXPECT_EQ(flown.neighbours, m.neighbours);
  EXPECT_EQ(flown.obstacles, m.obstacles);
  EXPECT_EQ(flown.edges, m.edges);
  EXPECT_EQ(flown.choice, m.choice);
  EXPECT_EQ(flown.command, m.command);
  EXPECT_EQ(flown.log_probability, m.log_probability);
}

/// From the messages alone: z(t + 5 s) - z(t) of noise z with variance 1 has the variance
/// 2 (1 - exp(-5 / 60)) = 0.16, and independent noise has 2.
void ExpectCorrelatedNoise(const Heard& run, const agent::EntityPolicy& untrained) {
  const auto size = static_cast<std::size_t>(agent::CommandSize(untrained.action()));
  double squares = 0.0, changes = 0.0, numbers = 0.0, pairs = 0.0;
  std::map<std::pair<std::uint32_t, int>, std::pair<std::uint32_t, std::vector<double>>> last;
  for (const auto& [key, m] : run.commands) {
    if (m.policy_id.find("-recorded-0-") == std::string::npos) continue;
    agent::EntityDecision decision;
    ASSERT_TRUE(DecisionOf(m, &decision));
    float logits[agent::kMostChoices], means[agent::kMostChoices * agent::kCommandNumbers];
    untrained.Choices(decision.entities, logits, means);
    std::vector<double> z;
    for (std::size_t k = 0; k < size; ++k) {
      const float mean = means[static_cast<std::size_t>(decision.choice) * size + k];
      z.push_back(static_cast<double>(decision.command[k] - mean) /
                  std::exp(static_cast<double>(untrained.parameters().log_std[k])));
      squares += z.back() * z.back();
      numbers += 1.0;
    }
    const auto& [episode, step, id] = key;
    const auto before = last.find({episode, id});
    if (before != last.end() && before->second.first + 5 == step) {
      for (std::size_t k = 0; k < size; ++k) {
        changes += (z[k] - before->second.second[k]) * (z[k] - before->second.second[k]);
        pairs += 1.0;
      }
    }
    last[{episode, id}] = {step, z};
  }
  ASSERT_GT(pairs, 200.0);
  EXPECT_NEAR(changes / pairs, 2.0 * (1.0 - std::exp(-5.0 / 60.0)), 0.05);
  // About 40 independent numbers (AUVs x numbers x episodes), whose squares have variance 2.
  EXPECT_NEAR(squares / numbers, 1.0, 5.0 * std::sqrt(2.0 / 40.0));
}

TEST(TrainField, RecordsAndLearnsWhatTheEnvironmentDoes) {
  Scenario scenario = LoadScenarioParameters<Scenario>(config::Scope::kWhole);
  const std::string file = TextParameter("out", "") + "/policy_last.onnx";
  learn::SwarmConfig config = learn::RecordedSwarmConfig();
  config.network = agent::EntityNetworkNamed(TextParameter("network", "pool"));
  const Heard run = Listen(scenario.run.agents, file);
  ASSERT_FALSE(HasFailure());
  const agent::EntityPolicy learned = agent::EntityPolicy::LoadOnnx(file);
  config::Override(&scenario, learn::SwarmRewardKeys());

  learn::SwarmLearner learner(config);
  const std::size_t used = static_cast<std::size_t>(learned.metadata().training_step) /
                           static_cast<std::size_t>(scenario.run.time.episode_steps);
  EXPECT_GE(used, 2U);
  std::vector<learn::SwarmRollout> rollouts;
  int rows = 0;
  for (const auto& [number, summary] : run.summaries) {
    const std::string untrained = scenario.run.name + "-recorded-0-";
    if (summary.policy_id.rfind(untrained, 0) != 0 || rollouts.size() == used) continue;
    EXPECT_EQ(summary.deadline_misses, 0U);
    agent::PolicyMetadata metadata;
    metadata.id = summary.policy_id;
    const learn::SwarmEpisode episode =
        learn::FlySwarm(scenario, learner.Policy(metadata), summary.seed);
    const auto period = static_cast<std::uint32_t>(agent::DecisionsPerCommand(scenario.run));
    for (std::size_t k = 0; k < episode.commands.size(); ++k) {
      const auto n = static_cast<std::size_t>(scenario.run.agents);
      const auto step = static_cast<std::uint32_t>(k / n) * period;
      const auto found = run.commands.find({number, step, static_cast<int>(k % n)});
      ASSERT_NE(found, run.commands.end()) << "episode " << number << ", step " << step;
      ExpectSame(found->second, episode.commands[k]);
      ASSERT_FALSE(HasFailure()) << "episode " << number << ", step " << step << ", AUV " << k % n;
      rows += episode.commands[k].decision.entities.neighbours;
    }
    rollouts.push_back(learn::RolloutOf(config, scenario.judge(), episode));
  }
  ASSERT_EQ(rollouts.size(), used);
  EXPECT_GT(rows, 0) << "no AUV knew a neighbour";
  EXPECT_EQ(learned.parameters().noise_time_s, 60.0);
  ExpectCorrelatedNoise(run, learner.Policy({}));

  const std::vector<float> untrained = learner.Policy({}).parameters().numbers;
  WorkerPool pool(1);
  learner.Update(&rollouts, 0, 0.0, &pool);
  const agent::EntityPolicy policy = learner.Policy({});
  const std::vector<float>& expected = policy.parameters().numbers;
  const std::vector<float>& numbers = learned.parameters().numbers;
  ASSERT_EQ(numbers.size(), expected.size());
  double worst = 0.0, moved = 0.0;
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    worst = std::max(worst, std::abs(static_cast<double>(numbers[k] - expected[k])));
    moved = std::max(moved, std::abs(static_cast<double>(numbers[k] - untrained[k])));
  }
  std::printf("largest difference of a parameter %.3g, largest change by the update %.3g\n", worst,
              moved);
  EXPECT_LE(worst, kTolerance);
  EXPECT_GT(moved, 10.0 * kTolerance);
  for (std::size_t k = 0; k < policy.parameters().log_std.size(); ++k) {
    EXPECT_NEAR(learned.parameters().log_std[k], policy.parameters().log_std[k], kTolerance);
  }
}

}  // namespace
}  // namespace stg::nodes

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "train_field");
  ros::NodeHandle node;
  return RUN_ALL_TESTS();
}
