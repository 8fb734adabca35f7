#include "marl_trainer/learn/trainer.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "auv_common/config/files.hpp"
#include "auv_common/error.hpp"
#include "marl_trainer/scenario/scenario.hpp"

namespace stg::learn {
namespace {

namespace fs = std::filesystem;

/// Two small collections per episode of 40 decisions.
TrainConfig SmallConfig() {
  TrainConfig c;
  c.envs = 32;
  c.horizon = 20;
  c.minibatch = 160;
  c.epochs = 2;
  c.stagger = false;
  c.actor_hidden = {16, 16};
  c.critic_hidden = {16};
  c.validation_episodes = 4;
  c.validation_interval = 2560;
  c.checkpoint_interval = 1280;
  c.steps = 5120;
  return c;
}

Scenario ShortScenario(const std::string& name = "medium_release") {
  return LoadNamedScenario(config::ScenarioFolder(), name, "nominal",
                           {"time.episode_steps=40", "time.tail_steps=10"});
}

std::string Bytes(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

class TrainerTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "trainer_test_XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }

  Trainer::Options Options(const std::string& name, int workers = 1) {
    Trainer::Options options;
    options.out = (folder_ / name).string();
    options.workers = workers;
    options.log = &log_;
    return options;
  }

  fs::path folder_;
  std::ostringstream log_;
};

void ExpectSameBits(const TrainState& a, const TrainState& b) {
  const auto same = [](const auto& x, const auto& y) {
    return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])) == 0;
  };
  EXPECT_TRUE(same(a.parameters, b.parameters));
  EXPECT_TRUE(same(a.adam.first, b.adam.first));
  EXPECT_TRUE(same(a.adam.second, b.adam.second));
  EXPECT_EQ(a.adam.steps, b.adam.steps);
  EXPECT_EQ(a.env_steps, b.env_steps);
  EXPECT_EQ(a.round, b.round);
  EXPECT_EQ(a.best_return, b.best_return);
}

TEST_F(TrainerTest, WeightsDoNotDependOnTheNumberOfWorkers) {
  for (const char* name : {"medium_release", "medium"}) {
    const Scenario scenario = ShortScenario(name);
    Trainer one(scenario, SmallConfig(), Options(std::string(name) + "1", 1));
    Trainer two(scenario, SmallConfig(), Options(std::string(name) + "2", 2));
    Trainer three(scenario, SmallConfig(), Options(std::string(name) + "3", 3));
    EXPECT_TRUE(one.Run());
    EXPECT_TRUE(two.Run());
    EXPECT_TRUE(three.Run());
    EXPECT_EQ(one.state().adam.steps, 8 * 2 * 4);
    ExpectSameBits(one.state(), two.state());
    ExpectSameBits(one.state(), three.state());
    TrainConfig other = SmallConfig();
    other.seed = 1;
    Trainer seeded(scenario, other, Options(std::string(name) + "4", 1));
    seeded.Run();
    EXPECT_NE(seeded.state().parameters, one.state().parameters);
  }
}

TEST_F(TrainerTest, ResumedRunEqualsTheUninterruptedOneBitForBit) {
  // Aligned episodes, a horizon that does not divide the episode, and staggered ends.
  for (int kind = 0; kind < 3; ++kind) {
    TrainConfig config = SmallConfig();
    if (kind == 1) config.horizon = 15;
    if (kind == 1) config.minibatch = 160;
    if (kind == 2) config.stagger = true;
    const std::string name = std::to_string(kind);
    const Scenario scenario = ShortScenario();
    Trainer whole(scenario, config, Options("whole" + name));
    EXPECT_TRUE(whole.Run());
    {
      Trainer::Options options = Options("halves" + name);
      options.halt_after = config.steps / 2;
      Trainer first(scenario, config, options);
      EXPECT_FALSE(first.Run());
      EXPECT_LT(first.state().env_steps, config.steps);
    }
    Trainer::Options options = Options("halves" + name, 2);
    options.resume = true;
    Trainer second(scenario, config, options);
    EXPECT_GE(second.state().env_steps, config.steps / 2);
    EXPECT_TRUE(second.Run());
    ExpectSameBits(whole.state(), second.state());
    EXPECT_EQ(Bytes(folder_ / ("whole" + name) / "policy_last.onnx"),
              Bytes(folder_ / ("halves" + name) / "policy_last.onnx"));
  }
}

