#include "marl_trainer/learn/train_config.hpp"

#include <gtest/gtest.h>

#include <string>

#include "auv_common/error.hpp"

namespace stg::learn {
namespace {

TEST(TrainConfig, EveryFieldSurvivesJsonAndBadValuesAreNamed) {
  TrainConfig c = Preset("paper");
  c.seed = 5;
  c.lr = 0.125;
  c.stagger = true;
  c.actor_hidden = {7, 8};
  EXPECT_EQ(ToJson(TrainConfigFromJson(ToJson(c))), ToJson(c));
  auto json = ToJson(c);
  json["unknown"] = 1;
  EXPECT_THROW(TrainConfigFromJson(json), UserError);
  c.lr = -1.0;
  try {
    c.ValidateOrThrow();
    FAIL();
  } catch (const UserError& error) {
    EXPECT_NE(std::string(error.what()).find("--lr"), std::string::npos);
  }
  c = Preset("fast");
  c.wall_units = 0.015;
  c.activation = "relu";
  EXPECT_THROW(c.ValidateOrThrow(), UserError);  // nothing to start from
  c.start_from = "there";
  EXPECT_NO_THROW(c.ValidateOrThrow());
  c.actor_hidden = {16, 64};
  EXPECT_THROW(c.ValidateOrThrow(), UserError);
  EXPECT_THROW(Preset("slow"), UserError);
  EXPECT_NO_THROW(Preset("fast").ValidateOrThrow());
  EXPECT_NO_THROW(Preset("paper").ValidateOrThrow());
}

TEST(TrainConfig, PaperPresetHasTheNumbersOfTableS2) {
  const TrainConfig c = Preset("paper");
  EXPECT_EQ(c.gamma, 0.95);
  EXPECT_EQ(c.lambda, 0.95);
  EXPECT_EQ(c.lr, 3e-4);
  EXPECT_EQ(c.minibatch, 800);
  EXPECT_EQ(c.envs * c.horizon, 6400);
  EXPECT_EQ(c.epochs, 10);
  EXPECT_EQ(c.clip, 0.2);
  EXPECT_EQ(c.entropy, 0.001);
  EXPECT_EQ(c.grad_clip, 5.0);
  EXPECT_EQ(c.value_weight, 0.5);
  EXPECT_EQ(c.steps, 2000000);
}

TEST(Variants, DifferAsTableS9SaysAndAreValidatedWithOneReward) {
  Scenario scenario;
  EXPECT_EQ(VariantScenario(scenario, "stg").observation_size(), 74);
  EXPECT_EQ(VariantScenario(scenario, "semantic").observation_size(), 68);
  EXPECT_EQ(VariantScenario(scenario, "velocity3").observation_size(), 51);
  const Scenario tau6 = VariantScenario(scenario, "tau6");
  EXPECT_EQ(tau6.observation_size(), 51);
  EXPECT_EQ(tau6.action_size(), 6);
  EXPECT_EQ(tau6.control.action_scale, 0.18);
  EXPECT_EQ(tau6.control.smoothing, 0.0);
  EXPECT_EQ(tau6.control.max_delta, 0.0);
  EXPECT_EQ(tau6.reward.kind, task::RewardKind::kReleaseRaw);
  EXPECT_EQ(tau6.reward.weights.coordination, 0.10);
  EXPECT_EQ(ValidationScenario(scenario, "tau6").reward.kind, scenario.reward.kind);
  EXPECT_EQ(ValidationScenario(scenario, "tau6").reward.weights.tracking, 0.72);
  EXPECT_EQ(ValidationScenario(scenario, "tau6").action_size(), 6);
  EXPECT_THROW(VariantScenario(scenario, "other"), UserError);
}

}  // namespace
}  // namespace stg::learn
