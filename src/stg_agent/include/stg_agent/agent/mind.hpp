#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "auv_dynamics/control/control.hpp"
#include "stg_agent/graph/observation.hpp"

/// The part of an agent that does the same at every decision, from what it was told to what the
/// policy sees, and from the policy's action to the command. T = double: one agent. T = Pack: the
/// same agent of kLanes environments, bit for bit.
namespace stg::agent {

/// Lets the neighbours into an agent's knowledge, in the order of their indices.
template <class T>
struct NeighbourView {
  NearestSlots<T> nearest;
  T count = T(0.0), effective = T(0.0), quality = T(0.0), best = T(0.0), error = T(0.0);
  T closest_sq = T(1e300);  ///< to the target [m^2]

  /// @param known where false the other parameters mean nothing
  /// @param p_WN position of the neighbour, p_WT of the target as this agent believes [m]
  /// @param tracking_error as the neighbour reports it [m]
  void Add(const ObservationConfig& c, const Mask<T>& known, const Vec3<T>& p_WN,
           const Vec3<T>& p_WT, const T& link_quality, const T& tracking_error) {
    const T zero(0.0), one(1.0);
    const T q = Select(known, link_quality, zero);
    count += Select(known, one, zero);
    effective += Select(known && (q > T(c.link_available)), one, zero);
    quality += q;
    best = Max(best, q);
    error += Select(known, tracking_error, zero);
    const Vec3<T> r = p_WT - p_WN;
    closest_sq = Min(closest_sq, Select(known, Dot(r, r), T(1e300)));
  }
};

/// The target estimate as an agent's knowledge takes it.
template <class T>
struct TargetView {
  Vec3<T> p_WT, v_WT;   ///< [m], [m/s]
  T variance = T(0.0);  ///< of each position component [m^2]
  T started = T(0.0);   ///< 1: there is an estimate
  T current = T(0.0);   ///< 1: it rests on a recent observation
};

/// What an agent makes of its inputs, per decision: SetNavigation, SetTracking, SetNeighbours, then
/// Act. T is double for one agent, Pack for the same agent of kLanes worlds.
template <class T>
class Mind {
 public:
  explicit Mind(const AgentConfig& s)
      : window_(static_cast<std::size_t>(std::max(1, s.observation.error_window)), T(0.0)) {}

  void Reset() {
    knowledge = Knowledge<T>();
    action.fill(T(0.0));
    std::fill(window_.begin(), window_.end(), T(0.0));
  }

  void SetNavigation(const dynamics::Navigation<T>& nav) {
    Knowledge<T>& k = knowledge;
    k.p_WB = nav.p_WB;
    k.v_WB_B = nav.v_WB_B;
    k.w_WB_B = nav.w_WB_B;
    k.R_WB = RotationOf(nav.q_WB);
    k.trig = TrigOf(k.R_WB);
    k.v_WB = k.R_WB * nav.v_WB_B;
  }

  /// After SetNavigation, at decision `step` of the episode.
  void SetTracking(const AgentConfig& s, const TargetView<T>& target, std::uint32_t step) {
    const T zero(0.0), one(1.0), half(0.5);
    Knowledge<T>& k = knowledge;
    k.r_BT_W = target.p_WT - k.p_WB;
    k.v_WT = target.v_WT;
    const T distance = Norm(k.r_BT_W);
    k.previous_distance = step == 0 ? distance : k.distance;
    k.distance = distance;
    k.closing = ClosingSpeed(k.r_BT_W, distance, k.v_WB, k.v_WT);
    k.error = Abs(distance - T(s.task.desired_distance_m));
    window_[step % window_.size()] = k.error;
    T sum(0.0);
    for (const T& e : window_) sum += e;  // zeros where there is no history yet
    k.mean_error = sum / T(static_cast<double>(std::min<std::size_t>(step + 1, window_.size())));
    const Mask<T> lost = (target.started < half) ||
                         (Sqrt(target.variance) > T(s.track.lost_std_m)) ||
                         (distance > T(s.task.lost_distance_m));
    const T seen = Select(target.current > half, Confidence(distance, s.sensing.range_m), zero);
    k.confidence = Select(lost, zero, seen);
    k.lost = Select(lost, one, zero);
    k.lost_steps = Select(lost, k.lost_steps + one, zero);
  }

  /// After SetTracking. The slots of `view.nearest` are as they are to be shown.
  void SetNeighbours(const AgentConfig& s, const NeighbourView<T>& view) {
    const T zero(0.0), one(1.0);
    const T others(1.0 / std::max(1.0, static_cast<double>(s.agents - 1)));
    Knowledge<T>& k = knowledge;
    std::copy(view.nearest.offset, view.nearest.offset + kNeighbourSlots, k.neighbour);
    k.effective_fraction = view.effective * others;
    k.mean_quality = view.quality * others;
    k.best_quality = view.best;
    k.mean_neighbour_error = Select(view.count > zero, view.error / Max(view.count, one), k.error);
    k.closest = Select(Dot(k.r_BT_W, k.r_BT_W) <= view.closest_sq, one, zero);
  }

  /// Executes an action (Eqs. 23-27): `action` and knowledge.tau become what is executed.
  /// Returns the desired velocity, world axes [m/s]; zero for tau6.
  /// @param wanted [action_size], clipped to [-1, 1]
  Vec3<T> Act(const AgentConfig& s, const T* wanted) {
    Knowledge<T>& k = knowledge;
    const int size = s.action_size();
    if (s.control.interface == dynamics::ActionInterface::kTau6) {
      for (int a = 0; a < size; ++a) {
        k.tau[a] = action[static_cast<std::size_t>(a)] = Clip(wanted[a], T(-1.0), T(1.0));
      }
      return {};
    }
    dynamics::SmoothAction(s.control, size, wanted, action.data());
    const Vec3<T> v_des_W = dynamics::DesiredVelocity(s.vehicle, action.data());
    dynamics::VelocityController(s.control, s.vehicle, v_des_W, k.R_WB, k.v_WB, RpyOf(k.trig),
                                 k.w_WB_B, k.tau);
    return v_des_W;
  }

  Knowledge<T> knowledge;
  std::array<T, 6> action{};  ///< executed by the last Act; action_size entries count

 private:
  std::vector<T> window_;  // ring of the last error_window tracking errors
};

}  // namespace stg::agent
