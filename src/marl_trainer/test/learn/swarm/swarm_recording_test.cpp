#include "marl_trainer/learn/swarm/swarm_recording.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <sstream>

#include "auv_common/config/files.hpp"
#include "auv_common/config/loader.hpp"
#include "auv_common/error.hpp"
#include "auv_common/testing/temporary_folder.hpp"
#include "learn/swarm/swarm_flight.hpp"
#include "marl_trainer/learn/swarm/recorded_swarm_trainer.hpp"

/// Learning of swarms from recordings, compared with learning in environments.
namespace stg::learn {
namespace {

namespace fs = std::filesystem;

constexpr int kFlightSteps = 40, kFlightCommands = 8;

class SwarmRecording : public ::testing::Test {
 protected:
  void SetUp() override {
    config_ = RecordedSwarmConfig();
    config_.minibatch = 20;
  }

  static Scenario Short(const std::string& name = "field", int agents = 3) {
    std::vector<std::string> overrides{"agents=" + std::to_string(agents),
                                       "time.episode_steps=" + std::to_string(kFlightSteps),
                                       "time.tail_steps=20"};
    // AUVs of many8 start anywhere in an area.
    if (name != "many8") overrides.push_back("reset.stages.medium.auv_distance_m=[80, 150]");
    return LoadNamedScenario(config::ScenarioFolder(), name, "nominal", overrides);
  }
  std::unique_ptr<RecordedSwarmTrainer> Trainer(const std::string& name,
                                                const SwarmStart& start = {}) {
    RecordedSwarmTrainer::Options options;
    options.out = (folder_ / name).string();
    options.log = &log_;
    return std::make_unique<RecordedSwarmTrainer>(scenario_, config_, start, options);
  }

