#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "auv_common/config/files.hpp"
#include "auv_common/error.hpp"
#include "auv_common/testing/temporary_folder.hpp"
#include "marl_trainer/learn/swarm/swarm_trainer.hpp"

/// Small trainings with swarms of several sizes.
namespace stg::learn {
namespace {

namespace fs = std::filesystem;

std::string TextIn(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

SwarmTask Waters(int agents) {
  return {std::to_string(agents),
          LoadNamedScenario(
              config::ScenarioFolder(), "field", "nominal",
              {"agents=" + std::to_string(agents), "time.episode_steps=60", "time.tail_steps=60"})};
}

SwarmTask Basin(int agents) {
  return {std::to_string(agents),
          LoadNamedScenario(
              config::ScenarioFolder(), "medium", "nominal",
              {"agents=" + std::to_string(agents), "time.episode_steps=60", "time.tail_steps=60"})};
}

class SwarmTraining : public ::testing::Test {
 protected:
  void SetUp() override {
    config_.envs = 16;
    config_.horizon = 4;
    config_.segment = 2;
    config_.episode_steps = 60;
    config_.steps = 4 * 320;
    config_.minibatch = 200;
    config_.validation_episodes = 4;
    config_.validation_interval = 1;
  }

  /// True if the training came to its end.
  bool Train(const std::string& name, int workers, bool resume,
             const std::atomic<int>* stop = nullptr) const {
    SwarmTrainer::Options options;
    options.out = (folder_ / name).string();
    options.workers = workers;
    options.resume = resume;
    options.stop = stop;
    if (config_.action == agent::EntityAction::kVelocity3) {
      return SwarmTrainer({Basin(3), Basin(5)}, {Basin(4)}, config_, options).Run();
    }
    return SwarmTrainer({Waters(3), Waters(5)}, {Waters(4)}, config_, options).Run();
  }
  agent::EntityPolicy Last(const std::string& name) const {
    return agent::EntityPolicy::LoadOnnx(folder_ / name / "policy_last.onnx");
  }

  /// A column of the training's progress.
  std::vector<double> Column(const std::string& name, const std::string& column) const {
    std::istringstream table(TextIn(folder_ / name / "progress.csv"));
    std::string line, cell;
    std::getline(table, line);
    int before = 0;
    std::istringstream header(line);
    while (std::getline(header, cell, ',') && cell != column) ++before;
    std::vector<double> numbers;
    while (std::getline(table, line)) {
      std::istringstream cells(line);
      for (int k = 0; k <= before; ++k) std::getline(cells, cell, ',');
      numbers.push_back(std::stod(cell));
    }
    return numbers;
  }

  const TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
  SwarmConfig config_;
};

TEST_F(SwarmTraining, DoesNotDependOnTheNumberOfWorkers) {
  const std::pair<agent::EntityAction, agent::EntityNetwork> cases[] = {
      {agent::EntityAction::kGuidance, agent::EntityNetwork::kPool},
      {agent::EntityAction::kCourse3, agent::EntityNetwork::kPool},
      {agent::EntityAction::kLaw5, agent::EntityNetwork::kGraph}};
  for (const auto& [action, network] : cases) {
    config_.action = action;
    config_.network = network;
    const std::string name = agent::EntityActionName(action);
    EXPECT_TRUE(Train(name + "_one", 1, false));
    EXPECT_TRUE(Train(name + "_three", 3, false));
    const agent::EntityPolicy policy = Last(name + "_one");
    EXPECT_EQ(policy.parameters().numbers, Last(name + "_three").parameters().numbers);
    EXPECT_EQ(policy.metadata().training_step, config_.steps);
    EXPECT_EQ(policy.metadata().action_interface, name);
  }
}

/// Between walls: a command for each decision, and a controller to imitate.
TEST_F(SwarmTraining, BetweenWallsItImitatesAControllerAndDependsOnNoWorkers) {
  config_.action = agent::EntityAction::kVelocity3;
  config_.imitation.controller = "pursuit_separated";
  config_.imitation.steps = 1'000'000'000;
  config_.imitation.privileged = true;
  config_.noise_time_s = 0.0;
  config_.log_std = -4.5;
  config_.least_log_std = -8.0;
  config_.horizon = 20;
  config_.learning_rate = 3e-3;
  config_.steps = 40 * 320;
  config_.validation_interval = 100;
  EXPECT_TRUE(Train("one", 1, false));
  EXPECT_TRUE(Train("three", 3, false));
  EXPECT_EQ(Last("one").parameters().numbers, Last("three").parameters().numbers);
  const std::vector<double> misses = Column("one", "imitation_error");
  ASSERT_EQ(misses.size(), 40u);
  EXPECT_LT(misses.back(), 0.2 * misses.front());
  // Imitation alone changes no deviation of the exploration.
  EXPECT_EQ(Last("one").parameters().log_std[0], -4.5F);
}

TEST_F(SwarmTraining, WithHalfAnImitationBothLossesCount) {
  config_.action = agent::EntityAction::kVelocity3;
  config_.noise_time_s = 0.0;
  ASSERT_TRUE(Train("alone", 1, false));
  config_.imitation.controller = "pursuit_separated";
  config_.imitation.steps = 1'000'000'000;
  config_.imitation.share = 0.5;
  ASSERT_TRUE(Train("half", 1, false));
  config_.imitation.privileged = true;
  ASSERT_TRUE(Train("privileged", 1, false));
  EXPECT_NE(Last("alone").parameters().numbers, Last("half").parameters().numbers);
  EXPECT_NE(Last("half").parameters().numbers, Last("privileged").parameters().numbers);
  EXPECT_NE(Last("half").parameters().log_std, std::vector<float>(3, -2.0F)) << "MAPPO counts, too";
}

TEST_F(SwarmTraining, TheMixtureBetweenWallsHasPoorLinksAndBothStages) {
  const std::string folder = config::ScenarioFolder();
  EXPECT_THROW(WallsMixture(folder, {"medium", "hard"}, config_, 16), UserError)
      << "law5 needs open water";
  config_.imitation.controller = "pursuit";
  config_.imitation.steps = 1;
  EXPECT_THROW(FieldMixture(folder, "field", config_, 16), UserError) << "law5 imitates nothing";
  config_.action = agent::EntityAction::kVelocity3;
  EXPECT_THROW(WallsMixture(folder, {"field"}, config_, 16), UserError) << "no walls";
  int far = 0, poor = 0;
  for (const SwarmTask& task : WallsMixture(folder, {"medium", "hard"}, config_, 16)) {
    const Scenario& s = task.scenario;
    far += s.run.name == "hard" ? 1 : 0;
    poor += s.channel.extended.loss_probability > 0.1 ? 1 : 0;
    EXPECT_NEAR(s.reward.separation_distance_m, 1.06 * 0.022, 1e-6);
    EXPECT_EQ(s.run.time.episode_steps, config_.episode_steps);
  }
  EXPECT_EQ(far, 8);
  EXPECT_GE(poor, 8);
}

TEST_F(SwarmTraining, ResumedEqualsUninterruptedBitForBit) {
  config_.network = agent::EntityNetwork::kGraph;
  ASSERT_TRUE(Train("whole", 1, false));
  // It must end from the start on, so it ends at the first checkpoint.
  const std::atomic<int> stop{1};
  EXPECT_FALSE(Train("halves", 1, false, &stop));
  EXPECT_LT(Last("halves").metadata().training_step, config_.steps);
  ASSERT_TRUE(Train("halves", 1, true));
  EXPECT_EQ(Last("whole").parameters().numbers, Last("halves").parameters().numbers);
  EXPECT_EQ(TextIn(folder_ / "whole/config.json"), TextIn(folder_ / "halves/config.json"));
}

TEST_F(SwarmTraining, WhatAnAblationHidesChangesNoCommand) {
  config_.steps = 320;
  for (const auto network : {agent::EntityNetwork::kPool, agent::EntityNetwork::kGraph}) {
    config_.network = network;
    const std::string name = agent::EntityNetworkName(network);
    for (const std::string without : {"nothing", "neighbours"}) {
      config_.without = without;
      ASSERT_TRUE(Train(name + without, 2, false));
      const agent::EntityPolicy policy = Last(name + without);
      agent::Entities few = {}, many = {};
      few.targets = many.targets = 1;
      many.neighbours = 5;
      std::fill_n(many.neighbour[0], 5 * agent::kNeighbourNumbers, 0.5F);
      std::fill_n(many.edge[0][0], 5 * agent::kEdgeNumbers, 0.5F);
      many.self[agent::kSelfNeighbours] = 0.6F;
      float ours[agent::kCommandNumbers] = {}, theirs[agent::kCommandNumbers] = {};
      policy.Command(few, ours);
      policy.Command(many, theirs);
      float most = 0.0F;
      for (int k = 0; k < agent::kCommandNumbers; ++k) {
        most = std::max(most, std::abs(ours[k] - theirs[k]));
      }
      EXPECT_EQ(most < 1e-6F, without != "nothing") << name << " " << most;  // means are rounded
    }
  }
  EXPECT_THROW(Blinded(config_.network, 5, "nonsense", false), UserError);
}

TEST_F(SwarmTraining, TargetsAreChosenInSomeWatersByTheNetworkThatChooses) {
  config_.free_assignment = true;
  const std::string folder = config::ScenarioFolder();
  EXPECT_THROW(FieldMixture(folder, "field", config_, 16), UserError) << "pool does not choose";
  config_.network = agent::EntityNetwork::kGraph;
  EXPECT_THROW(FieldMixture(folder, "field", config_, 3), UserError) << "nothing to choose";
  int free = 0;
  for (const SwarmTask& task : FieldMixture(folder, "field", config_, 16)) {
    free += task.scenario.agent.task.free() ? 1 : 0;
    EXPECT_LE(task.scenario.run.agents, 8);
    EXPECT_LE(task.scenario.world.target.count, 2);
  }
  EXPECT_EQ(free, 4);
  config_.free_assignment = false;
  for (const SwarmTask& task : FieldMixture(folder, "field", config_, 16)) {
    EXPECT_FALSE(task.scenario.agent.task.free()) << task.name;
  }
  for (const int inside : {1, 2}) EXPECT_EQ(ShareOfBand(true, inside), 1.0);
  EXPECT_EQ(ShareOfBand(true, 8), 0.25);
  EXPECT_EQ(ShareOfBand(false, 8), 1.0);
  EXPECT_EQ(ShareCovered({5, 0}), 0.5);
  EXPECT_EQ(ShareCovered({1, 2, 3}), 2.5 / 3.0);
}

TEST_F(SwarmTraining, ThePolicyIsTheMeanOverTheLastUpdates) {
  config_.average = 1.0;
  config_.steps = 320;
  ASSERT_TRUE(Train("first", 1, false));
  config_.steps = 2 * 320;
  config_.last_learning_rate = config_.learning_rate;
  ASSERT_TRUE(Train("second", 1, false));
  config_.average = 2.0;
  ASSERT_TRUE(Train("mean", 1, false));
  const std::vector<float> first = Last("first").parameters().numbers,
                           second = Last("second").parameters().numbers,
                           mean = Last("mean").parameters().numbers;
  EXPECT_NE(first, second);
  for (std::size_t k = 0; k < mean.size(); ++k) {
    EXPECT_NEAR(mean[k], 0.5F * (first[k] + second[k]), 1e-6F);
  }
}

TEST_F(SwarmTraining, NothingIsLearntFromAnAuvThatHasLeft) {
  config_.steps = 2 * 320;
  SwarmTrainer::Options options;
  options.out = (folder_ / "run").string();
  options.workers = 1;
  const auto waters = [](int agents) {
    return SwarmTask{std::to_string(agents),
                     LoadNamedScenario(config::ScenarioFolder(), "field", "nominal",
                                       {"agents=" + std::to_string(agents), "time.episode_steps=60",
                                        "time.tail_steps=60", "fleet.leave=[[20, 0]]"})};
  };
  ASSERT_TRUE(SwarmTrainer({waters(3), waters(5)}, {Waters(4)}, config_, options).Run());
  const std::vector<double> rows = Column("run", "rows");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0], 8 * 4 * (3 + 5));
  // The first episodes last 15, 30, 45 and 60 s, in four environments each. In the second
  // collection, from 20 s on, AUV 0 is away during 1, 2, 4 and 4 of the four commands.
  EXPECT_EQ(rows[1], 8 * 4 * (3 + 5) - 4 * (1 + 2 + 4 + 4));
}

TEST_F(SwarmTraining, AuvsLeaveAndJoinInAQuarterOfTheWaters) {
  int changing = 0;
  for (const SwarmTask& task : FieldMixture(config::ScenarioFolder(), "field", config_, 16)) {
    changing += task.scenario.agent.fleet.changes() ? 1 : 0;
  }
  EXPECT_EQ(changing, 4);
  config_.leaving = false;
  for (const SwarmTask& task : FieldMixture(config::ScenarioFolder(), "field", config_, 16)) {
    EXPECT_FALSE(task.scenario.agent.fleet.changes()) << task.name;
  }
}

TEST_F(SwarmTraining, RefusesToStartFromAPolicyThatSeesMore) {
  config_.steps = 320;
  config_.last_command = true;
  ASSERT_TRUE(Train("sees", 1, false));
  SwarmTrainer::Options options;
  options.workers = 1;
  options.start_from = (folder_ / "sees").string();
  const auto start = [&](const std::string& name) {
    options.out = (folder_ / name).string();
    SwarmTrainer({Waters(3), Waters(5)}, {Waters(4)}, config_, options);
  };
  EXPECT_NO_THROW(start("all"));
  config_.last_command = false;
  EXPECT_THROW(start("less"), UserError);
}

TEST_F(SwarmTraining, RefusesAFolderOfAnotherTraining) {
  config_.steps = 320;
  ASSERT_TRUE(Train("run", 1, false));
  EXPECT_THROW(Train("run", 1, false), UserError);
  EXPECT_THROW(Train("none", 1, true), UserError);
  config_.gamma = 0.5;
  EXPECT_THROW(Train("run", 1, true), UserError);
}

TEST_F(SwarmTraining, TwoTrainingsDoNotWriteIntoOneFolder) {
  SwarmTrainer::Options options;
  options.out = (folder_ / "run").string();
  const SwarmTrainer first({Waters(3), Waters(5)}, {Waters(4)}, config_, options);
  EXPECT_THROW(SwarmTrainer({Waters(3), Waters(5)}, {Waters(4)}, config_, options), UserError);
}

TEST_F(SwarmTraining, TheCriticLearnsToExplainReturns) {
  config_.horizon = 12;
  config_.learning_rate = 3e-3;
  config_.epochs = 6;
  config_.steps = 10 * 960;
  ASSERT_TRUE(Train("run", 2, false));
  const std::vector<double> explained = Column("run", "explained_variance");
  ASSERT_EQ(explained.size(), 10u);
  EXPECT_GT(explained.back(), explained.front() + 0.5);
}

}  // namespace
}  // namespace stg::learn
