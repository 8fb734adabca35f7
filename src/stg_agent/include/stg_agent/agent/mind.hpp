#pragma once

#include <algorithm>
#include <array>

#include "auv_common/numbers/lane_structs.hpp"
#include "auv_dynamics/control/control.hpp"
#include "auv_dynamics/helm/helm.hpp"
#include "auv_dynamics/vehicle/vehicle_state.hpp"
#include "stg_agent/agent/error_window.hpp"
#include "stg_agent/graph/features.hpp"
#include "stg_agent/graph/neighbour_view.hpp"
#include "stg_agent/graph/target_view.hpp"

namespace stg::agent {

/// Source of an AUV's knowledge: its agent, or the truth mode. The truth mode rounds one mean
/// differently (ErrorMean) and may follow the release (observation.release_bookkeeping).
enum class Bookkeeping { kAgent, kTruth };

/// Computes the policy's input by SetNavigation, SetTracking and SetNeighbours, in this order, and
/// the force of the policy's action by Act. T = double is one AUV. T = Pack is the same AUV in
/// kLanes environments, bit for bit, and each lane has its own clock.
template <class T>
class Mind {
 public:
  explicit Mind(const AgentModel& s, Bookkeeping books = Bookkeeping::kAgent)
      : steered_(dynamics::Helm::Steers(s.vehicle)),
        release_(books == Bookkeeping::kTruth && s.observation.release_bookkeeping),
        errors_(std::max(1, s.observation.error_window), release_ ? ErrorMean::kRelease
                                                         : books == Bookkeeping::kTruth
                                                             ? ErrorMean::kTruth
                                                             : ErrorMean::kAgent) {
    for (int lane = 0; lane < kLanesOf<T>; ++lane) Reset(lane);
  }

  /// Starts an episode in one lane.
  void Reset(int lane) {
    SetLaneOf(&knowledge, lane, Knowledge<double>());
    for (T& a : action) SetLane(&a, lane, 0.0);
    errors_.Reset(lane);
    SetLane(&decisions_, lane, 0.0);
  }

  void SetNavigation(const dynamics::Navigation<T>& nav) {
    Knowledge<T>& k = knowledge;
    k.p_WB = nav.p_WB;
    k.v_WB_B = nav.v_WB_B;
    k.w_WB_B = nav.w_WB_B;
    k.R_WB = RotationOf(nav.q_WB);
    k.trig = TrigOf(k.R_WB);
    k.v_WB = k.R_WB * nav.v_WB_B;
    k.position_std_m = nav.position_std_m;
  }

  /// The same from the true state.
  void SetNavigation(const dynamics::VehicleState<T>& state) { knowledge.SetNavigation(state); }

  /// Starts a decision; after SetNavigation.
  void SetTracking(const AgentModel& s, const TargetView<T>& target) {
    const T zero(0.0), one(1.0), half(0.5);
    Knowledge<T>& k = knowledge;
    const T before = k.distance;
    k.v_WT = target.v_WT;
    k.Measure(target.p_WT - k.p_WB, k.v_WB - k.v_WT, s.task.desired_distance_m);
    const T distance = k.distance;
    k.previous_distance = Select((decisions_ == zero) || (target.changed > half), distance, before);
    k.mean_error = errors_.Add(k.error);
    const Mask<T> lost = (target.started < half) ||
                         (Sqrt(target.variance) > T(s.track.lost_std_m)) ||
                         (distance > T(s.task.lost_distance_m));
    const T seen = Select(target.current > half, Confidence(distance, s.sensing.range_m), zero);
    k.confidence = Select(lost, zero, seen);
    k.lost = Select(lost, one, zero);
    T lost_steps = k.lost_steps + one;
    // The release counts a lost decision in the reward, and once more in the observation.
    if (release_) lost_steps = Select(decisions_ == zero, lost_steps, Max(lost_steps, T(2.0)));
    k.lost_steps = Select(lost, lost_steps, zero);
    decisions_ += one;
  }

  /// After SetTracking.
  void SetNeighbours(const AgentModel& s, const NeighbourView<T>& n) {
    const T others(1.0 / std::max(1.0, static_cast<double>(s.run.agents - 1)));
    Knowledge<T>& k = knowledge;
    static_assert(kNeighbourSlots == 3,
                  "std::copy of packs is a call, which costs more than they do");
    k.neighbour[0] = n.offset[0];
    k.neighbour[1] = n.offset[1];
    k.neighbour[2] = n.offset[2];
    k.effective_fraction = n.effective * others;
    k.mean_quality = n.quality * others;
    k.best_quality = n.best;
    k.mean_neighbour_error = n.mean_error;
    k.closest = n.closest;
  }

  /// Executes an action (Eqs. 23-27): `action` and knowledge.tau are then the executed ones. tau
  /// stays zero for a vehicle with an autopilot, because the agent commands no force. Returns the
  /// desired velocity, world axes [m/s]; zero for tau6.
  /// @param wanted [action_size], clipped to [-1, 1]
  Vec3<T> Act(const AgentModel& s, const T* wanted) {
    return Act(s, wanted, [this] { return RpyOf(knowledge.trig); });
  }
  /// The same by given angles. @param rpy called for velocity3 only: roll, pitch, yaw [rad]
  template <class Rpy>
  Vec3<T> Act(const AgentModel& s, const T* wanted, const Rpy& rpy) {
    Knowledge<T>& k = knowledge;
    if (steered_) {
      dynamics::SmoothAction(s.control, s.control.action_size(), wanted, action.data());
      return dynamics::DesiredVelocity(s.vehicle, action.data());
    }
    return dynamics::ExecuteAction(s.control, s.vehicle, wanted, k.R_WB, k.v_WB, rpy, k.w_WB_B,
                                   action.data(), k.tau);
  }

  /// Restores the lanes outside the mask from `before`.
  void KeepOthers(const Mask<T>& lanes, const Mind& before) {
    stg::KeepOthers(lanes, before.knowledge, &knowledge);
    for (std::size_t a = 0; a < action.size(); ++a) {
      action[a] = Select(lanes, action[a], before.action[a]);
    }
    errors_.KeepOthers(lanes, before.errors_);
    decisions_ = Select(lanes, decisions_, before.decisions_);
  }

  /// Decisions begun since the start of the episode.
  const T& decisions() const { return decisions_; }

  Knowledge<T> knowledge{};
  /// Executed action of the last Act; only the first action_size entries are used.
  std::array<T, dynamics::kMaxActionSize> action{};

 private:
  bool steered_;  // by an autopilot
  bool release_;
  ErrorWindow<T> errors_;
  T decisions_ = T(0.0);
};

}  // namespace stg::agent
