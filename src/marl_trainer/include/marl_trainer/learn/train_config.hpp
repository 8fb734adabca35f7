#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "marl_trainer/scenario/scenario.hpp"

namespace stg::learn {

/// Everything of a training run besides the scenario and its output folder.
/// Defaults are the `fast` preset.
struct TrainConfig {
  std::string preset = "fast";
  std::string variant = "stg";
  std::uint64_t seed = 0;
  std::int64_t steps = 500000;

  int envs = 64;
  int horizon = 100;
  int epochs = 3;
  int minibatch = 1600;
  std::vector<int> actor_hidden{64, 64};
  std::vector<int> critic_hidden{64, 64};
  std::string activation = "tanh";
  double lr = 3e-3;
  double critic_lr = 3e-3;
  double lr_final = 0.1;
  double adam_eps = 1e-5;
  double gamma = 0.9;
  double lambda = 0.95;
  double clip = 0.2;
  double entropy = 0.0;
  double value_weight = 0.5;
  double grad_clip = 5.0;
  double target_kl = 0.0;
  double initial_log_std = -1.0;
  double min_log_std = -4.0;
  double max_log_std = 0.0;
  double observation_clip = 10.0;
  double std_floor = 0.01;
  double std_scale = 1.0;
  bool stagger = true;

  std::string imitate;  ///< built-in controller to start from; empty: none
  std::int64_t imitation_steps = 0;
  double imitation_share = 1.0;
  double imitation_focus = 1.0;
  bool privileged_teacher = false;
  std::string start_from;   ///< folder of another run; empty: untrained networks
  double wall_units = 0.0;  ///< margin [m] of ActorCritic::PlaceWallUnits; 0: none

  std::int64_t validation_interval = 32000;
  int validation_episodes = 32;
  std::int64_t checkpoint_interval = 128000;
  int keep_checkpoints = 3;

  /// Throws UserError naming the option.
  void ValidateOrThrow() const;
};

/// Calls visit(name, field, description) for every field that is an option of
/// the command line; one list for options, dump and comparison.
template <class Config, class Visitor>
void VisitTrainConfig(Config& c, Visitor&& visit) {
  visit("seed", c.seed, "seed of weights, exploration and episodes");
  visit("steps", c.steps, "environment steps to train for");
  visit("envs", c.envs, "parallel environments");
  visit("horizon", c.horizon, "decisions of each environment between two updates");
  visit("epochs", c.epochs, "passes over the collected steps per update");
  visit("minibatch", c.minibatch, "environment steps per gradient step");
  visit("actor-hidden", c.actor_hidden, "widths of the actor's hidden layers");
  visit("critic-hidden", c.critic_hidden, "widths of the critic's hidden layers");
  visit("activation", c.activation, "of the hidden layers: tanh or relu");
  visit("lr", c.lr, "Adam's learning rate of the actor at the start");
  visit("critic-lr", c.critic_lr, "Adam's learning rate of the critic at the start");
  visit("lr-final", c.lr_final, "share of the learning rates left at the end (linear)");
  visit("adam-eps", c.adam_eps, "Adam's epsilon");
  visit("gamma", c.gamma, "discount per decision");
  visit("lambda", c.lambda, "GAE's lambda");
  visit("clip", c.clip, "PPO's clip of the probability ratio");
  visit("entropy", c.entropy, "weight of the entropy bonus");
  visit("value-weight", c.value_weight, "weight of the critic's loss");
  visit("grad-clip", c.grad_clip, "largest gradient norm of the actor and of the critic");
  visit("target-kl", c.target_kl, "KL divergence that ends an update early; 0: never");
  visit("initial-log-std", c.initial_log_std, "log sigma of the exploration at the start");
  visit("min-log-std", c.min_log_std, "lower bound of log sigma");
  visit("max-log-std", c.max_log_std, "upper bound of log sigma");
  visit("observation-clip", c.observation_clip, "bound of normalised observations and states");
  visit("std-floor", c.std_floor, "smallest standard deviation of the normalisers");
  visit("std-scale", c.std_scale,
        "the actor's inputs are divided by this much of their standard deviation: below 1, the "
        "neighbourhood of the target is seen larger and distant offsets are clipped");
  visit("stagger", c.stagger, "spread the ends of the first episodes");
  visit("imitate", c.imitate,
        "built-in controller whose actions the policy first learns, with constants if need be, as "
        "in pursuit_separated:gain=2,cap=0.5; empty: none");
  visit("imitation-steps", c.imitation_steps,
        "environment steps of imitation: in full for the first half, then fading into the return");
  visit("imitation-share", c.imitation_share,
        "share of the actor's loss that is imitation where it is in full");
  visit("imitation-focus", c.imitation_focus,
        "misses weigh by the size of the teacher's action, in sigmas, to minus this power: 0 all "
        "alike, 2 little more than the hold");
  visit("privileged-teacher", c.privileged_teacher,
        "the controller to imitate reads true states, as the critic does; the policy never does");
  visit("start-from", c.start_from,
        "folder of a finished run whose networks and normalisers to start from; steps, optimiser "
        "and exploration start anew; empty: untrained networks");
  visit("wall-units", c.wall_units,
        "with --start-from and relu: 24 units of the actor's first layer start anew as hinges on "
        "the target's room to each wall, at 1/2, 1, 2 and 4 times this margin [m]; 0: none");
  visit("validation-interval", c.validation_interval, "environment steps between validations");
  visit("validation-episodes", c.validation_episodes, "held-out episodes per validation");
  visit("checkpoint-interval", c.checkpoint_interval, "environment steps between checkpoints");
  visit("keep-checkpoints", c.keep_checkpoints, "checkpoints kept");
}

/// `fast` (ours) or `paper` (Table S2); UserError for another name.
TrainConfig Preset(const std::string& name);

/// The scenario a variant of Table S9 trains in:
/// - stg: unchanged;
/// - semantic: observation without the graph block, raw reward;
/// - velocity3: raw observation, raw reward;
/// - tau6: raw observation, force interface (scale 0.18, no smoothing or rate
///   limit), raw reward.
/// The raw reward is the release's for its baselines. Returns of trainings with
/// different rewards do not compare, so validation and evaluation always use the
/// unchanged scenario's reward (ValidationScenario).
Scenario VariantScenario(const Scenario& scenario, const std::string& variant);
/// VariantScenario with the reward of `scenario`, in the scenario's own stage.
Scenario ValidationScenario(const Scenario& scenario, const std::string& variant);

nlohmann::ordered_json ToJson(const TrainConfig& config);
/// Inverse of ToJson; UserError on a missing or unknown field.
TrainConfig TrainConfigFromJson(const nlohmann::ordered_json& json);

/// First validation episode's seed; episode r uses this + r. Evaluations start
/// at 3000 and trainings at TrainingSeed, so that the three never share a draw.
inline constexpr std::uint64_t kValidationSeed = 900000;
inline std::uint64_t TrainingSeed(std::uint64_t seed) { return (seed + 1) * 1000000000ULL; }

}  // namespace stg::learn
