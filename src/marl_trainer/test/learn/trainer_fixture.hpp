/// What the tests of whole trainings share.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "auv_common/config/files.hpp"
#include "auv_common/testing/temporary_folder.hpp"
#include "learn/mappo_setup.hpp"
#include "marl_trainer/learn/run/trainer.hpp"
#include "stg_env/scenario/scenario.hpp"

namespace stg::learn {

namespace fs = std::filesystem;

/// Two small collections per episode of 40 decisions.
inline TrainSetup SmallSetup() {
  TrainSetup setup("mappo", "fast");
  MappoConfig& own = Own(setup);
  own.minibatch = 160;
  own.epochs = 2;
  own.actor_hidden = {16, 16};
  own.critic_hidden = {16};
  TrainConfig& common = setup.common;
  common.envs = 32;
  common.horizon = 20;
  common.stagger = false;
  common.validation_episodes = 4;
  common.validation_interval = 2560;
  common.checkpoint_interval = 1280;
  common.steps = 5120;
  return setup;
}

inline Scenario ShortScenario(const std::string& name = "medium_release") {
  return LoadNamedScenario(config::ScenarioFolder(), name, "nominal",
                           {"time.episode_steps=40", "time.tail_steps=10"});
}

inline std::string Bytes(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

class TrainerTest : public ::testing::Test {
 protected:
  Trainer::Options Options(const std::string& name, int workers = 1) {
    Trainer::Options options;
    options.out = (folder_ / name).string();
    options.workers = workers;
    options.log = &log_;
    return options;
  }

  const TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
  std::ostringstream log_;
};

inline void ExpectSameBits(const TrainState& a, const TrainState& b) {
  EXPECT_TRUE(a.algorithm == b.algorithm);
  EXPECT_EQ(a.env_steps, b.env_steps);
  EXPECT_EQ(a.round, b.round);
  EXPECT_EQ(a.best_return, b.best_return);
}

}  // namespace stg::learn