  Scenario scenario_ = Short();
  SwarmConfig config_;
  const TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
  std::ostringstream log_;
};

std::vector<float> Without(std::vector<float> numbers, int last) {
  numbers.resize(numbers.size() - static_cast<std::size_t>(last));
  return numbers;
}

void ExpectNear(const std::vector<float>& a, const std::vector<float>& b, double tolerance,
                const std::string& what) {
  ASSERT_EQ(a.size(), b.size()) << what;
  for (std::size_t k = 0; k < a.size(); ++k) ASSERT_NEAR(a[k], b[k], tolerance) << what << k;
}

// The collector evaluates the network for many AUVs at once, an agent for itself. Sums of another
// order differ in the last digits.
TEST_F(SwarmRecording, ARecordedFlightGivesTheRolloutAndTheUpdateOfTheCollector) {
  constexpr double kTolerance = 2e-4;
  using agent::EntityNetwork;
  // The shard has the random numbers of the first episode, so it also draws the same noise.
  for (const auto& [network, noise_time_s] :
       {std::pair{EntityNetwork::kPool, 0.0}, std::pair{EntityNetwork::kPool, 60.0},
        std::pair{EntityNetwork::kGraph, 0.0}, std::pair{EntityNetwork::kGraph, 60.0}}) {
    const bool free = network == agent::EntityNetwork::kGraph;
    scenario_ = Short(free ? "many8" : "field", free ? 4 : 3);
    config_.network = network;
    config_.horizon = kFlightCommands;
    config_.episode_steps = kFlightSteps;
    config_.noise_time_s = noise_time_s;
    const std::string name = agent::EntityNetworkName(network) + std::to_string(noise_time_s);
    const auto trainer = Trainer(name);
    SwarmLearner learner(config_);
    SwarmShard shard(env::EnvFactory(trainer->scenario()), config_, 0, 1, 1);
    std::vector<SwarmRollout> collected(1);
    shard.Collect(0, learner.actor(), collected.data());

    const SwarmEpisode episode =
        FlySwarm(trainer->scenario(), trainer->policy(), TrainingSeed(config_.seed));
    ASSERT_EQ(trainer->Check(episode).flaw, Flaw::kNone) << trainer->Check(episode).where;
    SwarmRollout rollout = RolloutOf(config_, trainer->scenario().judge(), episode);
    SwarmRollout& expected = collected[0];
    EXPECT_EQ(rollout.choices, expected.choices);
    EXPECT_EQ(rollout.done, expected.done);
    EXPECT_EQ(rollout.final_of, expected.final_of);
    EXPECT_EQ(rollout.actor.rows(), expected.actor.rows());
    for (int s = 0; s < 3; ++s) {
      EXPECT_EQ(rollout.actor.offset(s, rollout.actor.rows()),
                expected.actor.offset(s, expected.actor.rows()));
    }
    ExpectNear(rollout.commands, expected.commands, kTolerance, name + " command ");
    ExpectNear(rollout.log_prob, expected.log_prob, kTolerance, name + " log probability ");
    // The rewards of the last command differ in the reward of the band, as the header says.
    const int n = scenario_.run.agents;
    ExpectNear(Without(rollout.own, n), Without(expected.own, n), kTolerance, name + " own ");
    ExpectNear(Without(rollout.rewards, n), Without(expected.rewards, n), kTolerance,
               name + " reward ");
    double most = 0.0;
    for (const float r : rollout.own) most = std::max(most, std::abs(static_cast<double>(r)));
    EXPECT_GT(most, 0.01);

    // The same learner on the same numbers gives the same network, bit for bit. Here these are the
    // numbers of the collector.
    std::copy(rollout.own.end() - n, rollout.own.end(), expected.own.end() - n);
    std::copy(rollout.rewards.end() - n, rollout.rewards.end(), expected.rewards.end() - n);
    WorkerPool pool(1);
    learner.Update(&collected, 0, 0.0, &pool);
    trainer->Update({episode});
    const agent::EntityPolicy updated = learner.Policy({});
    ExpectNear(trainer->policy().parameters().numbers, updated.parameters().numbers, 1e-3,
               name + " parameter ");
    EXPECT_NE(updated.parameters().numbers, SwarmLearner(config_).Policy({}).parameters().numbers);

    SwarmLearner again(config_);
    std::vector<SwarmRollout> recorded{rollout};
    again.Update(&recorded, 0, 0.0, &pool);
    EXPECT_EQ(trainer->policy().parameters().numbers, again.Policy({}).parameters().numbers);
    EXPECT_EQ(trainer->policy().parameters().log_std, again.Policy({}).parameters().log_std);
  }
}

TEST_F(SwarmRecording, FlawsAreFound) {
  const auto trainer = Trainer("run");
  const SwarmEpisode good = FlySwarm(trainer->scenario(), trainer->policy(), 5);
  EXPECT_EQ(trainer->Check(good).flaw, Flaw::kNone);
  const auto flaw = [&](auto change) {
    SwarmEpisode bad = good;
    change(&bad);
    return trainer->Check(bad).flaw;
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(flaw([](auto* e) { e->commands[4].recorded = false; }), Flaw::kGap);
  EXPECT_EQ(flaw([](auto* e) { e->commands[4].command_size = 3; }), Flaw::kAction);
  EXPECT_EQ(flaw([](auto* e) { e->commands[4].decision.choice = 1; }), Flaw::kAction);
  EXPECT_EQ(flaw([](auto* e) { e->commands[4].policy_id = "another"; }), Flaw::kForeignPolicy);
  EXPECT_EQ(flaw([](auto* e) { e->commands[4].decision.command[1] += 1.0F; }),
            Flaw::kLogProbability);
  EXPECT_EQ(flaw([](auto* e) { e->commands[4].decision.entities.self[3] = kNan; }),
            Flaw::kNotFinite);
  EXPECT_EQ(flaw([](auto* e) { e->moments[7].truth.p_WB[1].x = kNan; }), Flaw::kNotFinite);
}

TEST_F(SwarmRecording, TrainingGoesOnFromItsFolder) {
  const auto whole = Trainer("whole");
  const SwarmEpisode first = FlySwarm(whole->scenario(), whole->policy(), 1);
  whole->Update({first});
  auto halves = Trainer("halves");
  halves->Update({first});
  halves.reset();
  halves = Trainer("halves");
  EXPECT_EQ(halves->policy_id(), whole->policy_id());
  EXPECT_EQ(halves->env_steps(), kFlightSteps);
  const SwarmEpisode second = FlySwarm(whole->scenario(), whole->policy(), 2);
  whole->Update({second});
  halves->Update({second});
  EXPECT_EQ(halves->policy().parameters().numbers, whole->policy().parameters().numbers);
  EXPECT_EQ(halves->policy_id(), whole->policy_id());
  halves.reset();
  config_.network = agent::EntityNetwork::kGraph;
  EXPECT_THROW(Trainer("halves"), UserError);
}

// Agents that have a policy of this identity keep it.
TEST_F(SwarmRecording, APolicyThatExploresDifferentlyHasAnotherIdentity) {
  std::vector<std::string> ids;
  for (const double noise_time_s : {0.0, 20.0, 60.0}) {
    config_.noise_time_s = noise_time_s;
    const auto trainer = Trainer("time" + std::to_string(noise_time_s));
    EXPECT_EQ(trainer->policy().parameters().noise_time_s, noise_time_s);
    EXPECT_EQ(std::count(ids.begin(), ids.end(), trainer->policy_id()), 0);
    ids.push_back(trainer->policy_id());
  }
}

TEST_F(SwarmRecording, TheAverageIsTheMeanOverTheLastUpdates) {
  config_.average = 2.0;
  const auto trainer = Trainer("run");
  std::vector<std::vector<float>> numbers;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    trainer->Update({FlySwarm(trainer->scenario(), trainer->policy(), seed)});
    numbers.push_back(trainer->policy().parameters().numbers);
  }
  // Of two updates each weighs a half; the older ones fade by a half with each update.
  std::vector<float> expected(numbers[0].size());
  for (std::size_t k = 0; k < expected.size(); ++k) {
    expected[k] = 0.25F * numbers[0][k] + 0.25F * numbers[1][k] + 0.5F * numbers[2][k];
  }
  const agent::EntityPolicy average = agent::EntityPolicy::LoadOnnx(trainer->average_path());
  ExpectNear(average.parameters().numbers, expected, 1e-6, "average ");
  EXPECT_NE(average.parameters().numbers, numbers[2]);
  EXPECT_NE(average.metadata().id, trainer->policy_id());
  EXPECT_EQ(average.parameters().noise_time_s, config_.noise_time_s);
}

TEST_F(SwarmRecording, StartsFromAPolicyAndTeachesItsCriticFirst) {
  config_.network = agent::EntityNetwork::kGraph;
  const auto trained = Trainer("trained");
  trained->Update({FlySwarm(trained->scenario(), trained->policy(), 1)});
  SwarmConfig config = RecordedSwarmConfig();
  const SwarmStart start = ReadSwarmStart(trained->policy_path(), &config);
  EXPECT_EQ(config.network, agent::EntityNetwork::kGraph);
  RecordedSwarmTrainer::Options options;
  options.out = (folder_ / "next").string();
  options.critic_updates = 1;
  RecordedSwarmTrainer next(scenario_, config, start, options);
  EXPECT_EQ(next.policy().parameters().numbers, trained->policy().parameters().numbers);
  EXPECT_EQ(next.policy().parameters().log_std, trained->policy().parameters().log_std);
  Archive before, after;
  next.learner().Save(&before);
  next.Update({FlySwarm(scenario_, next.policy(), 2)});
  next.learner().Save(&after);
  EXPECT_EQ(next.policy().parameters().numbers, trained->policy().parameters().numbers);
  EXPECT_NE(before.Floats("critic"), after.Floats("critic"));
  next.Update({FlySwarm(scenario_, next.policy(), 3)});
  EXPECT_NE(next.policy().parameters().numbers, trained->policy().parameters().numbers);
}

TEST_F(SwarmRecording, RefusesWhatDoesNotFit) {
  SwarmConfig config;
  const std::string policies = config::ScenarioFolder() + "/../policies/";
  const auto message = [](const auto& act) -> std::string {
    try {
      act();
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  };
  const auto read = [&](const std::string& path) {
    return message([&] { ReadSwarmStart(path, &config); });
  };
  EXPECT_NE(read(policies + "medium.onnx").find("another observation layout"), std::string::npos);
  EXPECT_NE(read(folder_.string()).find("holds no checkpoint"), std::string::npos);
  EXPECT_NE(read("/nonexistent.onnx").find("no such policy file"), std::string::npos);
  EXPECT_EQ(read(policies + "field.onnx"), "");
  const auto recordable = [&](const Scenario& s) {
    return message([&] { RequireRecordable(s.judge()); });
  };
  EXPECT_NE(recordable(LoadNamedScenario(config::ScenarioFolder(), "medium")).find("open water"),
            std::string::npos);
  EXPECT_NE(recordable(LoadNamedScenario(config::ScenarioFolder(), "many8_deaths")).find("fleet"),
            std::string::npos);
  Scenario odd = Short();
  odd.run.time.episode_steps = 41;
  EXPECT_NE(recordable(odd).find("whole number of commands"), std::string::npos);
}

}  // namespace
}  // namespace stg::learn
