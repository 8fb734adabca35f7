#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "auv_common/config/files.hpp"
#include "auv_common/error.hpp"
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

class SwarmTraining : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "swarm_test_XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
    config_.envs = 16;
    config_.horizon = 4;
    config_.segment = 2;
    config_.episode_steps = 60;
    config_.steps = 4 * 320;
    config_.minibatch = 200;
    config_.validation_episodes = 4;
    config_.validation_interval = 1;
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// True if the training came to its end.
  bool Train(const std::string& name, int workers, bool resume,
             const std::atomic<int>* stop = nullptr) const {
    SwarmTrainer::Options options;
    options.out = (folder_ / name).string();
    options.workers = workers;
    options.resume = resume;
    options.stop = stop;
    return SwarmTrainer({Waters(3), Waters(5)}, {Waters(4)}, config_, options).Run();
  }
  agent::EntityPolicy Last(const std::string& name) const {
    return agent::EntityPolicy::LoadOnnx(folder_ / name / "policy_last.onnx");
  }

  fs::path folder_;
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
  EXPECT_THROW(Blinded(config_.network, 5, "nonsense"), UserError);
}

TEST_F(SwarmTraining, TargetsAreChosenInSomeWatersByTheNetworkThatChooses) {
  config_.free_assignment = true;
  const std::string folder = config::ScenarioFolder();
  EXPECT_THROW(FieldMixture(folder, "field", config_, 16), UserError) << "pool does not choose";
  config_.network = agent::EntityNetwork::kGraph;
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

TEST_F(SwarmTraining, RefusesAFolderOfAnotherTraining) {
  config_.steps = 320;
  ASSERT_TRUE(Train("run", 1, false));
  EXPECT_THROW(Train("run", 1, false), UserError);
  EXPECT_THROW(Train("none", 1, true), UserError);
  config_.gamma = 0.5;
  EXPECT_THROW(Train("run", 1, true), UserError);
}

TEST_F(SwarmTraining, TheCriticLearnsToExplainReturns) {
  config_.horizon = 12;
  config_.learning_rate = 3e-3;
  config_.epochs = 6;
  config_.steps = 10 * 960;
  ASSERT_TRUE(Train("run", 2, false));
  std::istringstream table(TextIn(folder_ / "run/progress.csv"));
  std::string line, cell;
  std::getline(table, line);
  int column = 0;
  std::istringstream header(line);
  while (std::getline(header, cell, ',') && cell != "explained_variance") ++column;
  std::vector<double> explained;
  while (std::getline(table, line)) {
    std::istringstream cells(line);
    for (int k = 0; k <= column; ++k) std::getline(cells, cell, ',');
    explained.push_back(std::stod(cell));
  }
  ASSERT_EQ(explained.size(), 10u);
  EXPECT_GT(explained.back(), explained.front() + 0.5);
}

}  // namespace
}  // namespace stg::learn