TEST_F(TrainerTest, StopSavesAtTheNextBoundaryAndLeavesALoadablePolicy) {
  const std::atomic<int> stop{2};
  Trainer::Options options = Options("run");
  options.stop = &stop;
  Trainer trainer(ShortScenario(), SmallConfig(), options);
  EXPECT_FALSE(trainer.Run());
  EXPECT_EQ(trainer.state().env_steps, 2 * 640);
  const agent::Policy policy =
      agent::Policy::LoadOnnx((folder_ / "run" / "policy_last.onnx").string());
  EXPECT_NO_THROW(policy.RequireFits(ShortScenario()));
  EXPECT_TRUE(fs::exists(folder_ / "run" / "summary.json"));
  EXPECT_NO_THROW(LoadCheckpoint(CheckpointPath((folder_ / "run").string(), 1280)));
}

TEST_F(TrainerTest, BadCheckpointsAreRefusedAndThePreviousOneUsed) {
  const TrainConfig config = SmallConfig();
  const Scenario scenario = ShortScenario();
  Trainer trainer(scenario, config, Options("run"));
  trainer.Run();
  const std::string folder = (folder_ / "run").string();
  const std::string newest = CheckpointPath(folder, 5120);
  const std::string good = Bytes(newest);
  const auto refused = [&](const std::string& bytes, const std::string& reason) {
    std::ofstream(newest, std::ios::binary) << bytes;
    try {
      LoadCheckpoint(newest);
      ADD_FAILURE() << "accepted; expected: " << reason;
    } catch (const UserError& error) {
      EXPECT_NE(std::string(error.what()).find(newest), std::string::npos);
      EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
    }
  };
  refused("", "not a checkpoint");
  refused("{\"a\": 1}", "not a checkpoint");
  refused(good.substr(0, 20), "not a checkpoint");
  refused(good.substr(0, good.size() - 1), "truncated");
  refused(good + "x", "truncated");
  std::string version = good;
  version[8] = 9;
  refused(version, "version");
  std::string flipped = good;
  flipped[good.size() / 2] = static_cast<char>(flipped[good.size() / 2] ^ 1);
  refused(flipped, "checksum");

  std::ostringstream log;
  const std::optional<TrainState> previous = LoadNewestCheckpoint(folder, &log);
  ASSERT_TRUE(previous.has_value());
  EXPECT_EQ(previous->env_steps, 3840);
  EXPECT_NE(log.str().find(newest), std::string::npos);
  Trainer::Options options = Options("run");
  options.resume = true;
  Trainer resumed(scenario, config, options);
  EXPECT_EQ(resumed.state().env_steps, 3840);
  EXPECT_TRUE(resumed.Run());
  ExpectSameBits(resumed.state(), trainer.state());
}

TEST_F(TrainerTest, KeepsTheLastCheckpointsOnlyAndNoTemporaryFile) {
  TrainConfig config = SmallConfig();
  config.keep_checkpoints = 2;
  Trainer(ShortScenario(), config, Options("run")).Run();
  int checkpoints = 0;
  for (const auto& entry : fs::directory_iterator(folder_ / "run")) {
    EXPECT_NE(entry.path().extension(), ".tmp");
    if (entry.path().extension() == ".pt") ++checkpoints;
  }
  EXPECT_EQ(checkpoints, 2);
}

TEST_F(TrainerTest, RefusesToMixRuns) {
  const TrainConfig config = SmallConfig();
  const Scenario scenario = ShortScenario();
  Trainer(scenario, config, Options("run")).Run();
  EXPECT_THROW(Trainer(scenario, config, Options("run")), UserError);
  Trainer::Options resume = Options("run");
  resume.resume = true;
  TrainConfig other = config;
  other.gamma = 0.8;
  EXPECT_THROW(Trainer(scenario, other, resume), UserError);
  EXPECT_THROW(Trainer(ShortScenario("hard_release"), config, resume), UserError);
  resume.out = (folder_ / "empty").string();
  EXPECT_THROW(Trainer(scenario, config, resume), UserError);
  // A run that ended before its first checkpoint is no obstacle.
  fs::create_directories(folder_ / "early");
  std::ofstream(folder_ / "early" / "config.json") << "{}";
  EXPECT_NO_THROW(Trainer(scenario, config, Options("early")));
}

