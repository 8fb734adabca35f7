#pragma once

#include <pybind11/numpy.h>

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "stg_env/env/decide.hpp"
#include "stg_python/env/env_pool.hpp"

namespace stg::python {

namespace py = pybind11;

/// An EnvPool that writes to numpy arrays of the caller, without the GIL.
///
/// Every call checks its arguments before it changes anything: after an exception the environments
/// are unchanged. RuntimeError is raised for a second thread's call while another call is running,
/// and for any call in a process that was forked from the one that made the environments.
class BoundEnv {
 public:
  BoundEnv(const std::vector<Scenario>& mix, const env::VectorEnvOptions& options, int workers);
  ~BoundEnv();
  BoundEnv(const BoundEnv&) = delete;
  BoundEnv& operator=(const BoundEnv&) = delete;

  /// Sets the arrays that later calls write to; None: not wanted. The names must be names of
  /// EnvArrays.
  void Bind(const py::dict& arrays);

  void RestartAt(std::uint64_t k);
  void Reseed(std::uint64_t seed);
  void ResetEnv(int env, std::uint64_t seed);
  /// Makes one decision. Returns the number of environments whose episode ended.
  int Step(const py::handle& actions);
  /// The same for one environment. @param actions {name of an AUV: array [action_size]}
  int StepAgents(const py::dict& actions);
  /// Actions [envs, agents, action_size] of a policy file or built-in controller.
  py::array_t<float> Decide(const std::string& name, bool privileged);
  void Close();

  py::dict Metrics(int env) const;
  py::dict Snapshot(int env) const;
  /// The rows of the layout `stg-2:entities` for one AUV, by name.
  py::dict Entities(int env, int agent) const;
  /// Lets an AUV follow another target from the next decision on, if targets are chosen freely.
  void Follow(int env, int agent, int target);
  int followed(int env, int agent) const;
  Scenario scenario(int env) const;
  std::uint64_t seed(int env) const;
  std::uint64_t round(int env) const;
  int step(int env) const;

  int envs() const { return envs_; }
  int workers() const { return pool().workers(); }

 private:
  /// Reserves the environments for one caller as long as this object lives.
  class Use {
   public:
    explicit Use(const BoundEnv* env);
    ~Use() { env_.busy_.clear(std::memory_order_release); }
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

   private:
    const BoundEnv& env_;
  };

  const EnvPool& pool() const;
  EnvPool::Place at(int env) const;
  void RequireEnv(int env) const;
  void RequireAgent(int agent) const;
  template <class Number>
  int StepChecked(const Number* actions);
  const agent::Decider& ControllerOf(const std::string& name, bool privileged);
  void RequireBound() const;

  std::unique_ptr<EnvPool> pool_;
  int envs_, agents_, action_size_, observation_size_, state_size_;
  py::dict arrays_;  ///< keeps the arrays alive
  env::EnvArrays out_;
  std::vector<py::str> names_;  ///< names of the AUVs
  std::vector<float> actions_;  ///< [agents, action_size], of StepAgents
  agent::Decider controller_;
  mutable std::atomic_flag busy_ = ATOMIC_FLAG_INIT;
  int process_;
};

}  // namespace stg::python
