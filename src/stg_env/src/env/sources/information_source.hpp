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

/// Where the AUVs of kLanes environments have their knowledge from. The information modes of a
/// scenario differ in this and in nothing else.
///
/// Use, in each lane: Start and Observe when an episode begins; then Act for every AUV and Send,
/// the world moves, Observe.
class InformationSource {
 public:
  virtual ~InformationSource() = default;

  /// An episode begins in these lanes of the world: all knowledge of the one before is gone.
  virtual void Start(const dynamics::World& world, const LaneSet& lanes) = 0;
  /// Brings the knowledge of these lanes to the present of the world; the others keep theirs.
  virtual void Observe(const dynamics::World& world, const LaneSet& lanes) = 0;
  /// AUV i executes an action (Eqs. 23-27).
  /// @param wanted [action_size], finite; clipped to [-1, 1] inside
  /// @param action, tau executed action, and tau / tau_max
  virtual void Act(const dynamics::World& world, int i, const Pack* wanted,
                   task::Effort<Pack>* action, task::Effort<Pack>* tau) = 0;
  /// After all have acted: what they have to say goes out.
  virtual void Send(const dynamics::World& world) = 0;

  /// What AUV i decides on.
  virtual const agent::Knowledge<Pack>& knowledge(int i) const = 0;
  /// Mean link quality of the swarm now (Eq. 33).
  virtual Pack LinkQuality(const dynamics::World& world) const = 0;
  /// What AUV i believes of its target, and what its modem did: those members of `state`, in every
  /// lane.
  virtual void Tell(const dynamics::World& world, int i, task::FieldState<Pack>* state) const = 0;
  /// Which target AUV i follows, and where it believes every target to be, in every lane; where
  /// targets are chosen freely.
  virtual void Choose(int i, task::Following<Pack>* following) const {
    (void)i;
    (void)following;
  }
};

}  // namespace stg::env
