#include "marl_trainer/learn/train_config.hpp"

#include <cmath>

#include "auv_common/error.hpp"
#include "auv_common/numbers/vector.hpp"
#include "marl_trainer/learn/nn/actor_critic.hpp"

namespace stg::learn {
namespace {

void Require(bool ok, const char* option, const std::string& what) {
  if (!ok) throw UserError(std::string("--") + option + ": " + what);
}

void RequireRange(const char* option, double value, double lo, double hi) {
  Require(std::isfinite(value) && value >= lo && value <= hi, option,
          std::to_string(value) + " is not in [" + std::to_string(lo) + ", " + std::to_string(hi) +
              "]");
}

void RequireWidths(const char* option, const std::vector<int>& widths) {
  Require(!widths.empty() && widths.size() <= 7, option, "needs 1 to 7 widths");
  for (const int w : widths) RequireRange(option, w, 1, 4096);
}

}  // namespace

void TrainConfig::ValidateOrThrow() const {
  RequireRange("steps", static_cast<double>(steps), 1, 1e12);
  RequireRange("envs", envs, kLanes, 65536);
  Require(envs % kLanes == 0, "envs", "must be a multiple of " + std::to_string(kLanes));
  RequireRange("horizon", horizon, 1, 100000);
  RequireRange("epochs", epochs, 1, 1000);
  RequireRange("minibatch", minibatch, 1, 1e9);
  Require((static_cast<std::int64_t>(envs) * horizon) % minibatch == 0, "minibatch",
          "must divide envs times horizon, " + std::to_string(envs * horizon));
  RequireWidths("actor-hidden", actor_hidden);
  RequireWidths("critic-hidden", critic_hidden);
  Require(activation == "tanh" || activation == "relu", "activation",
          "'" + activation + "' is not tanh or relu");
  RequireRange("lr", lr, 1e-8, 1.0);
  RequireRange("critic-lr", critic_lr, 1e-8, 1.0);
  RequireRange("lr-final", lr_final, 0.0, 1.0);
  RequireRange("adam-eps", adam_eps, 1e-12, 1.0);
  RequireRange("gamma", gamma, 0.0, 1.0);
  RequireRange("lambda", lambda, 0.0, 1.0);
  RequireRange("clip", clip, 1e-3, 10.0);
  RequireRange("entropy", entropy, 0.0, 10.0);
  RequireRange("value-weight", value_weight, 0.0, 100.0);
  RequireRange("grad-clip", grad_clip, 1e-6, 1e6);
  RequireRange("target-kl", target_kl, 0.0, 100.0);
  RequireRange("min-log-std", min_log_std, -20.0, 2.0);
  RequireRange("max-log-std", max_log_std, min_log_std, 2.0);
  RequireRange("initial-log-std", initial_log_std, min_log_std, max_log_std);
  RequireRange("observation-clip", observation_clip, 0.1, 1e6);
  RequireRange("std-floor", std_floor, 1e-6, 1.0);
  Require(imitate.empty() == (imitation_steps == 0), "imitation-steps",
          "goes with --imitate, and the other way round");
  RequireRange("imitation-steps", static_cast<double>(imitation_steps), 0, 1e12);
  RequireRange("imitation-share", imitation_share, 0.0, 1.0);
  RequireRange("imitation-focus", imitation_focus, 0.0, 4.0);
  RequireRange("std-scale", std_scale, 1e-3, 1e3);
  RequireRange("wall-units", wall_units, 0.0, 1e3);
  Require(wall_units == 0.0 || !start_from.empty(), "wall-units",
          "needs the normalisers of another run: --start-from");
  Require(wall_units == 0.0 || (activation == "relu" && actor_hidden[0] >= ActorCritic::kWallUnits),
          "wall-units", "needs --activation relu and 24 units in the actor's first layer");
  RequireRange("validation-interval", static_cast<double>(validation_interval), 1, 1e12);
  RequireRange("validation-episodes", validation_episodes, 1, 10000);
  RequireRange("checkpoint-interval", static_cast<double>(checkpoint_interval), 1, 1e12);
  RequireRange("keep-checkpoints", keep_checkpoints, 1, 1000);
}

TrainConfig Preset(const std::string& name) {
  TrainConfig c;
  if (name == "fast") return c;
  if (name != "paper") throw UserError("--preset: '" + name + "' is not fast or paper");
  c.preset = name;
  c.steps = 2000000;
  c.epochs = 10;
  c.gamma = 0.95;
  c.minibatch = 800;
  // Table S2 gives no network sizes. The release's 256-256-256 (an option away)
  // takes four times as long on a small machine.
  c.actor_hidden = {128, 128};
  c.critic_hidden = {128, 128};
  c.activation = "relu";
  c.lr = 3e-4;
  c.critic_lr = 3e-4;
  c.lr_final = 1.0;
  c.entropy = 0.001;
  c.initial_log_std = -0.5;
  return c;
}

Scenario VariantScenario(const Scenario& scenario, const std::string& variant) {
  Scenario s = scenario;
  if (variant == "stg") return s;
  s.observation.graph = false;
  s.reward.kind = task::RewardKind::kReleaseRaw;
  task::RewardWeights raw;
  raw.tracking = 0.55;
  raw.observation = 0.20;
  raw.coordination = 0.10;
  raw.communication = 0.05;
  raw.semantic = 0.0;
  raw.control_cost = 0.08;
  raw.separation = scenario.reward.weights.separation;
  s.reward.weights = raw;
  if (variant == "semantic") return s;
  s.observation.tracking = false;
  s.observation.semantic = false;
  if (variant == "velocity3") return s;
  if (variant != "tau6") {
    throw UserError("--variant: '" + variant + "' is not stg, semantic, velocity3 or tau6");
  }
  s.control.interface = dynamics::ActionInterface::kTau6;
  s.control.action_scale = 0.18;
  s.control.smoothing = 0.0;
  s.control.max_delta = 0.0;
  return s;
}

Scenario ValidationScenario(const Scenario& scenario, const std::string& variant) {
  Scenario s = VariantScenario(scenario, variant);
  s.reward = scenario.reward;
  return s;
}

nlohmann::ordered_json ToJson(const TrainConfig& config) {
  nlohmann::ordered_json json;
  json["preset"] = config.preset;
  json["variant"] = config.variant;
  VisitTrainConfig(config,
                   [&](const char* name, const auto& field, const char*) { json[name] = field; });
  return json;
}

TrainConfig TrainConfigFromJson(const nlohmann::ordered_json& json) {
  TrainConfig c;
  try {
    c.preset = json.at("preset").get<std::string>();
    c.variant = json.at("variant").get<std::string>();
    std::size_t fields = 2;
    VisitTrainConfig(c, [&](const char* name, auto& field, const char*) {
      json.at(name).get_to(field);
      ++fields;
    });
    if (json.size() != fields) throw UserError("training configuration: unknown fields");
  } catch (const nlohmann::json::exception& error) {
    throw UserError(std::string("training configuration: ") + error.what());
  }
  return c;
}

}  // namespace stg::learn
