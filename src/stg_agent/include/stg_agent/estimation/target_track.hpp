#pragma once

#include "auv_dynamics/measurements.hpp"
#include "stg_agent/agent_config.hpp"

namespace stg::agent {

/// Estimate of a target's position and velocity, world axes.
///
/// Sensor and process noise are isotropic, so the 6x6 covariance is the Kronecker
/// product of the 2x2 matrix [pp pv; pv vv] and the identity: one small matrix serves
/// all three axes.
struct TargetEstimate {
  TimeNs stamp = 0;
  Vec3<double> p_WT;  ///< [m]
  Vec3<double> v_WT;  ///< [m/s]
  double pp = 0.0;    ///< position variance of each axis [m^2]
  double pv = 0.0;    ///< covariance of position and velocity [m^2/s]
  double vv = 0.0;    ///< velocity variance of each axis [m^2/s^2]

  double position_std_m() const { return Sqrt(pp); }
};

/// A target estimate that another AUV shared.
struct SharedEstimate {
  TimeNs stamp = 0;  ///< time at which it was true
  Vec3<double> p_WT;
  Vec3<double> v_WT;
  double std_m = 0.0;  ///< of each position component
};

/// Constant-velocity Kalman filter of one target.
///
/// Process: continuous white acceleration of intensity S = process_accel_std^2 *
/// decision period, i.e. the acceleration averaged over one decision has the stated
/// standard deviation. Predicting in one stride or in several gives the same
/// covariance. A predicted target that reaches a wall is stopped there and the
/// velocity component flips, as the paper's target does.
///
/// Own detections enter by the Kalman update with standard deviation max(stated,
/// measurement_std_m). The correlation of a shared estimate with the track is unknown, because its
/// source may have used this AUV's packets. So shared estimates enter by covariance intersection,
/// with the weight that minimises the determinant of the fused covariance; for 2x2 matrices that
/// weight has a closed form. Packets contain no velocity deviation; initial_speed_std_mps stands
/// for it.
///
/// Gate: a detection farther than gate_sigma from its prediction is rejected. After kRestartAfter
/// rejections in a row, the last two detections restart the track (only the last one if no target
/// is fast enough for both). A shared estimate outside the gate replaces the track if it is newer
/// than the track's information and more certain than the track; otherwise it is ignored.
class TargetTrack {
 public:
  static constexpr int kRestartAfter = 3;

  explicit TargetTrack(const AgentModel& model);

  void Clear();
  /// Starts the track from a datum: velocity zero with initial_speed_std_mps.
  void Start(const Vec3<double>& p_WT, double std_m, TimeNs stamp);
  bool started() const { return started_; }
  /// The track contains an observation, own or a neighbour's, not only its start.
  bool observed() const { return observed_; }

  /// Predicts the estimate to time t; an earlier time has no effect.
  void Predict(TimeNs t);

  /// Takes an own detection. For a newer one, the track is predicted to its stamp. An older one is
  /// moved forward by the track's velocity, whose variance is added to its noise. Starts a track
  /// that is not started.
  void Detect(const dynamics::Detection& detection);

  /// Takes a shared estimate of any age; the track keeps its time.
  void Fuse(const SharedEstimate& shared);

  /// The present estimate, at the time of the last Predict or newer detection.
  const TargetEstimate& estimate() const { return now_; }

  /// Time of the newest observation in the track, own or a neighbour's; before the first one, of
  /// the start.
  TimeNs information_stamp() const { return shared_.stamp; }
  /// The estimate for packets, at the time information_stamp(): it is never newer than its
  /// observations, so that two AUVs cannot keep an old estimate new by exchanging it.
  const SharedEstimate& shareable() const { return shared_; }
  /// Detections in a row that the gate rejected.
  int rejected_in_a_row() const { return rejected_; }

 private:
  void Grow(double dt_s, TargetEstimate* e) const;
  void Remember(TimeNs information, bool observation);
  void Restart(const dynamics::Detection& newest, double std_m);

  double intensity_;  // S [m^2/s^3]
  double floor_std_m_;
  double speed_std_mps_;
  double max_speed_mps_;
  double gate2_;
  double wall_m_;
  bool started_ = false, observed_ = false;
  TargetEstimate now_;
  SharedEstimate shared_;
  dynamics::Detection previous_rejected_;
  int rejected_ = 0;
};

}  // namespace stg::agent
