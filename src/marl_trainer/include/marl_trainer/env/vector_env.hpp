#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "marl_trainer/env/env_arrays.hpp"
#include "marl_trainer/scenario/scenario.hpp"
#include "marl_trainer/task/metrics.hpp"

namespace stg::env {

class EnvGroup;

/// Environments of a mix of scenarios take turns in blocks of this many: environment e flies
/// scenario (e / kMixBlock) mod n. A constant of the seed rule, whatever the machine.
inline constexpr int kMixBlock = 4;

/// Which environments a VectorEnv runs, and which episodes they draw.
struct VectorEnvOptions {
  /// The k-th episode of environment e (counted from 0, through all objects that share the
  /// numbering) is global reset r = e + k * total_envs and is drawn from seed + r.
  std::uint64_t seed = 0;
  int envs = kMixBlock;     ///< environments of this object
  int first_env = 0;        ///< index of its first one
  int total_envs = 0;       ///< of all objects together; 0: `envs`
  bool curriculum = false;  ///< easy, medium, hard by r, where scenario.reset.curriculum says so
  /// The first episodes of the blocks of kMixBlock are cut to lengths spread evenly over an
  /// episode, so that not all environments end at the same time.
  bool stagger = false;
};

/// Any number of environments of one scenario, or of a mix of scenarios of one layout. Episodes
/// end by truncation only and restart at once. Nothing depends on how many environments run
/// together but speed. Not thread-safe: one object per worker.
class VectorEnv {
 public:
  /// Throws UserError for an empty mix, scenarios whose arrays differ in size, or options out of
  /// range.
  VectorEnv(const std::vector<Scenario>& mix, const VectorEnvOptions& options);
  VectorEnv(const Scenario& scenario, const VectorEnvOptions& options);
  ~VectorEnv();
  VectorEnv(VectorEnv&&) noexcept;

  /// Starts the first episode of every environment. Writes observations and states.
  void Reset(const EnvArrays& out) { RestartAt(0, out); }
  /// Starts the k-th episode of every environment (resuming a run); it is cut if `stagger` says so.
  void RestartAt(std::uint64_t k, const EnvArrays& out);
  /// One decision of every AUV. Writes all arrays.
  /// @param actions [envs, agents, action_size], clipped to [-1, 1]; finite.
  void Step(const float* actions, const EnvArrays& out);
  void Step(const double* actions, const EnvArrays& out);

  int envs() const { return options_.envs; }
  int agents() const { return mix_.front().agents; }
  int action_size() const { return mix_.front().action_size(); }
  int observation_size() const { return mix_.front().observation_size(); }
  int state_size() const;
  /// The scenario that an environment of this object flies.
  const Scenario& scenario(int env = 0) const;
  /// Arrays of the right sizes.
  EnvMemory MakeMemory() const { return {envs(), agents(), observation_size(), state_size()}; }

  /// Of the episode that runs now: decisions made, k of the seed rule, world seed.
  int step(int env) const;
  std::uint64_t round(int env) const;
  std::uint64_t seed(int env) const;
  /// Of the episode that ended last; valid while truncated.
  const task::EpisodeMetrics& metrics(int env) const;

  /// The environments by SIMD register, for controllers that read true states.
  struct Slice {
    const EnvGroup* group;
    int first, count;  ///< environments first .. first + count - 1 are its lanes 0 .. count - 1
  };
  const std::vector<Slice>& slices() const { return slices_; }

 private:
  template <class Number>
  void StepAll(const Number* actions, const EnvArrays& out);
  void WriteStart(const Slice& slice, const EnvArrays& out) const;
  int stagger(int env) const;
  const Slice& SliceOf(int env) const;

  std::vector<Scenario> mix_;
  VectorEnvOptions options_;
  std::vector<EnvGroup> groups_;
  std::vector<Slice> slices_;
  std::vector<int> slice_of_;    // [envs]
  std::vector<double> actions_;  // of one group
};

}  // namespace stg::env
