#include "marl_trainer/learn/algorithms/off_policy/replay_config.hpp"

#include "auv_common/error.hpp"
#include "marl_trainer/learn/train_config.hpp"

namespace stg::learn {

void ReplayConfig::Describe(config::Table* t) {
  t->Add("replay", &replay, {1, 1e9}, "-",
         "environment steps in the replay buffer; a checkpoint contains all of them");
  t->Add("warmup", &warmup, {0, 1e9}, "-",
         "environment steps with random actions before the first update");
  t->Add("batch", &batch, {1, 1e6}, "-",
         "environment steps from the replay buffer per gradient step");
  t->Add("replayed", &replayed, {0, 1000}, "-",
         "number of samples drawn from the replay buffer per environment step");
  t->Add("n-step", &n_step, {1, 100}, "-",
         "rewards of a sample before the bootstrapped value (n-step return)");
  t->Add("gamma", &gamma, {0, 0.9999}, "-", "discount per decision");
  t->Add("tau", &tau, {1e-6, 1}, "-",
         "share by which the target networks move at each gradient step");
  t->Add("actor-hidden", Widths(&actor_hidden), {1, 4096}, "-",
         "widths of the hidden layers of the network that decides (actor or Q-network)");
  t->Add("activation", config::Enum(&activation, {"tanh", "relu"}), config::kNone, "-",
         "activation of the hidden layers: tanh or relu");
  t->Add("lr", &lr, {1e-8, 1}, "-",
         "Adam's learning rate of the network that decides, at the start");
  t->Add("lr-final", &lr_final, {0, 1}, "-",
         "learning rates at the end, as a share of those at the start (linear)");
  t->Add("adam-eps", &adam_eps, {1e-12, 1}, "-", "Adam's epsilon");
  t->Add("grad-clip", &grad_clip, {1e-6, 1e6}, "-", "largest gradient norm");
  t->Add("observation-clip", &observation_clip, {0.1, 1e6}, "-",
         "bound of normalised observations and states");
  t->Add("std-floor", &std_floor, {1e-6, 1}, "-", "smallest standard deviation of the normalisers");
}

void ReplayConfig::DescribeCritics(config::Table* t) {
  t->Add("critic-hidden", Widths(&critic_hidden), {1, 4096}, "-",
         "widths of the hidden layers of the critics");
  t->Add("layer-norm", &layer_norm, config::kNone, "-",
         "the critics normalise their hidden layers");
  t->Add("action-gain", &action_gain, {1e-3, 1e3}, "-",
         "factor on the critics' input of actions in [-1, 1]; above 1, the critics distinguish "
         "small actions better");
  t->Add("critic-lr", &critic_lr, {1e-8, 1}, "-",
         "Adam's learning rate of the critics at the start");
}

void ReplayConfig::ApplyPreset(const std::string& preset, TrainConfig* common) {
  common->envs = 128;
  common->horizon = 20;
  // A checkpoint contains the replayed steps, which are some hundred megabytes.
  common->keep_checkpoints = 1;
  common->checkpoint_interval = 200000;
  if (preset == "fast") return;
  if (preset != "paper") throw UserError("--preset: '" + preset + "' is not fast or paper");
  common->steps = 2000000;
  batch = 1024;
  replayed = 2.0;
  n_step = 1;
  gamma = 0.95;
  tau = 0.005;
  actor_hidden = {128, 128};
  lr = critic_lr = 3e-4;
  lr_final = 1.0;
  layer_norm = false;
  action_gain = 1.0;
}

void ReplayConfig::ValidateOrThrow(const TrainConfig& common) const {
  const std::int64_t collection = static_cast<std::int64_t>(common.envs) * common.horizon;
  RequireOption(
      replay >= collection, "replay",
      "must be at least one collection, envs times horizon: " + std::to_string(collection));
}

}  // namespace stg::learn