TEST_F(TrainerTest, ProgressFileHasOneRowPerCollectionAlsoAfterResuming) {
  const TrainConfig config = SmallConfig();
  Trainer::Options options = Options("run");
  options.halt_after = 2560;
  Trainer(ShortScenario(), config, options).Run();
  options.halt_after = 0;
  options.resume = true;
  Trainer(ShortScenario(), config, options).Run();
  std::istringstream csv(Bytes(folder_ / "run" / "progress.csv"));
  std::string line;
  std::getline(csv, line);
  const auto columns = std::count(line.begin(), line.end(), ',');
  int row = 0;
  while (std::getline(csv, line)) {
    EXPECT_EQ(std::stoi(line), 640 * ++row);
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), columns);
  }
  EXPECT_EQ(row, 8);
}

TEST_F(TrainerTest, ARunCanStartFromTheNetworksOfAnother) {
  const Scenario scenario = ShortScenario();
  TrainConfig config = SmallConfig();
  Trainer first(scenario, config, Options("first"));
  ASSERT_TRUE(first.Run());

  config.start_from = (folder_ / "first").string();
  config.lr = config.critic_lr = 1e-8;  // no step to speak of: what it starts with is what remains
  config.seed = 1;
  config.steps = 2560;
  Trainer second(scenario, config, Options("second"));
  const std::size_t actor = second.networks().log_std_offset();
  for (std::size_t i = 0; i < actor; ++i) {
    ASSERT_EQ(second.state().parameters[i], first.state().parameters[i]);
  }
  EXPECT_EQ(second.state().parameters[actor], static_cast<float>(config.initial_log_std));
  EXPECT_EQ(second.state().env_steps, 0);
  ASSERT_TRUE(second.Run());
  EXPECT_NEAR(second.state().parameters[0], first.state().parameters[0], 1e-5);

  config.actor_hidden = {8};
  EXPECT_THROW(Trainer(scenario, config, Options("third")), UserError);
  config.start_from = (folder_ / "nowhere").string();
  EXPECT_THROW(Trainer(scenario, config, Options("fourth")), UserError);
}

TEST_F(TrainerTest, EveryVariantTrains) {
  for (const char* variant : {"stg", "semantic", "velocity3", "tau6"}) {
    TrainConfig config = SmallConfig();
    config.variant = variant;
    config.steps = 640;
    Trainer trainer(ShortScenario(), config, Options(variant));
    EXPECT_TRUE(trainer.Run());
    const agent::Policy policy =
        agent::Policy::LoadOnnx((folder_ / variant / "policy_last.onnx").string());
    EXPECT_NO_THROW(policy.RequireFits(VariantScenario(ShortScenario(), variant)));
  }
}

TEST_F(TrainerTest, AShortRunImprovesTheReturn) {
  TrainConfig config = Preset("fast");
  config.steps = 128000;
  config.validation_interval = 1000000;
  config.validation_episodes = 16;
  const Scenario scenario = LoadNamedScenario(config::ScenarioFolder(), "medium_release");
  Trainer trainer(scenario, config, Options("run", 2));
  WorkerPool pool(2);
  const ActorCritic& networks = trainer.networks();
  Validation validation(scenario, networks, 16, &pool);
  const RunningMoments nothing(networks.actor.inputs());
  const task::MetricSummary before = task::Summarise(
      validation.Run(trainer.state().parameters.data(), Normaliser::From(nothing, 1.0F, 10.0F)));
  EXPECT_TRUE(trainer.Run());
  const double untrained = before.mean[0];
  ASSERT_EQ(before.names[0], "return");
  EXPECT_GT(trainer.state().best_return, untrained + 200.0);
}

}  // namespace
}  // namespace stg::learn
