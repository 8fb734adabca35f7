#pragma once

#include "auv_common/numbers/vector.hpp"
#include "auv_common/time.hpp"

/// Plain data that crosses package and process boundaries. Every field survives
/// a ROS message unchanged (doubles and integer nanoseconds only).
namespace stg::dynamics {

/// Output of a vehicle's own navigation: body B (FLU) in world W (ENU). T = Pack: one vehicle of
/// each of kLanes worlds, which have clocks of their own.
template <class T>
struct Navigation {
  PerLane<T, TimeNs> stamp{};
  Vec3<T> p_WB;                                  ///< position [m]
  T q_WB[4] = {T(1.0), T(0.0), T(0.0), T(0.0)};  ///< orientation, w x y z, unit norm
  Vec3<T> v_WB_B;                                ///< velocity over ground in body axes [m/s]
  Vec3<T> w_WB_B;                                ///< body rates p, q, r [rad/s]
  // Stated deviations of its errors; zero: there are no errors.
  T position_std_m = T(0.0);   ///< of each horizontal component of p_WB
  T heading_std_rad = T(0.0);  ///< of the error of q_WB about the vertical
  // The newest GPS fix, of a navigation that reports fixes and is not corrected by them.
  PerLane<T, TimeNs> fix_stamp{};  ///< time of the fix
  Vec3<T> p_WF;                    ///< position of the body at that time [m]; z has no meaning
  T fix_std_m = T(0.0);            ///< of each horizontal component of p_WF; 0: there was no fix
};
using NavState = Navigation<double>;

/// Kind of measurement of a detection.
enum class MeasurementKind { kPosition, kRange, kBearing, kRangeBearing };

/// How many numbers a detection of this kind measures.
constexpr int NumbersOf(MeasurementKind kind) {
  return kind == MeasurementKind::kRange ? 1 : kind == MeasurementKind::kBearing ? 2 : 3;
}

/// No scenario has more targets.
inline constexpr int kMostTargets = 16;

/// Target of a detection that does not say which target it is.
inline constexpr int kUnlabelled = -1;

/// One detection of a target by one vehicle's own sensor, in the frame of that vehicle's
/// navigation, whose errors it shares.
struct Detection {
  TimeNs stamp = 0;
  int target = 0;      ///< its index, or kUnlabelled
  Vec3<double> p_WT;   ///< measured target position in the world [m]: with range and bearing, their
                       ///< point; with a range or a bearing alone, the observer's position
  double std_m = 0.0;  ///< standard deviation of each component [m], the largest one
  MeasurementKind kind = MeasurementKind::kPosition;
  Vec3<double> p_WO = {};           ///< navigated position of the observer [m]
  double p_WO_std_m = 0.0;          ///< of each horizontal component, stated
  double heading_std_rad = 0.0;     ///< of its heading, stated
  double range_m = 0.0;             ///< from the observer
  double range_std_m = 0.0;         ///< standard deviation of the range
  double azimuth_rad = 0.0;         ///< direction of the target, from east counter-clockwise
  double elevation_rad = 0.0;       ///< above the horizontal
  double bearing_std_rad = 0.0;     ///< standard deviation of azimuth and elevation
  bool ambiguous = false;           ///< the target may also lie at mirror_azimuth_rad
  double mirror_azimuth_rad = 0.0;  ///< the azimuth mirrored at the observer's heading
};

/// Start of a search: a position with a stated uncertainty.
struct Cue {
  int target = 0;
  Vec3<double> p_WT;   ///< stated target position in the world [m]
  double std_m = 0.0;  ///< standard deviation of each component [m]
};

/// Size of a generalised force.
inline constexpr int kWrenchSize = 6;

/// Generalised force tau = [X Y Z K M N] at the body origin, body axes [N, N m].
template <class T>
struct Wrench {
  Vec3<T> force;
  Vec3<T> moment;
};

}  // namespace stg::dynamics
