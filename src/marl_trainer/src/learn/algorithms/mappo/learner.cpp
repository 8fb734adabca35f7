#include "marl_trainer/learn/algorithms/mappo/learner.hpp"

#include <algorithm>
#include <cmath>

namespace stg::learn {
namespace {

/// Value targets that the value normaliser remembers [environment steps].
constexpr double kValueMemory = 100000.0;

int StateSize(const Scenario& scenario) {
  return env::EnvGroup(scenario, env::EnvOptions()).state_size();
}

}  // namespace

Learner::Learner(const Scenario& scenario, const TrainConfig& config, WorkerPool* pool)
    : config_(config),
      networks_(scenario, StateSize(scenario), config),
      update_(networks_, config_, scenario.agents, pool),
      observation_moments_(networks_.actor.inputs()),
      state_moments_(networks_.critic.inputs()),
      value_moments_(1) {
  UpdateInputScales();
}

void Learner::Initialise(TrainState* state) const {
  state->parameters = networks_.Initialise(config_.seed, config_.initial_log_std);
  state->adam = AdamState();
  state->adam.first.assign(networks_.parameters(), 0.0F);
  state->adam.second.assign(networks_.parameters(), 0.0F);
}

bool Learner::Restore(const TrainState& state) {
  const auto fits = [](const std::vector<double>& data, const RunningMoments& moments) {
    return data.size() == moments.Save().size();
  };
  if (state.parameters.size() != networks_.parameters() ||
      state.adam.first.size() != networks_.parameters() ||
      state.adam.second.size() != networks_.parameters() ||
      !fits(state.observation_moments, observation_moments_) ||
      !fits(state.state_moments, state_moments_) || !fits(state.value_moments, value_moments_)) {
    return false;
  }
  observation_moments_.Load(state.observation_moments);
  state_moments_.Load(state.state_moments);
  value_moments_.Load(state.value_moments);
  UpdateInputScales();
  scales_.value_mean = static_cast<float>(value_moments_.mean(0));
  scales_.value_std = static_cast<float>(std::sqrt(value_moments_.variance(0)) + 1e-4);
  return true;
}

void Learner::Save(TrainState* state) const {
  state->observation_moments = observation_moments_.Save();
  state->state_moments = state_moments_.Save();
  state->value_moments = value_moments_.Save();
}

Learner::Report Learner::Update(const std::vector<const RolloutBuffer*>& rollouts,
                                std::uint32_t collection, double learning_rate_scale,
                                TrainState* state, double imitation) {
  Report report;
  UpdateValueScale(rollouts, state, &report);
  report.update = update_.Run(rollouts, scales_, collection, learning_rate_scale,
                              &state->parameters, &state->adam, imitation);
  return report;
}

void Learner::AddMoments(const RunningMoments& observations, const RunningMoments& states) {
  observation_moments_.Merge(observations);
  state_moments_.Merge(states);
}

void Learner::UpdateInputScales() {
  const auto floor = static_cast<float>(config_.std_floor);
  const auto clip = static_cast<float>(config_.observation_clip);
  scales_.observations = Normaliser::From(observation_moments_, floor, clip);
  for (float& std : scales_.observations.std) std *= static_cast<float>(config_.std_scale);
  scales_.states = Normaliser::From(state_moments_, floor, clip);
}

void Learner::UpdateValueScale(const std::vector<const RolloutBuffer*>& rollouts, TrainState* state,
                               Report* report) {
  RunningMoments targets(1), errors(1), rewards(1);
  for (const RolloutBuffer* b : rollouts) {
    std::vector<float> target(b->advantages.size());
    for (std::size_t i = 0; i < target.size(); ++i) target[i] = b->advantages[i] + b->values[i];
    targets.Add(target.data(), static_cast<int>(target.size()));
    errors.Add(b->advantages.data(), static_cast<int>(target.size()));
    rewards.Add(b->rewards.data(), static_cast<int>(target.size()));
  }
  report->reward = rewards.mean(0);
  report->explained_variance = 1.0 - errors.variance(0) / std::max(targets.variance(0), 1e-12);
  value_moments_.Merge(targets);
  value_moments_.LimitCount(kValueMemory);
  RescaleCritic(value_moments_.mean(0), std::sqrt(value_moments_.variance(0)) + 1e-4,
                &state->parameters);
}

/// Changes the value normaliser and, with it, the critic's last layer, so that
/// no prediction changes (PopArt, van Hasselt et al. 2016).
void Learner::RescaleCritic(double mean, double std, std::vector<float>* parameters) {
  const Mlp& critic = networks_.critic;
  const int last = critic.layers() - 1;
  float* p = parameters->data() + networks_.critic_offset();
  const double ratio = static_cast<double>(scales_.value_std) / std;
  for (int i = 0; i < critic.layer_inputs(last); ++i) {
    float& w = p[critic.weight_offset(last) + static_cast<std::size_t>(i)];
    w = static_cast<float>(static_cast<double>(w) * ratio);
  }
  float& bias = p[critic.bias_offset(last)];
  bias = static_cast<float>(static_cast<double>(bias) * ratio +
                            (static_cast<double>(scales_.value_mean) - mean) / std);
  scales_.value_mean = static_cast<float>(mean);
  scales_.value_std = static_cast<float>(std);
}

}  // namespace stg::learn
