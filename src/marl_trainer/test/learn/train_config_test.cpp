#include "marl_trainer/learn/train_config.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "auv_common/config/value.hpp"
#include "auv_common/error.hpp"
#include "learn/mappo_setup.hpp"
#include "stg_env/env/variants.hpp"

namespace stg::learn {
namespace {

/// The message with which the setup is refused. It is a failure if it is accepted.
std::string Refusal(const TrainSetup& setup) {
  try {
    setup.ValidateOrThrow();
  } catch (const UserError& error) {
    return error.what();
  }
  ADD_FAILURE() << "accepted";
  return "";
}

TEST(TrainSetup, EveryFieldSurvivesJson) {
  TrainSetup setup("mappo", "paper");
  setup.common.seed = 5;
  setup.common.stagger = false;
  Own(setup).imitation.controller = "pursuit";
  Own(setup).imitation.steps = 1000000000000;
  Own(setup).lr = 0.125;
  Own(setup).actor_hidden = {7, 8};
  const auto json = ToJson(setup);
  EXPECT_EQ(json.at("algorithm"), "mappo");
  EXPECT_EQ(json.at("imitate"), "pursuit");
  EXPECT_EQ(json.at("lr"), 0.125);
  EXPECT_EQ(ToJson(TrainSetupFromJson(json)), json);
  auto other = json;
  other["unknown"] = 1;
  EXPECT_THROW(TrainSetupFromJson(other), UserError);
  other = json;
  other.erase("lr");
  EXPECT_THROW(TrainSetupFromJson(other), UserError);
  other = json;
  other["lr"] = "fast";
  EXPECT_THROW(TrainSetupFromJson(other), UserError);
}

TEST(TrainSetup, WhatAnOptionCannotHoldIsRefusedByName) {
  const nlohmann::ordered_json good = ToJson(TrainSetup("mappo", "fast"));
  const auto refusal = [&good](const char* name, const nlohmann::ordered_json& value) {
    nlohmann::ordered_json json = good;
    json[name] = value;
    try {
      TrainSetupFromJson(json);
    } catch (const UserError& error) {
      return std::string(error.what());
    }
    ADD_FAILURE() << name << " takes " << value;
    return std::string();
  };
  const nlohmann::ordered_json texts = nlohmann::ordered_json::parse(
      R"([1e300, -1e300, 1e19, 2.5, 3000000000, -3000000000, 18446744073709551615, true, null,
          "7", [7], {}])");
  for (const auto& value : texts) {
    EXPECT_EQ(refusal("envs", value).rfind("training configuration: envs: '", 0), 0U) << value;
    EXPECT_NE(refusal("actor-hidden", {8, value}).find(": actor-hidden: '"), std::string::npos);
  }
  EXPECT_EQ(refusal("envs", 1e300),
            "training configuration: envs: '1e+300' is not a whole number from -2147483648 to "
            "2147483647");
  for (const double value : {-1.0, 0.5, 1e300}) {
    EXPECT_NE(refusal("seed", value).find(": seed: '"), std::string::npos);
  }
  refusal("steps", 1e300);
  refusal("steps", 9223372036854775808ULL);
  refusal("lr", true);
  refusal("stagger", 1);
  refusal("start-from", 1);
  refusal("algorithm", 1);
  refusal("preset", 1);

