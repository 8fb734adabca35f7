#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "auv_common/parallel/worker_pool.hpp"
#include "stg_env/env/vector_env.hpp"

namespace stg::python {

/// The environments of one learner on any number of threads: one env::VectorEnv per thread. The
/// threads share the numbering of environments, so they affect nothing but the speed. All arrays
/// are for all environments. Not thread-safe.
class EnvPool {
 public:
  /// @param options number of environments in `envs`; `first_env` and `total_envs` are set here
  /// @param workers number of threads, including the caller's; more than one for each kMixBlock
  /// environments are not used. Throws UserError as VectorEnv does, for fewer than one worker, and
  /// for more environments than the memory of this machine allows.
  EnvPool(const std::vector<Scenario>& mix, const env::VectorEnvOptions& options, int workers);

  void Reseed(std::uint64_t seed);
  /// See VectorEnv; `env` counts the environments of all threads.
  void RestartAt(std::uint64_t k, const env::EnvArrays& out);
  void ResetEnv(int env, std::uint64_t seed, const env::EnvArrays& out);
  /// @param actions [envs, agents, action_size], finite
  void Step(const float* actions, const env::EnvArrays& out);
  void Step(const double* actions, const env::EnvArrays& out);

  /// The VectorEnv of an environment, and its number there.
  struct Place {
    const env::VectorEnv& envs;
    int env;
  };
  Place at(int env) const;
  /// The environments of one thread, from `first` on.
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
