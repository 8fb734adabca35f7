#include "marl_trainer/learn/algorithms/on_policy/ppo_config.hpp"

#include <algorithm>

#include "auv_common/error.hpp"
#include "marl_trainer/learn/train_config.hpp"

namespace stg::learn {

void PpoConfig::Describe(config::Table* t) {
  t->Add("epochs", &epochs, {1, 1000}, "-", "passes over the collected steps per update");
  t->Add("minibatch", &minibatch, {1, 1e9}, "-", "environment steps per gradient step");
  t->Add("actor-hidden", Widths(&actor_hidden), {1, 4096}, "-",
         "widths of the actor's hidden layers");
  t->Add("critic-hidden", Widths(&critic_hidden), {1, 4096}, "-",
         "widths of the critic's hidden layers");
  t->Add("activation", config::Enum(&activation, {"tanh", "relu"}), config::kNone, "-",
         "activation of the hidden layers: tanh or relu");
  t->Add("lr", &lr, {1e-8, 1}, "-", "Adam's learning rate of the actor at the start");
  t->Add("critic-lr", &critic_lr, {1e-8, 1}, "-",
         "Adam's learning rate of the critic at the start");
  t->Add("lr-final", &lr_final, {0, 1}, "-",
         "learning rates at the end, as a share of those at the start (linear)");
  t->Add("adam-eps", &adam_eps, {1e-12, 1}, "-", "Adam's epsilon");
  t->Add("gamma", &gamma, {0, 1}, "-", "discount per decision");
  t->Add("lambda", &lambda, {0, 1}, "-", "GAE's lambda");
  t->Add("clip", &clip, {1e-3, 10}, "-", "PPO's clip of the probability ratio");
  t->Add("entropy", &entropy, {0, 10}, "-", "weight of the entropy bonus");
  t->Add("value-weight", &value_weight, {0, 100}, "-", "weight of the critic's loss");
  t->Add("grad-clip", &grad_clip, {1e-6, 1e6}, "-",
         "largest gradient norm of the actor and of the critic");
  t->Add("target-kl", &target_kl, {0, 100}, "-",
         "KL divergence that ends an update early; 0: never");
  t->Add("initial-log-std", &initial_log_std, {-20, 2}, "-",
         "log sigma of the exploration at the start");
  t->Add("min-log-std", &min_log_std, {-20, 2}, "-", "lower bound of log sigma");
  t->Add("max-log-std", &max_log_std, {-20, 2}, "-", "upper bound of log sigma");
  t->Add("observation-clip", &observation_clip, {0.1, 1e6}, "-",
         "bound of normalised observations and states");
  t->Add("std-floor", &std_floor, {1e-6, 1}, "-", "smallest standard deviation of the normalisers");
  t->Add("std-scale", &std_scale, {1e-3, 1e3}, "-",
         "the actor's inputs are divided by their standard deviation times this value; below 1, "
         "offsets near the target become larger inputs and distant offsets are clipped");
  imitation.Describe(t);
}

void PpoConfig::ApplyPreset(const std::string& preset, TrainConfig* common) {
  if (preset == "fast") return;
  if (preset != "paper") throw UserError("--preset: '" + preset + "' is not fast or paper");
  common->steps = 2000000;
  common->horizon = 100;
  epochs = 10;
  gamma = 0.95;
  minibatch = 800;
  // Table S2 gives no network sizes. The release has 256-256-256, which an option can set. It takes
  // four times as long on a small machine.
  actor_hidden = {128, 128};
  critic_hidden = {128, 128};
  activation = HiddenActivation::kRelu;
  lr = 3e-4;
  critic_lr = 3e-4;
  lr_final = 1.0;
  entropy = 0.001;
  initial_log_std = -0.5;
}

void PpoConfig::ValidateOrThrow(const TrainConfig& common) const {
  imitation.ValidateOrThrow();
  const std::int64_t samples = static_cast<std::int64_t>(common.envs) * common.horizon;
  RequireOption(samples % minibatch == 0, "minibatch",
                "must divide envs times horizon, " + std::to_string(samples));
  RequireOption(min_log_std <= max_log_std, "max-log-std", "must not be below --min-log-std");
  RequireOption(min_log_std <= initial_log_std && initial_log_std <= max_log_std, "initial-log-std",
                "must be between --min-log-std and --max-log-std");
}

void PpoConfig::ApplyRecordings(const TrainConfig& common) {
  epochs = 10;
  lr = critic_lr = 3e-3;
  lr_final = 1.0;
  target_kl = 0.1;
  minibatch = std::min(500, common.horizon);
  while (common.horizon % minibatch != 0) --minibatch;
  moment_stride = 1;
}

void PpoConfig::FitPolicy(const agent::Policy& policy) {
  const agent::Policy::Parameters& p = policy.parameters();
  actor_hidden.clear();
  for (std::size_t l = 0; l + 1 < p.layers.size(); ++l) {
    actor_hidden.push_back(static_cast<int>(p.layers[l].bias.size()));
  }
  activation = p.activation == agent::Policy::Activation::kRelu ? HiddenActivation::kRelu
                                                                : HiddenActivation::kTanh;
  observation_clip = static_cast<double>(p.input_clip);
  // A component that never changed has the smallest deviation: the scaled floor.
  const auto smallest = static_cast<double>(p.input_std.minCoeff());
  if (smallest < std_floor * std_scale) std_scale = smallest / std_floor;
}

}  // namespace stg::learn