  nlohmann::ordered_json json = good;
  json["seed"] = 18446744073709551615ULL;
  json["steps"] = 1e6;  // people write it like this by hand
  EXPECT_EQ(TrainSetupFromJson(json).common.seed, 18446744073709551615ULL);
  EXPECT_EQ(TrainSetupFromJson(json).common.steps, 1000000);
}

TEST(TrainSetup, ACommandLineIsReadLikeAFile) {
  TrainSetup setup("mappo", "fast");
  const config::Table options = setup.Options();
  const auto refusal = [&options](const char* name, const std::string& text) {
    return config::ParseText(*options.Find(name), text).value_or("");
  };
  EXPECT_EQ(refusal("actor-hidden", "32,16"), "");
  EXPECT_EQ(Own(setup).actor_hidden, (std::vector<int>{32, 16}));
  EXPECT_EQ(refusal("critic-hidden", "[8]"), "");
  EXPECT_EQ(Own(setup).critic_hidden, std::vector<int>{8});
  EXPECT_EQ(refusal("steps", "3000000000000"), "3000000000000 is out of range [1, 1e+12]");
  EXPECT_EQ(refusal("steps", "300000000000"), "");
  EXPECT_EQ(setup.common.steps, 300000000000);
  EXPECT_EQ(refusal("imitate", "pursuit:gain=2,cap=0.5"), "");
  EXPECT_EQ(Own(setup).imitation.controller, "pursuit:gain=2,cap=0.5");
  EXPECT_EQ(refusal("activation", "relu"), "");
  EXPECT_EQ(Own(setup).activation, HiddenActivation::kRelu);
  EXPECT_EQ(refusal("activation", "sine"), "expected one of tanh | relu, found 'sine'");
  EXPECT_EQ(refusal("stagger", "false"), "");
  EXPECT_FALSE(setup.common.stagger);
  for (const auto& [name, text] :
       {std::pair("stagger", "0"), std::pair("seed", "-1"), std::pair("envs", "2.5"),
        std::pair("actor-hidden", "8,0"), std::pair("actor-hidden", "1,2,3,4,5,6,7,8"),
        std::pair("start-from", "a\nb"), std::pair("lr", "nan")}) {
    EXPECT_NE(refusal(name, text), "") << name;
  }
}

TEST(TrainSetup, IsAValue) {
  const TrainSetup setup("mappo", "fast");
  TrainSetup copy = setup;
  Own(copy).lr = 0.5;
  EXPECT_NE(ToJson(copy), ToJson(setup));
  copy = setup;
  EXPECT_EQ(ToJson(copy), ToJson(setup));
}

TEST(TrainSetup, NamesTheOptionWithABadValue) {
  for (const char* preset : {"fast", "paper"}) {
    EXPECT_NO_THROW(TrainSetup("mappo", preset).ValidateOrThrow());
  }
  TrainSetup setup("mappo", "fast");
  Own(setup).lr = -1.0;
  EXPECT_NE(Refusal(setup).find("--lr:"), std::string::npos);
  setup = TrainSetup("mappo", "fast");
  Own(setup).minibatch = 1601;
  EXPECT_NE(Refusal(setup).find("--minibatch"), std::string::npos);
  setup = TrainSetup("mappo", "fast");
  Own(setup).critic_hidden = {};
  EXPECT_NE(Refusal(setup).find("--critic-hidden"), std::string::npos);
  setup = TrainSetup("mappo", "fast");
  Own(setup).initial_log_std = -5.0;  // this is below the lower bound
  EXPECT_NE(Refusal(setup).find("--initial-log-std"), std::string::npos);
  setup = TrainSetup("mappo", "fast");
  Own(setup).imitation.steps = 100;
  EXPECT_NE(Refusal(setup).find("--imitation-steps"), std::string::npos);
  setup = TrainSetup("mappo", "fast");
  Own(setup).wall_units = 0.015;
  Own(setup).activation = HiddenActivation::kRelu;
  EXPECT_NE(Refusal(setup).find("--start-from"), std::string::npos);
  setup.common.start_from = "there";
  EXPECT_NO_THROW(setup.ValidateOrThrow());
  Own(setup).actor_hidden = {16, 64};
  EXPECT_NE(Refusal(setup).find("--wall-units"), std::string::npos);
}

TEST(TrainSetup, TellsTheBoundsOfARangeHoweverSmall) {
  TrainSetup setup("mappo", "fast");
  Own(setup).lr = 0.0;
  EXPECT_EQ(Refusal(setup), "--lr: 0.0 is out of range [1e-08, 1]");
  setup = TrainSetup("mappo", "fast");
  Own(setup).adam_eps = 5e-13;
  EXPECT_EQ(Refusal(setup), "--adam-eps: 5.0e-13 is out of range [1e-12, 1]");
  setup = TrainSetup("mappo", "fast");
  setup.common.envs = 65537;
  EXPECT_EQ(Refusal(setup), "--envs: 65537 is out of range [1, 65536]");
}

TEST(TrainSetup, AnUnknownAlgorithmOrPresetIsToldWhatThereIs) {
  try {
    TrainSetup("mapo", "fast");
    FAIL();
  } catch (const UserError& error) {
    EXPECT_NE(std::string(error.what()).find("mappo"), std::string::npos) << error.what();
  }
  try {
    TrainSetup("mappo", "slow");
    FAIL();
  } catch (const UserError& error) {
    EXPECT_NE(std::string(error.what()).find("fast or paper"), std::string::npos) << error.what();
  }
}

TEST(TrainSetup, PaperPresetHasTheNumbersOfTableS2) {
  TrainSetup setup("mappo", "paper");
  const MappoConfig& c = Own(setup);
  EXPECT_EQ(c.gamma, 0.95);
  EXPECT_EQ(c.lambda, 0.95);
  EXPECT_EQ(c.lr, 3e-4);
  EXPECT_EQ(c.minibatch, 800);
  EXPECT_EQ(setup.common.envs * setup.common.horizon, 6400);
  EXPECT_EQ(c.epochs, 10);
  EXPECT_EQ(c.clip, 0.2);
  EXPECT_EQ(c.entropy, 0.001);
  EXPECT_EQ(c.grad_clip, 5.0);
  EXPECT_EQ(c.value_weight, 0.5);
  EXPECT_EQ(setup.common.steps, 2000000);
}

TEST(Imitation, IsInFullForTheFirstHalfAndThenFades) {
  ImitationConfig imitation;
  EXPECT_EQ(imitation.Weight(0), 0.0);
  imitation.controller = "pursuit";
  imitation.steps = 1000;
  imitation.share = 0.8;
  EXPECT_EQ(imitation.Weight(0), 0.8);
  EXPECT_EQ(imitation.Weight(500), 0.8);
  EXPECT_DOUBLE_EQ(imitation.Weight(750), 0.4);
  EXPECT_EQ(imitation.Weight(1000), 0.0);
  EXPECT_EQ(imitation.Weight(2000), 0.0);
}

TEST(Variants, DifferAsTableS9SaysAndAreEvaluatedWithOneReward) {
  Scenario scenario;
  EXPECT_EQ(env::VariantScenario(scenario, env::Variant::kStg).agent.observation_size(), 74);
  EXPECT_EQ(env::VariantScenario(scenario, env::Variant::kSemantic).agent.observation_size(), 68);
  EXPECT_EQ(env::VariantScenario(scenario, env::Variant::kVelocity3).agent.observation_size(), 51);
  const Scenario tau6 = env::VariantScenario(scenario, env::Variant::kTau6);
  EXPECT_EQ(tau6.agent.observation_size(), 51);
  EXPECT_EQ(tau6.world.control.action_size(), 6);
  EXPECT_EQ(tau6.world.control.action_scale, 0.18);
  EXPECT_EQ(tau6.world.control.smoothing, 0.0);
  EXPECT_EQ(tau6.world.control.max_delta, 0.0);
  EXPECT_EQ(tau6.reward.kind, task::RewardKind::kReleaseRaw);
  EXPECT_EQ(tau6.reward.weights.coordination, 0.10);
  EXPECT_EQ(env::EvaluationScenario(scenario, env::Variant::kTau6).reward.kind,
            scenario.reward.kind);
  EXPECT_EQ(env::EvaluationScenario(scenario, env::Variant::kTau6).reward.weights.tracking, 0.72);
  EXPECT_EQ(env::EvaluationScenario(scenario, env::Variant::kTau6).world.control.action_size(), 6);
}

TEST(Variants, AnOverrideOfAKeyThatTheVariantSetsIsRefused) {
  using env::Variant;
  using env::VariantKeys;
  const auto refusal = [](Variant variant, VariantKeys keys, const std::string& text) {
    try {
      env::RefuseKeysOf(variant, keys, {"seed=1", text});
    } catch (const UserError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(
      refusal(Variant::kTau6, VariantKeys::kAll, "control.interface=velocity3"),
      "--set 'control.interface=velocity3': the variant tau6 sets control.interface=tau6; leave "
      "out this override, or choose the variant stg");
  const char* const weight = "reward.weights.semantic=0.1";
  EXPECT_NE(refusal(Variant::kSemantic, VariantKeys::kAll, weight), "");
  EXPECT_EQ(refusal(Variant::kSemantic, VariantKeys::kWithoutReward, weight), "");
  EXPECT_EQ(refusal(Variant::kStg, VariantKeys::kAll, weight), "");
  // This variant keeps the interface of the scenario, and no variant sets the separation.
  EXPECT_EQ(refusal(Variant::kVelocity3, VariantKeys::kAll, "control.interface=tau6"), "");
  EXPECT_EQ(refusal(Variant::kTau6, VariantKeys::kAll, "reward.weights.separation=0.1"), "");
}

}  // namespace
}  // namespace stg::learn
