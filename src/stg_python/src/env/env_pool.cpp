#include "stg_python/env/env_pool.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "auv_common/error.hpp"

namespace stg::python {
namespace {

std::ptrdiff_t Rows(int a, int b = 1, int c = 1) { return static_cast<std::ptrdiff_t>(a) * b * c; }

/// Lower bound of the memory per AUV of an environment in any scenario; `medium` needs 12 KiB.
constexpr double kLeastBytesPerAgent = 8 * 1024.0;

/// Refuses environments that do not fit into memory. They would be swapped or killed after minutes.
void RequireMemory(const std::vector<Scenario>& mix, int envs) {
  const int agents = mix.empty() ? 1 : mix.front().run.agents;
  const double needed = kLeastBytesPerAgent * envs * agents;
  const double there =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  if (needed <= there) return;
  const auto gib = [](double bytes) { return std::to_string(std::lround(bytes / 1073741824.0)); };
  throw UserError("num_envs: " + std::to_string(envs) + " environments of " +
                  std::to_string(agents) + " AUVs need more than " + gib(needed) +
                  " GiB of memory, and this machine has " + gib(there));
}

/// Number of threads with work. The environments of one block share a register.
int Busy(const std::vector<Scenario>& mix, int envs, int workers) {
  if (envs < 1) throw UserError("num_envs must be at least 1, not " + std::to_string(envs));
  RequireMemory(mix, envs);
  if (workers < 1) throw UserError("workers must be at least 1, not " + std::to_string(workers));
  return std::min(workers, (envs + env::kMixBlock - 1) / env::kMixBlock);
}

}  // namespace

EnvPool::EnvPool(const std::vector<Scenario>& mix, const env::VectorEnvOptions& options,
                 int workers)
    : envs_(options.envs), pool_(Busy(mix, options.envs, workers)) {
  const int blocks = (envs_ + env::kMixBlock - 1) / env::kMixBlock;
  for (int w = 0; w < pool_.workers(); ++w) {
    const int first = blocks * w / pool_.workers() * env::kMixBlock;
    const int end = std::min(envs_, blocks * (w + 1) / pool_.workers() * env::kMixBlock);
    env::VectorEnvOptions own = options;
    own.first_env = first;
    own.envs = end - first;
    own.total_envs = envs_;
    parts_.push_back({std::make_unique<env::VectorEnv>(mix, own), first});
  }
}

env::EnvArrays EnvPool::PartOf(const env::EnvArrays& all, const Part& part) const {
  const env::VectorEnv& envs = *part.envs;
  const auto from = [&part](auto* array, std::ptrdiff_t row) {
    return array == nullptr ? nullptr : array + part.first * row;
  };
  const std::ptrdiff_t seen = Rows(envs.agents(), envs.observation_size());
  env::EnvArrays own;
  own.observations = from(all.observations, seen);
  own.states = from(all.states, envs.state_size());
  own.rewards = from(all.rewards, envs.agents());
  own.team_rewards = from(all.team_rewards, 1);
  own.truncated = from(all.truncated, 1);
  own.final_observations = from(all.final_observations, seen);
  own.final_states = from(all.final_states, envs.state_size());
  return own;
}

EnvPool::Place EnvPool::at(int env) const {
  const auto after = std::upper_bound(parts_.begin(), parts_.end(), env,
                                      [](int e, const Part& part) { return e < part.first; });
  const Part& part = *std::prev(after);
  return {*part.envs, env - part.first};
}

void EnvPool::Reseed(std::uint64_t seed) {
  for (const Part& part : parts_) part.envs->Reseed(seed);
}

void EnvPool::RestartAt(std::uint64_t k, const env::EnvArrays& out) {
  pool_.Run(workers(), [&](int w, int) {
    const Part& part = parts_[static_cast<std::size_t>(w)];
    part.envs->RestartAt(k, PartOf(out, part));
  });
}

void EnvPool::ResetEnv(int env, std::uint64_t seed, const env::EnvArrays& out) {
  for (const Part& part : parts_) {
    if (env < part.first || env >= part.first + part.envs->envs()) continue;
    part.envs->ResetEnv(env - part.first, seed, PartOf(out, part));
  }
}

void EnvPool::Step(const float* actions, const env::EnvArrays& out) { StepAll(actions, out); }
void EnvPool::Step(const double* actions, const env::EnvArrays& out) { StepAll(actions, out); }

template <class Number>
void EnvPool::StepAll(const Number* actions, const env::EnvArrays& out) {
  const auto step = [&](int w, int) {
    const Part& part = parts_[static_cast<std::size_t>(w)];
    const env::VectorEnv& envs = *part.envs;
    part.envs->Step(actions + part.first * Rows(envs.agents(), envs.action_size()),
                    PartOf(out, part));
  };
  if (workers() == 1) {
    step(0, 0);
  } else {
    pool_.Run(workers(), step);
  }
}

}  // namespace stg::python
