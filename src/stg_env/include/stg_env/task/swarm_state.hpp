#pragma once

#include <array>
#include <vector>

#include "auv_dynamics/world/separations.hpp"
#include "auv_dynamics/world/world.hpp"
#include "stg_agent/graph/tracking.hpp"

namespace stg::task {

/// Numbers of one AUV: tau / tau_max; or for other actuators, the last command as shares of their
/// limits; or an executed action (its first action_size numbers).
template <class T>
using Effort = std::array<T, dynamics::kWrenchSize>;
template <class T>
using Efforts = std::vector<Effort<T>>;
static_assert(dynamics::kMaxActionSize <= dynamics::kWrenchSize, "an action is an Effort");

/// Further state of one AUV in open water: its estimate of its target, its surroundings, and counts
/// of its modem.
template <class T>
struct FieldState {
  T present = T(1.0);  ///< 0: it has left the swarm (fleet.leave) and is not judged
  T known = T(0.0);    ///< 1: it estimates its target; 0: the next four have no meaning
  Vec3<T> p_WT;        ///< its estimate of the target's position, world axes [m]
  /// Its estimate of the vector from itself to the target, world axes [m]: the offset by which it
  /// steers. Errors of its own navigation are in p_WT, but not in this.
  Vec3<T> r_BT_W;
  /// Covariance of p_WT, xx xy xz yy yz zz [m^2], including the uncertainty of its navigation; all
  /// zero if it knows the truth.
  T covariance[6] = {T(0.0), T(0.0), T(0.0), T(0.0), T(0.0), T(0.0)};
  T age_s = T(0.0);  ///< age of the newest observation in the estimate
  // For an AUV with a localizer: the remaining errors of its position and its neighbours'
  // positions.
  T located = T(0.0);        ///< 0: the next three have no meaning
  Vec3<T> navigation_error;  ///< of its position in the world, horizontal [m]
  T navigation_covariance[3] = {T(0.0), T(0.0), T(0.0)};  ///< of it, xx xy yy [m^2]
  T relative_square = T(0.0);  ///< mean squared error of the others relative to the own one [m^2]
  T surfacing = T(0.0);  ///< 1: it is on the way up for a fix, at the surface or on the way back
  T fixes = T(-1.0);  ///< number of its fixes in this episode; below 0: it never surfaces for one
  T altitude_m = T(1e9);      ///< above the bottom
  T clearance_m = T(1e9);     ///< to the nearest obstacle
  T groundings = T(0.0);      ///< in this episode up to now, as the following
  T collisions = T(0.0);      ///< with obstacles
  T received = T(0.0);        ///< packets that an AUV received, mean over the AUVs
  T missed = T(0.0);          ///< packets to an AUV that were lost, mean over the AUVs
  T modem_energy_j = T(0.0);  ///< electric, of its modem
  T airtime_s = T(0.0);       ///< for which its modem has sent
  T pings = T(-1.0);          ///< sent pings for ranging, mean over the AUVs; below 0:
                              ///< they are not counted
  T ping_answers = T(0.0);    ///< answered ones of them
};

/// With task.assignment free: the target that each AUV follows, and its estimates of all targets.
/// If detections are labelled, an AUV's estimate k is of target k. Otherwise Match finds out which
/// true target each estimate counts for, so that the order of estimates has no effect on the
/// scores.
template <class T>
struct Following {
  Following(int agents, int targets)
      : target(static_cast<std::size_t>(agents), T(0.0)),
        state(target.size()),
        known(target.size() * static_cast<std::size_t>(targets), T(0.0)),
        p_WT(known.size()) {}

  /// Pairs the estimates of AUV i with the true targets at the least sum of distances in the plane,
  /// each up to a cutoff. `target`, which is the estimate that the AUV follows, becomes the true
  /// target of this estimate.
  void Match(std::size_t i, const std::vector<dynamics::TargetState<T>>& targets);

  std::vector<T> target;                        ///< [agents], index of the target it follows
  std::vector<dynamics::TargetState<T>> state;  ///< [agents], true state of that target
  std::vector<T> known;       ///< [agents, targets], 1: the AUV estimates the target
  std::vector<Vec3<T>> p_WT;  ///< [agents, targets], estimated position [m]
};

extern template struct Following<double>;
extern template struct Following<Pack>;

/// The true state of a swarm when a decision is due, and the commands of the previous decision: the
/// whole input of a task. It is a view, and does not depend on what moved the swarm. T = double:
/// one swarm. T = Pack: kLanes swarms.
template <class T>
struct SwarmState {
  const std::vector<dynamics::VehicleState<T>>& vehicles;  ///< [agents]
  const std::vector<dynamics::TargetState<T>>& targets;    ///< [targets]
  const dynamics::Separations<T>& separations;
  const Efforts<T>& tau;     ///< [agents], tau / tau_max; zero when an episode starts
  const Efforts<T>& action;  ///< [agents], executed action in [-1, 1]; zero when an episode starts
  /// Mean link quality of the swarm now, in [0, 1]: the communication term rewards it (Eq. 33).
  T link_quality = T(0.0);
  /// [agents], for scenarios in open water; otherwise null.
  const std::vector<FieldState<T>>* field = nullptr;
  /// Null: AUV i follows target i modulo their number.
  const Following<T>* following = nullptr;

  /// The target that AUV i follows.
  const dynamics::TargetState<T>& target_of(std::size_t i) const {
    return following != nullptr ? following->state[i] : targets[i % targets.size()];
  }
  /// 1: AUV i follows target t and has not left; else 0.
  T follows(std::size_t i, std::size_t t) const {
    const T there = field != nullptr ? (*field)[i].present : T(1.0);
    if (following == nullptr) return i % targets.size() == t ? there : T(0.0);
    return Select(following->target[i] == T(static_cast<double>(t)), there, T(0.0));
  }
};

/// True tracking of one AUV. `lost`: farther from the target than task.lost_distance_m, or
/// OffInOwnFrame (estimate_totals.hpp).
using agent::Tracking;

}  // namespace stg::task
