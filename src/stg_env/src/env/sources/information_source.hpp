#pragma once

#include <array>

#include "auv_dynamics/world/world.hpp"
#include "stg_agent/graph/observation.hpp"
#include "stg_env/task/swarm_state.hpp"

namespace stg::env {

/// Some of kLanes environments.
struct LaneSet {
  std::array<bool, kLanes> in{};

  static LaneSet All() {
    LaneSet all;
    all.in.fill(true);
    return all;
  }
  bool operator[](int lane) const { return in[static_cast<std::size_t>(lane)]; }
  bool any() const {
    for (const bool b : in) {
      if (b) return true;
    }
    return false;
  }
  bool all() const {
    for (const bool b : in) {
      if (!b) return false;
    }
    return true;
  }
  Mask<Pack> mask() const {
    Pack flags(0.0);
    for (int lane = 0; lane < kLanes; ++lane)
      SetLane(&flags, lane, in[static_cast<std::size_t>(lane)] ? 1.0 : 0.0);
    return flags > Pack(0.5);
  }
};

/// Provides the knowledge of the AUVs of kLanes environments. It is the only difference between the
/// information modes of a scenario.
///
/// Use in each lane: Start and Observe when an episode begins. Then, for each decision: Act for
/// every AUV, Send, a move of the world, Observe.
class InformationSource {
 public:
  virtual ~InformationSource() = default;

  /// Starts an episode in these lanes of the world, without knowledge from the previous one.
  virtual void Start(const dynamics::World& world, const LaneSet& lanes) = 0;
  /// Updates the knowledge of these lanes to the present state of the world; other lanes keep
  /// theirs.
  virtual void Observe(const dynamics::World& world, const LaneSet& lanes) = 0;
  /// AUV i executes an action (Eqs. 23-27).
  /// @param wanted [action_size], finite; clipped to [-1, 1] inside
  /// @param action, tau executed action, and tau / tau_max
  virtual void Act(const dynamics::World& world, int i, const Pack* wanted,
                   task::Effort<Pack>* action, task::Effort<Pack>* tau) = 0;
  /// Sends the AUVs' packets, after all AUVs have acted.
  virtual void Send(const dynamics::World& world) = 0;

  /// The knowledge from which AUV i decides.
  virtual const agent::Knowledge<Pack>& knowledge(int i) const = 0;
  /// Mean link quality of the swarm now (Eq. 33).
  virtual Pack LinkQuality(const dynamics::World& world) const = 0;
  /// Writes AUV i's estimate of its target and its modem's counts into `state`, in every lane.
  virtual void Tell(const dynamics::World& world, int i, task::FieldState<Pack>* state) const = 0;
  /// Writes the target that AUV i follows, and its estimates of all targets, in every lane; only
  /// with task.assignment free.
  virtual void Choose(int i, task::Following<Pack>* following) const {
    (void)i;
    (void)following;
  }
};

}  // namespace stg::env
