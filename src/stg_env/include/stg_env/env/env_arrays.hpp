#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace stg::env {

/// Output arrays of an environment. The caller owns them. They are row-major without gaps, in C's
/// order of indices, and have the same layout in every language. A null pointer: the array is not
/// written.
struct EnvArrays {
  float* observations = nullptr;  ///< [envs, agents, observation_size], of the decision to come
  float* states = nullptr;        ///< [envs, state_size], true state of the swarm, for a critic
  float* rewards = nullptr;       ///< [envs, agents], of the step just made
  float* team_rewards = nullptr;  ///< [envs], mean of `rewards` over the AUVs
  /// [envs]: 1 where the step ended the episode (always by truncation); observations and states
  /// then belong to the next episode.
  std::uint8_t* truncated = nullptr;
  /// As observations and states, for the episode that ended. Written where truncated; other rows
  /// keep their values.
  float* final_observations = nullptr;
  float* final_states = nullptr;
};

/// Memory for all arrays of an environment.
class EnvMemory {
 public:
  EnvMemory(int envs, int agents, int observation_size, int state_size)
      : envs_(envs), agents_(agents), observation_size_(observation_size), state_size_(state_size) {
    const auto rows = static_cast<std::size_t>(envs) * static_cast<std::size_t>(agents);
    observations.resize(rows * static_cast<std::size_t>(observation_size));
    states.resize(static_cast<std::size_t>(envs) * static_cast<std::size_t>(state_size));
    rewards.resize(rows);
    team_rewards.resize(static_cast<std::size_t>(envs));
    truncated.resize(static_cast<std::size_t>(envs));
    final_observations.resize(observations.size());
    final_states.resize(states.size());
  }

  EnvArrays arrays() {
    return {observations.data(), states.data(),    rewards.data(),
            team_rewards.data(), truncated.data(), final_observations.data(),
            final_states.data()};
  }
  const float* observation(int env, int agent) const {
    return observations.data() + static_cast<std::ptrdiff_t>(env * agents_ + agent) *
                                     static_cast<std::ptrdiff_t>(observation_size_);
  }
  const float* state(int env) const {
    return states.data() +
           static_cast<std::ptrdiff_t>(env) * static_cast<std::ptrdiff_t>(state_size_);
  }
  float reward(int env, int agent) const {
    return rewards[static_cast<std::size_t>(env * agents_ + agent)];
  }
  int envs() const { return envs_; }

  std::vector<float> observations, states, rewards, team_rewards;
  std::vector<std::uint8_t> truncated;
  std::vector<float> final_observations, final_states;

 private:
  int envs_, agents_, observation_size_, state_size_;
};

}  // namespace stg::env
