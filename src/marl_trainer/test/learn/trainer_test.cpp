#include <cstring>
#include <nlohmann/json.hpp>

#include "auv_common/error.hpp"
#include "learn/trainer_fixture.hpp"
#include "marl_trainer/learn/algorithms/mappo/mappo.hpp"
#include "marl_trainer/learn/algorithms/masac/masac_config.hpp"
#include "marl_trainer/learn/run/validation.hpp"
#include "stg_env/env/variants.hpp"

namespace stg::learn {
namespace {

/// The parameters of the actor, then those of the critic.
std::vector<float> Parameters(Trainer& trainer) {
  const auto& mappo = dynamic_cast<Mappo&>(trainer.algorithm());
  std::vector<float> all = mappo.actor().numbers;
  all.insert(all.end(), mappo.critic().numbers.begin(), mappo.critic().numbers.end());
  return all;
}

TEST_F(TrainerTest, WeightsDoNotDependOnTheNumberOfWorkers) {
  for (const char* name : {"medium_release", "medium"}) {
    const Scenario scenario = ShortScenario(name);
    Trainer one(scenario, SmallSetup(), Options(std::string(name) + "1", 1));
    Trainer two(scenario, SmallSetup(), Options(std::string(name) + "2", 2));
    Trainer three(scenario, SmallSetup(), Options(std::string(name) + "3", 3));
    EXPECT_TRUE(one.Run());
    EXPECT_TRUE(two.Run());
    EXPECT_TRUE(three.Run());
    EXPECT_EQ(one.state().algorithm.Integer("actor_adam_steps"), 8 * 2 * 4);
    ExpectSameBits(one.state(), two.state());
    ExpectSameBits(one.state(), three.state());
    TrainSetup other = SmallSetup();
    other.common.seed = 1;
    Trainer seeded(scenario, other, Options(std::string(name) + "4", 1));
    seeded.Run();
    EXPECT_NE(Parameters(seeded), Parameters(one));
  }
}

TEST_F(TrainerTest, ResumedRunEqualsTheUninterruptedOneBitForBit) {
  // Aligned episodes, a horizon that does not divide the episode, and staggered ends. The runs are
  // stopped where all environments start an episode, and in the middle of episodes.
  for (int kind = 0; kind < 6; ++kind) {
    TrainSetup setup = SmallSetup();
    if (kind % 3 == 1) setup.common.horizon = 15;
    if (kind % 3 == 2) setup.common.stagger = true;
    const std::string name = std::to_string(kind);
    const std::int64_t halt = setup.common.steps / 2 + (kind < 3 ? 0 : 1);
    const Scenario scenario = ShortScenario();
    Trainer whole(scenario, setup, Options("whole" + name));
    EXPECT_TRUE(whole.Run());
    {
      Trainer::Options options = Options("halves" + name);
      options.halt_after = halt;
      Trainer first(scenario, setup, options);
      EXPECT_FALSE(first.Run());
      EXPECT_LT(first.state().env_steps, setup.common.steps);
      EXPECT_LT(first.state().env_steps, halt + setup.common.envs * setup.common.horizon);
    }
    Trainer::Options options = Options("halves" + name, 2);
    options.resume = true;
    Trainer second(scenario, setup, options);
    EXPECT_GE(second.state().env_steps, halt);
    EXPECT_TRUE(second.Run());
    ExpectSameBits(whole.state(), second.state());
    EXPECT_EQ(Bytes(folder_ / ("whole" + name) / "policy_last.onnx"),
              Bytes(folder_ / ("halves" + name) / "policy_last.onnx"));
  }
}

TEST_F(TrainerTest, EpisodesReachTheirEndAlsoWhereTheHorizonDoesNotDivideThem) {
  TrainSetup setup = SmallSetup();
  setup.common.horizon = 30;  // two collections for an episode of 40
  setup.common.steps = 5760;  // six collections
  Trainer(ShortScenario(), setup, Options("run")).Run();
  std::istringstream csv(Bytes(folder_ / "run" / "progress.csv"));
  std::string line;
  std::getline(csv, line);
  std::vector<int> ended;
  while (std::getline(csv, line)) {
    std::istringstream row(line);
    std::string cell;
    for (int column = 0; column < 4; ++column) std::getline(row, cell, ',');
    ended.push_back(std::stoi(cell));
  }
  EXPECT_EQ(ended, (std::vector<int>{0, 32, 0, 32, 0, 32}));
}

TEST_F(TrainerTest, StopSavesAfterTheCollectionAndLeavesALoadablePolicy) {
  const std::atomic<int> stop{2};
  Trainer::Options options = Options("run");
  options.stop = &stop;
  Trainer trainer(ShortScenario(), SmallSetup(), options);
  EXPECT_FALSE(trainer.Run());
  EXPECT_EQ(trainer.state().env_steps, 640);
  const agent::Policy policy =
      agent::Policy::LoadOnnx((folder_ / "run" / "policy_last.onnx").string());
  EXPECT_NO_THROW(policy.RequireFits(ShortScenario().model()));
  EXPECT_TRUE(fs::exists(folder_ / "run" / "summary.json"));
  EXPECT_NO_THROW(LoadCheckpoint(CheckpointPath((folder_ / "run").string(), 640)));
}

TEST_F(TrainerTest, BadCheckpointsAreRefusedAndThePreviousOneUsed) {
  const TrainSetup setup = SmallSetup();
  const Scenario scenario = ShortScenario();
  const TrainState whole = [&] {
    Trainer trainer(scenario, setup, Options("run"));
    trainer.Run();
    return trainer.state();
  }();
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
  refused(version, "version 9");
  version[8] = 1;
  refused(version, "version 1 (a libtorch archive)");
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
  Trainer resumed(scenario, setup, options);
  EXPECT_EQ(resumed.state().env_steps, 3840);
  EXPECT_TRUE(resumed.Run());
  ExpectSameBits(resumed.state(), whole);
}

TEST_F(TrainerTest, KeepsTheLastCheckpointsOnlyAndNoTemporaryFile) {
  TrainSetup setup = SmallSetup();
  setup.common.keep_checkpoints = 2;
  Trainer(ShortScenario(), setup, Options("run")).Run();
  int checkpoints = 0;
  for (const auto& entry : fs::directory_iterator(folder_ / "run")) {
    EXPECT_NE(entry.path().extension(), ".tmp");
    if (entry.path().extension() == ".ckpt") ++checkpoints;
  }
  EXPECT_EQ(checkpoints, 2);
}

TEST_F(TrainerTest, RefusesToMixRuns) {
  const TrainSetup setup = SmallSetup();
  const Scenario scenario = ShortScenario();
  Trainer(scenario, setup, Options("run")).Run();
  EXPECT_THROW(Trainer(scenario, setup, Options("run")), UserError);
  Trainer::Options resume = Options("run");
  resume.resume = true;
  TrainSetup other = setup;
  Own(other).gamma = 0.8;
  EXPECT_THROW(Trainer(scenario, other, resume), UserError);
  EXPECT_THROW(Trainer(ShortScenario("hard_release"), setup, resume), UserError);
  resume.out = (folder_ / "empty").string();
  EXPECT_THROW(Trainer(scenario, setup, resume), UserError);
  // A run that ended before its first checkpoint does not prevent a new one.
  fs::create_directories(folder_ / "early");
  std::ofstream(folder_ / "early" / "config.json") << "{}";
  EXPECT_NO_THROW(Trainer(scenario, setup, Options("early")));
}

TEST_F(TrainerTest, AFolderThatATrainingWritesIntoIsRefusedToOthers) {
  Trainer first(ShortScenario(), SmallSetup(), Options("run"));
  const auto refused = [&](bool resume) {
    Trainer::Options options = Options("run");
    options.resume = resume;
    try {
      Trainer(ShortScenario(), SmallSetup(), options);
      ADD_FAILURE() << "accepted";
    } catch (const UserError& error) {
      EXPECT_EQ(std::string(error.what()), options.out + ": another program is writing into it");
    }
  };
  refused(false);
  ASSERT_TRUE(first.Run());
  refused(true);
}

TEST_F(TrainerTest, ATrainingThatDivergesSaysSoAndKeepsItsLastGoodCheckpoint) {
  TrainSetup setup("masac", "fast");
  auto& own = dynamic_cast<MasacConfig&>(*setup.own);
  own.warmup = 0;
  own.batch = 16;
  own.replayed = 16.0;  // one gradient step per step
  own.alpha_lr = 1.0;
  own.target_entropy = 1.0;  // a uniform density has less entropy, so alpha grows without end
  own.actor_hidden = own.critic_hidden = {8};
  setup.common.envs = 4;
  setup.common.horizon = 20;
  setup.common.checkpoint_interval = 1;
  setup.common.keep_checkpoints = 1;
  setup.common.steps = 1600;
  const Trainer::Options options = Options("run");
  try {
    Trainer(ShortScenario(), setup, options).Run();
    ADD_FAILURE() << "alpha stayed finite";
  } catch (const UserError& error) {
    const std::string what = error.what();
    EXPECT_EQ(what.find(options.out + ": after "), 0U) << what;
    EXPECT_NE(what.find("the training diverged"), std::string::npos) << what;
  }
  const std::optional<TrainState> good = LoadNewestCheckpoint(options.out, &log_);
  ASSERT_TRUE(good.has_value()) << log_.str();
  EXPECT_GE(good->env_steps, 80);
}

TEST_F(TrainerTest, ProgressFileHasOneRowPerCollectionAlsoAfterResuming) {
  const TrainSetup setup = SmallSetup();
  Trainer::Options options = Options("run");
  options.halt_after = 2560;
  Trainer(ShortScenario(), setup, options).Run();
  options.halt_after = 0;
  options.resume = true;
  Trainer(ShortScenario(), setup, options).Run();
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

TEST_F(TrainerTest, TheSummaryTellsSizesAndWorkOfTheNetworks) {
  Trainer::Options options = Options("run");
  options.halt_after = 2560;
  const Scenario scenario = ShortScenario();
  const Problem problem = ProblemOf(scenario.run, scenario.world, scenario.agent);
  Trainer(scenario, SmallSetup(), options).Run();
  options.halt_after = 0;
  options.resume = true;
  Trainer(scenario, SmallSetup(), options).Run();
  const auto json = nlohmann::json::parse(Bytes(folder_ / "run" / "summary.json"));
  const int o = problem.observation_size, s = problem.state_size, a = problem.action_size;
  // The actor has two hidden layers of 16 and a spread. The critic has one hidden layer of 16.
  const nlohmann::json parameters = {{"actor", (o + 1) * 16 + 17 * 16 + 17 * a + a},
                                     {"critic", (s + 1) * 16 + 17}};
  EXPECT_EQ(json.at("parameters"), parameters);
  // Multiply-adds of a row. The backward pass costs one forward pass for the weights and one for
  // the inputs. The first layer needs no gradient of its inputs.
  const double actor = o * 16 + 16 * 16 + 16 * a, critic = s * 16 + 16;
  const double epoch = problem.agents * (3 * actor - o * 16) + (3 * critic - s * 16);
  EXPECT_DOUBLE_EQ(json.at("update_flops_per_env_step"), 2 * (2 * epoch + critic));
}

TEST_F(TrainerTest, ARunCanStartFromTheNetworksOfAnother) {
  const Scenario scenario = ShortScenario();
  TrainSetup setup = SmallSetup();
  Trainer first(scenario, setup, Options("first"));
  ASSERT_TRUE(first.Run());

  setup.common.start_from = (folder_ / "first").string();
  Own(setup).lr = Own(setup).critic_lr =
      1e-8;  // it takes almost no step, so it keeps what it starts with
  setup.common.seed = 1;
  setup.common.steps = 2560;
  Trainer second(scenario, setup, Options("second"));
  const std::size_t actor =
      dynamic_cast<Mappo&>(second.algorithm()).networks().actor.log_std_offset();
  for (std::size_t i = 0; i < actor; ++i) {
    ASSERT_EQ(Parameters(second)[i], Parameters(first)[i]);
  }
  EXPECT_EQ(Parameters(second)[actor], static_cast<float>(Own(setup).initial_log_std));
  EXPECT_EQ(second.state().env_steps, 0);
  ASSERT_TRUE(second.Run());
  EXPECT_NEAR(Parameters(second)[0], Parameters(first)[0], 1e-5);

  Own(setup).actor_hidden = {8};
  EXPECT_THROW(Trainer(scenario, setup, Options("third")), UserError);
  setup.common.start_from = (folder_ / "nowhere").string();
  EXPECT_THROW(Trainer(scenario, setup, Options("fourth")), UserError);
}

TEST_F(TrainerTest, EveryVariantTrains) {
  for (const auto variant : {env::Variant::kStg, env::Variant::kSemantic, env::Variant::kVelocity3,
                             env::Variant::kTau6}) {
    TrainSetup setup = SmallSetup();
    setup.common.variant = variant;
    setup.common.steps = 640;
    const std::string& name = env::NameOf(variant);
    Trainer trainer(ShortScenario(), setup, Options(name));
    EXPECT_TRUE(trainer.Run());
    const agent::Policy policy =
        agent::Policy::LoadOnnx((folder_ / name / "policy_last.onnx").string());
    EXPECT_NO_THROW(policy.RequireFits(env::VariantScenario(ShortScenario(), variant).model()));
  }
}

TEST_F(TrainerTest, AShortRunImprovesTheReturn) {
  TrainSetup setup("mappo", "fast");
  setup.common.steps = 128000;
  setup.common.validation_interval = 1000000;
  setup.common.validation_episodes = 16;
  const Scenario scenario = LoadNamedScenario(config::ScenarioFolder(), "medium_release");
  Trainer trainer(scenario, setup, Options("run", 2));
  WorkerPool pool(2);
  const task::MetricSummary before =
      task::Summarise(Validate(env::EnvFactory(scenario), 16, &trainer.algorithm(), &pool));
  EXPECT_TRUE(trainer.Run());
  const double untrained = before.mean[0];
  ASSERT_EQ(before.names[0], "return");
  EXPECT_GT(trainer.state().best_return, untrained + 200.0);
}

}  // namespace
}  // namespace stg::learn
