#include <cmath>

#include "auv_common/error.hpp"
#include "learn/comm/thread_ranks.hpp"
#include "learn/trainer_fixture.hpp"
#include "marl_trainer/learn/algorithms/off_policy/replay_config.hpp"

/// Training among several ranks. Here they are threads; mpi_test.cpp has processes.
namespace stg::learn {
namespace {

class RanksTest : public TrainerTest {
 protected:
  /// A small setup of an algorithm that learns from its own actions.
  static TrainSetup SetupOf(const std::string& algorithm) {
    const TrainSetup small = SmallSetup();
    TrainSetup setup(algorithm, "fast");
    if (auto* ppo = dynamic_cast<PpoOptions*>(setup.own.get())) {
      *ppo = dynamic_cast<const PpoOptions&>(*small.own);
    } else {
      auto& replay = dynamic_cast<ReplayConfig&>(*setup.own);
      replay.replay = 1280;  // two collections, of the three
      replay.warmup = 0;
      replay.batch = 100;  // in slices of 6 and 7
      replay.actor_hidden = replay.critic_hidden = {8};
    }
    setup.common = small.common;
    setup.common.steps = 1920;
    setup.common.validation_episodes = 20;  // a block and a part of a block
    return setup;
  }

  /// Trains among this many ranks. Returns the state of rank 0.
  TrainState Train(const TrainSetup& setup, int ranks, int workers, Trainer::Options options) {
    TrainState first;
    options.workers = workers;
    ThreadRanks(ranks).Run([&](Communicator* self) {
      Trainer::Options own = options;
      own.ranks = self;
      Trainer trainer(ShortScenario(), setup, own);
      trainer.Run();
      const TrainState state = trainer.state();
      if (self->rank() == 0) first = state;
    });
    return first;
  }

  std::string Policy(const std::string& name) const {
    for (const char* file : {"policy_last.onnx", "policy_last_0.onnx"}) {
      if (fs::exists(folder_ / name / file)) return Bytes(folder_ / name / file);
    }
    return "";
  }

  /// progress.csv without the columns of times.
  std::string Progress(const std::string& name) const {
    std::istringstream rows(Bytes(folder_ / name / "progress.csv"));
    std::vector<bool> kept;
    std::string text;
    for (std::string row, cell; std::getline(rows, row); text += "\n") {
      std::istringstream cells(row);
      for (std::size_t i = 0; std::getline(cells, cell, ','); ++i) {
        if (i == kept.size()) kept.push_back(cell.find("_seconds") == std::string::npos);
        if (kept[i]) text += cell + ",";
      }
    }
    return text;
  }
};

TEST_F(RanksTest, TheirNumberAndThatOfWorkersDoNotMatter) {
  for (const char* algorithm : {"mappo", "ippo", "happo", "maddpg", "matd3", "masac", "madqn"}) {
    const TrainSetup setup = SetupOf(algorithm);
    const std::string name = algorithm;
    Trainer alone(ShortScenario(), setup, Options(name + "1"));
    ASSERT_TRUE(alone.Run());
    const TrainState one = alone.state();
    const std::string policy = Policy(name + "1");
    ASSERT_FALSE(policy.empty());
    const std::string progress = Progress(name + "1");
    for (const auto& [ranks, workers] : {std::pair(1, 2), std::pair(2, 1), std::pair(4, 1)}) {
      const std::string other = name + std::to_string(ranks) + std::to_string(workers);
      ExpectSameBits(Train(setup, ranks, workers, Options(other)), one);
      EXPECT_EQ(Policy(other), policy) << other;
      EXPECT_EQ(Progress(other), progress) << other;
    }
  }
}

TEST_F(RanksTest, ARunThatWasStoppedGoesOnWithAnyNumberOfRanks) {
  for (const std::string algorithm : {"mappo", "happo", "masac"}) {
    for (const bool stagger : {false, true}) {
      TrainSetup setup = SetupOf(algorithm);
      setup.common.stagger = stagger;
      const std::string name = algorithm + (stagger ? "_staggered" : "");
      Trainer alone(ShortScenario(), setup, Options(name));
      ASSERT_TRUE(alone.Run());
      // A process alone runs a third, two ranks run a third, and a process alone runs the rest.
      Trainer::Options options = Options(name + "_thirds");
      options.halt_after = 1;
      EXPECT_FALSE(Trainer(ShortScenario(), setup, options).Run());
      options.resume = true;
      options.halt_after = 641;
      EXPECT_EQ(Train(setup, 2, 1, options).env_steps, 1280);
      options.halt_after = 0;
      Trainer last(ShortScenario(), setup, options);
      EXPECT_TRUE(last.Run());
      ExpectSameBits(last.state(), alone.state());
      EXPECT_EQ(Policy(name + "_thirds"), Policy(name));
      EXPECT_EQ(Progress(name + "_thirds"), Progress(name));
    }
  }
}

TEST_F(RanksTest, OnesRequestToStopStopsAll) {
  const std::atomic<int> stop{2}, go{0};
  ThreadRanks(2).Run([&](Communicator* self) {
    Trainer::Options own = Options("run");
    own.ranks = self;
    own.stop = self->rank() == 1 ? &stop : &go;
    Trainer trainer(ShortScenario(), SetupOf("mappo"), own);
    EXPECT_FALSE(trainer.Run());
    EXPECT_EQ(trainer.state().env_steps, 640);
  });
}

TEST_F(RanksTest, WhatCannotBeSharedIsRefused) {
  const auto refused = [&](const TrainSetup& setup, int ranks, const std::string& reason) {
    ThreadRanks(ranks).Run([&](Communicator* self) {
      Trainer::Options own = Options("refused");
      own.ranks = self;
      try {
        Trainer(ShortScenario(), setup, own);
        ADD_FAILURE() << "accepted; expected: " << reason;
      } catch (const UserError& error) {
        EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
      }
    });
  };
  refused(TrainSetup("masac", "fast"), 32, "--algorithm masac: trains with at most 16 ranks");
  refused(SetupOf("mappo"), 3, "power of two");
  TrainSetup few = SetupOf("mappo");
  few.common.envs = 8;
  refused(few, 16, "--envs");
}

TEST_F(RanksTest, DifferentOptionsAreRefusedByAll) {
  std::atomic<int> refused{0};
  ThreadRanks(2).Run([&](Communicator* self) {
    Trainer::Options own = Options("different");
    own.ranks = self;
    TrainSetup setup = SetupOf("mappo");
    setup.common.seed += static_cast<std::uint64_t>(self->rank());
    try {
      Trainer(ShortScenario(), setup, own);
    } catch (const UserError& error) {
      refused += std::string(error.what()).find("different options") != std::string::npos;
    }
  });
  EXPECT_EQ(refused, 2);
}

TEST_F(RanksTest, EachConditionOfAMixHasEnvironments) {
  Trainer::Options options = Options("mixed");
  options.mix = {ShortScenario(), ShortScenario(), ShortScenario()};
  TrainSetup setup = SetupOf("mappo");
  setup.common.envs = 8;
  EXPECT_THROW(Trainer(ShortScenario(), setup, options), UserError);
  options.mix.pop_back();
  EXPECT_NO_THROW(Trainer(ShortScenario(), setup, options));
}

}  // namespace
}  // namespace stg::learn
