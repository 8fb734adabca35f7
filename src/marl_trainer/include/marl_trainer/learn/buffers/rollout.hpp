#pragma once

#include <cstdint>
#include <vector>

#include "marl_trainer/env/evaluation.hpp"
#include "marl_trainer/learn/nn/actor_critic.hpp"

namespace stg::learn {

/// What one collection gathers in one unit. Index [t][e][agent]; environment
/// steps [t][e] are the samples of an update.
struct RolloutBuffer {
  std::vector<float> observations;  ///< [T, E, N, F], normalised
  std::vector<float> actions;       ///< [T, E, N, A], before clipping
  std::vector<float> log_prob;      ///< [T, E, N], of those actions
  std::vector<float> teacher;       ///< [T, E, N, A], what the controller to imitate does; or empty
  std::vector<float> states;        ///< [T, E, S], normalised
  std::vector<float> rewards;       ///< [T, E], mean over agents
  std::vector<std::uint8_t> done;   ///< [T, E]
  std::vector<float> values;        ///< [T, E], in units of reward
  std::vector<float> final_values;  ///< [T, E], of the pre-reset state; where done
  std::vector<float> bootstrap;     ///< [E]
  std::vector<float> advantages;    ///< [T, E]
};

/// Means and standard deviation of what the networks see and predict, fixed for
/// one collection and the update after it.
struct Scales {
  Normaliser observations, states;
  float value_mean = 0.0F, value_std = 1.0F;
};

/// The critic's values [rows], in units of reward, of normalised states [rows, S].
/// @param critic scratch memory for at least one row.
void EstimateValues(const ActorCritic& networks, const float* parameters, const Scales& scales,
                    const float* states, int rows, Mlp::Workspace* critic, float* values);

/// A fixed number of environments that one worker steps through a whole
/// collection on its own. The unit of work never depends on the number of
/// workers, so neither do results.
class RolloutUnit {
 public:
  static constexpr int kEnvs = 16;  ///< of a full unit; the last one may be smaller

  /// @param first_env index of the unit's first environment.
  RolloutUnit(const std::vector<Scenario>& scenarios, const ActorCritic& networks,
              const TrainConfig& config, int first_env, int envs);

  /// Steps every environment `horizon` times with exploration, then values and
  /// advantages. Exploration draws depend on (seed, collection, t, row).
  /// @param teach also ask the controller to imitate, at every state visited.
  void Collect(const float* parameters, const Scales& scales, std::uint32_t collection,
               bool teach = false);

  void RestartAt(std::uint64_t round);
  std::uint64_t round() const { return groups_.front().round(); }
  /// True when every environment stands at the start of an episode.
  bool at_episode_start() const;

  int envs() const { return envs_; }
  int samples() const { return envs_ * horizon_; }
  const RolloutBuffer& buffer() const { return buffer_; }
  /// Raw observations and states of the last collection, every kMomentStride-th step.
  const RunningMoments& observation_moments() const { return observation_moments_; }
  const RunningMoments& state_moments() const { return state_moments_; }
  /// Episodes that ended in the last collection.
  const std::vector<task::EpisodeMetrics>& finished() const { return finished_; }
  double env_seconds() const { return env_seconds_; }
  double inference_seconds() const { return inference_seconds_; }

 private:
  static constexpr int kMomentStride = 4;

  void Observe(const Scales& scales, int t);
  void ActRandomly(const float* parameters, std::uint32_t collection, int t);
  void AskTeacher(int t);
  void StoreStep(const Scales& scales, int t);
  void ComputeValues(const float* parameters, const Scales& scales);
  int stagger(std::size_t group) const;

  const ActorCritic& networks_;
  const std::uint64_t seed_;
  const int first_env_, envs_, horizon_, agents_, episode_steps_, total_envs_;
  const bool stagger_;
  const float gamma_, lambda_;
  std::vector<env::EnvGroup> groups_;
  std::vector<env::Controller> teachers_;  // one, or none
  RolloutBuffer buffer_;
  Mlp::Workspace actor_, critic_;
  std::vector<float> raw_observations_, raw_states_, final_states_, last_states_;
  std::vector<int> final_samples_;
  RunningMoments observation_moments_, state_moments_;
  std::vector<task::EpisodeMetrics> finished_;
  double env_seconds_ = 0.0, inference_seconds_ = 0.0;
};

}  // namespace stg::learn
