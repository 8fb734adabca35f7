#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "stg_agent/agent/agent_view.hpp"
#include "stg_env/env/env_arrays.hpp"
#include "stg_env/scenario/scenario.hpp"
#include "stg_env/task/metrics.hpp"
#include "stg_env/task/reward.hpp"
#include "stg_env/task/swarm_state.hpp"

namespace stg::acoustics {
class Channel;
class PacketObserver;
}  // namespace stg::acoustics

namespace stg::env {

class Environment;
struct LaneSet;

/// In a mix of n scenarios, environment e has scenario (e / kMixBlock) mod n. This constant is part
/// of the seed rule and the same on every machine.
inline constexpr int kMixBlock = 4;
/// The largest number of scenarios of a mix of which each one has an environment.
constexpr int MostOfMix(int envs) { return (envs + kMixBlock - 1) / kMixBlock; }

/// Number and seeds of a VectorEnv's environments.
struct VectorEnvOptions {
  /// The k-th episode of environment e (both counted from 0, over all objects that share the
  /// numbering) is global reset r = e + k * total_envs, and is drawn from seed + r.
  std::uint64_t seed = 0;
  int envs = kMixBlock;     ///< environments of this object
  int first_env = 0;        ///< index of its first one
  int total_envs = 0;       ///< of all objects together; 0: `envs`
  bool curriculum = false;  ///< easy, medium, hard by r, with scenario.world.reset.curriculum
  /// The first episodes of the blocks of kMixBlock are shortened to lengths that are spread evenly
  /// over an episode, so that not all environments end at the same time.
  bool stagger = false;
};

/// Any number of environments of one scenario, or of a mix of scenarios of one layout. Episodes
/// end by truncation only and restart at once. Only speed depends on the number of environments
/// that run together. Not thread-safe: one object per worker.
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
  /// Episodes that start from now on are drawn from this seed; k of the seed rule continues.
  void Reseed(std::uint64_t seed) { options_.seed = seed; }
  /// Starts the k-th episode of every environment (resuming a run); it is shortened as `stagger`
  /// requires.
  void RestartAt(std::uint64_t k, const EnvArrays& out);
  /// Starts an episode of one environment at once, drawn from `seed`. The others continue. The next
  /// episode is the one that would have followed the interrupted one. Writes this environment's
  /// rows of observations and states.
  void ResetEnv(int env, std::uint64_t seed, const EnvArrays& out);
  /// Starts an episode of every environment from given world positions [m] and target velocities
  /// [m/s], AUVs at rest (golden traces, tests).
  void Place(const std::vector<Vec3<double>>& p_WB, const std::vector<Vec3<double>>& p_WT,
             const std::vector<Vec3<double>>& v_WT, const EnvArrays& out);
  /// One decision of every AUV. Writes all arrays.
  /// @param actions [envs, agents, action_size], clipped to [-1, 1]. Non-finite ones throw
  /// std::invalid_argument before any environment moves.
  void Step(const float* actions, const EnvArrays& out);
  void Step(const double* actions, const EnvArrays& out);

  int envs() const { return options_.envs; }
  int agents() const { return mix_.front().run.agents; }
  int action_size() const { return mix_.front().world.control.action_size(); }
  int observation_size() const { return observation_size_; }
  int state_size() const { return state_size_; }
  /// The scenario of an environment of this object.
  const Scenario& scenario(int env = 0) const;
  /// Arrays of the right sizes.
  EnvMemory MakeMemory() const { return {envs(), agents(), observation_size(), state_size()}; }

  /// Of the present episode: number of decisions made, k of the seed rule, world seed.
  int step(int env) const;
  std::uint64_t round(int env) const { return round_[static_cast<std::size_t>(env)]; }
  std::uint64_t seed(int env) const;
  /// Metrics of the episode that ended last; valid while truncated.
  const task::EpisodeMetrics& metrics(int env) const {
    return finished_[static_cast<std::size_t>(env)];
  }

  /// True states of one environment, for built-in controllers, tests and traces.
  dynamics::NavState nav(int env, int i) const;
  /// State of an AUV by its own navigation.
  dynamics::NavState navigation(int env, int i) const;
  dynamics::VehicleState<double> vehicle(int env, int i) const;
  /// The present detection of target k by AUV i's own sensor; false: none. See World::Sense.
  bool Sense(int env, int i, int k, dynamics::Detection* detection) const;
  dynamics::TargetState<double> target(int env, int k) const;
  TimeNs time(int env) const;
  task::Tracking<double> tracking(int env, int i) const;
  task::RewardTerms<double> terms(int env, int i) const;
  /// The target that an AUV follows, and whether the AUV is in the swarm.
  int followed(int env, int i) const;
  bool present(int env, int i) const;
  /// The knowledge from which an AUV decides.
  agent::Knowledge<double> knowledge(int env, int i) const;
  /// Acoustic mode only: an AUV's agent, and the network.
  agent::AgentView agent(int env, int i) const;
  const acoustics::Channel& channel(int env) const;
  /// From now on, `observer` gets the reports of all packets of one environment; null: no observer.
  void ObservePackets(int env, acoustics::PacketObserver* observer);

  /// The environments of each SIMD register, for code that also computes on registers.
  struct Slice {
    std::unique_ptr<Environment> lanes;
    int first, count;  ///< environments first .. first + count - 1 are its first lanes
  };
  const std::vector<Slice>& slices() const { return slices_; }

 private:
  template <class Number>
  void StepAll(const Number* actions, const EnvArrays& out);
  template <class Number>
  void TakeActions(const Number* actions);
  void Judge(const Slice& slice, const EnvArrays& out);
  void Restart(const Slice& slice, int lane, bool first);
  void WriteStart(const Slice& slice, const EnvArrays& out) const;
  /// Ends the episodes of some lanes and starts their next ones.
  void Finish(const Slice& slice, const LaneSet& done, const EnvArrays& out);
  int FirstLength(int env) const;
  const Slice& SliceOf(int env) const;
  int lane_of(int env) const { return env - SliceOf(env).first; }

  std::vector<Scenario> mix_;
  VectorEnvOptions options_;
  int observation_size_ = 0, state_size_ = 0;
  std::vector<Slice> slices_;
  std::vector<int> slice_of_;                   // [envs]
  std::vector<std::uint64_t> round_;            // [envs], k of the running episode
  std::vector<task::EpisodeMetrics> finished_;  // [envs]
  std::vector<Pack> wanted_;                    // [slices, agents, action_size]
  std::vector<float> rows_;                     // [lanes], scratch of Finish
};

/// Makes environments for code that does not need their scenario.
class EnvFactory {
 public:
  /// @param mix scenarios as VectorEnv takes them; not empty
  explicit EnvFactory(std::vector<Scenario> mix) : mix_(std::move(mix)) {}
  explicit EnvFactory(const Scenario& scenario) : EnvFactory(std::vector<Scenario>{scenario}) {}

  VectorEnv Make(const VectorEnvOptions& options) const { return {mix_, options}; }
  /// Number of scenarios of the mix.
  int scenarios() const { return static_cast<int>(mix_.size()); }
  /// The agents' model of the first scenario, and its mode.
  agent::AgentModel model() const { return mix_.front().model(); }
  InformationMode mode() const { return mix_.front().mode; }

 private:
  std::vector<Scenario> mix_;
};

}  // namespace stg::env
