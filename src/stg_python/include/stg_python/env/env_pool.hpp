#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "auv_common/parallel/worker_pool.hpp"
#include "stg_env/env/vector_env.hpp"

namespace stg::python {

/// The environments of one learner on any number of threads: one env::VectorEnv per thread, which
/// share the numbering of environments, so that nothing but speed depends on the threads. All
/// arrays are those of all environments. Not thread-safe.
class EnvPool {
 public:
  /// @param options `envs` of them; `first_env` and `total_envs` are set here
  /// @param workers threads, the caller's included; at most one for each kMixBlock environments
  /// are used. Throws UserError as VectorEnv does, for fewer than one, and for more
  /// environments than this machine's memory holds.
  EnvPool(const std::vector<Scenario>& mix, const env::VectorEnvOptions& options, int workers);

  void Reseed(std::uint64_t seed);
  /// See VectorEnv; `env` counts through all threads.
  void RestartAt(std::uint64_t k, const env::EnvArrays& out);
  void ResetEnv(int env, std::uint64_t seed, const env::EnvArrays& out);
  /// @param actions [envs, agents, action_size], finite
  void Step(const float* actions, const env::EnvArrays& out);
  void Step(const double* actions, const env::EnvArrays& out);

  /// Whose environment it is, and its number there.
  struct Place {
    const env::VectorEnv& envs;
    int env;
  };
  Place at(int env) const;
  /// What one thread runs: its environments from `first` on.
  struct Part {
    std::unique_ptr<env::VectorEnv> envs;
    int first;
  };
  const std::vector<Part>& parts() const { return parts_; }

  int envs() const { return envs_; }
  int workers() const { return static_cast<int>(parts_.size()); }

 private:
  template <class Number>
  void StepAll(const Number* actions, const env::EnvArrays& out);
  env::EnvArrays PartOf(const env::EnvArrays& out, const Part& part) const;

  int envs_;
  std::vector<Part> parts_;
  WorkerPool pool_;
};

}  // namespace stg::python
