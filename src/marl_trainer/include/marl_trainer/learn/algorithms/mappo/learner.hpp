#pragma once

#include <cstdint>
#include <vector>

#include "marl_trainer/learn/algorithms/mappo/ppo.hpp"
#include "marl_trainer/learn/checkpoint.hpp"

namespace stg::learn {

/// MAPPO (Eqs. 37-44) on rollouts from anywhere, with the normalisers of what the networks see and
/// predict. Weights and optimiser live in the TrainState that every call names.
class Learner {
 public:
  struct Report {
    UpdateReport update;
    double reward = 0.0;              ///< mean over steps of the team's reward
    double explained_variance = 0.0;  ///< of the value targets, by the critic that acted
  };

  Learner(const Scenario& scenario, const TrainConfig& config, WorkerPool* pool);

  /// Untrained weights and a fresh optimiser.
  void Initialise(TrainState* state) const;
  /// Takes the normalisers of a checkpoint; false when its sizes are not those of the networks.
  bool Restore(const TrainState& state);
  /// Writes the normalisers into the state.
  void Save(TrainState* state) const;

  /// One update. The number of samples must be a multiple of the minibatch.
  /// @param collection number of the update, for the order of the minibatches.
  /// @param learning_rate_scale multiplies both learning rates.
  /// @param imitation share of the teacher in the actor's loss, see PpoBatch.
  Report Update(const std::vector<const RolloutBuffer*>& rollouts, std::uint32_t collection,
                double learning_rate_scale, TrainState* state, double imitation = 0.0);
  /// Takes in raw observations and states. Call after the update on them: it changes the policy.
  void AddMoments(const RunningMoments& observations, const RunningMoments& states);
  /// Applies what AddMoments took in.
  void UpdateInputScales();

  const ActorCritic& networks() const { return networks_; }
  const Scales& scales() const { return scales_; }

 private:
  void UpdateValueScale(const std::vector<const RolloutBuffer*>& rollouts, TrainState* state,
                        Report* report);
  void RescaleCritic(double mean, double std, std::vector<float>* parameters);

  const TrainConfig config_;
  const ActorCritic networks_;
  PpoUpdate update_;
  RunningMoments observation_moments_, state_moments_, value_moments_;
  Scales scales_;
};

}  // namespace stg::learn
