#pragma once

#include <algorithm>
#include <memory>

#include "auv_common/numbers/attitude.hpp"
#include "auv_common/numbers/vector.hpp"
#include "stg_agent/controllers/controller.hpp"

/// Controller of open water: vehicles that must keep moving circle the target.
namespace stg::agent {

/// Constants of the law. Lengths and speeds are those of the sea.
struct EncircleOptions {
  double cruise_mps = 1.04;      ///< over ground, where the AUV circles against the target's course
  double slow_mps = 0.9;         ///< smallest speed over ground
  double slow_in_current = 0.0;  ///< added to it: this share of the largest current
  double fast_mps = 2.3;         ///< largest speed over ground, also on the way to the circle
  double inward_gain = 8.0;      ///< how steeply the way to the circle points inward
  double lead_s = 2.8;           ///< the law uses the vehicle's position after this time
  double spread_gain = 2.0;      ///< relative change of speed per radian off the middle of the gap
  double spread_limit = 0.5;     ///< largest relative change of speed
  double clearance_m = 56.0;     ///< horizontal distance at which it passes other AUVs
  double doubt_mps = 0.5;        ///< added to it per second of age of their packet
  double mate_clearance_m = 40.0;  ///< the same for AUVs on the same circle
  double horizon_s = 66.0;         ///< closest approaches later than this are ignored
  double layer_m = 20.0;           ///< AUVs farther above or below than this are ignored
  double depth_gain_ps = 0.06;     ///< climb rate per error of depth
  double climb_mps = 0.25;         ///< largest commanded climb rate
  double ring = 0.2;               ///< two circles, smaller and larger than d* by this share
  double ring_team = 10.0;         ///< teams of more AUVs than this fly two circles
  double ring_dodge = 0.5;         ///< value of `dodge` in such teams
  double smallest_circle = 0.5;    ///< smallest radius far below or above the target, share of d*
  double dodge = 1.5;           ///< largest sideways speed to avoid an AUV, share of the own speed
  double on_circle = 0.5;       ///< an AUV closer to the circle than this share of d* is on it
  double mate_on_circle = 0.6;  ///< the same for other AUVs, if there is only one circle
  double keep_off_m = 20.0;     ///< horizontal distance to obstacles
  double keep_off_doubt = 1.0;  ///< standard deviations of the own position, added to keep_off_m
  double hurry_from = 0.0;  ///< the AUV speeds up if it is farther outside than this share of d*
};

void Describe(EncircleOptions* o, config::Table* t);

/// Changes of the law by a policy; the default values change nothing.
template <class T>
struct Guidance {
  T radius_m = T(0.0);   ///< added to the radius of the circle in the plane [m]
  T speed_mps = T(0.0);  ///< added to the speed relative to the target [m/s]
  T phase_rad = T(0.0);  ///< ahead of the middle of the gap [rad]
  T sense = T(1.0);      ///< 1: anticlockwise; -1: clockwise
  T depth_m = T(0.0);    ///< deeper than the own layer [m]; not in a closed basin
};

/// A vector in the plane.
template <class T>
struct Level {
  T x = T(0.0), y = T(0.0);

  friend Level operator+(const Level& a, const Level& b) { return {a.x + b.x, a.y + b.y}; }
  friend Level operator-(const Level& a, const Level& b) { return {a.x - b.x, a.y - b.y}; }
  friend Level operator*(const Level& a, const T& s) { return {a.x * s, a.y * s}; }
};
template <class T>
T Dot(const Level<T>& a, const Level<T>& b) {
  return a.x * b.x + a.y * b.y;
}
/// Positive where b lies anticlockwise of a.
template <class T>
T Cross(const Level<T>& a, const Level<T>& b) {
  return a.x * b.y - a.y * b.x;
}
template <class T>
T Norm(const Level<T>& a) {
  return Sqrt(Dot(a, a));
}

/// A velocity in the same direction with the speed limited to [lo, hi] [m/s].
template <class T>
Level<T> Limited(const Level<T>& v, double lo, double hi) {
  const T speed = Max(Norm(v), T(1e-6));
  return v * (Clip(speed, T(lo), T(hi)) / speed);
}

/// The estimated velocity of the target, not faster than it can be [m/s].
template <class T>
Level<T> TargetVelocity(const ControllerInput<T>& in) {
  const Level<T> v{in.knowledge.v_WT.x, in.knowledge.v_WT.y};
  return v * (Min(Norm(v), T(in.model.target.max_speed_mps)) / Max(Norm(v), T(1e-6)));
}

/// Present state of another AUV, predicted from its packet: along the own circle if the packet
/// shows it there, otherwise straight on. Relative to the target, in the plane.
template <class T>
struct Circler {
  T on_circle;  ///< 1 or 0
  Level<T> q;   ///< position [m]
  Level<T> w;   ///< velocity over ground [m/s]
  T z;          ///< height in the world [m]
};

/// @param p_WT, v_T of the target now, as this AUV estimates
/// @param radius, reach of the own circle, and within which distance of it others are on it [m]
template <class T>
Circler<T> CircleOn(const NeighbourSight<T>& n, const Vec3<T>& p_WT, const Level<T>& v_T,
                    const T& radius, const T& reach) {
  const Level<T> q{n.p_W.x - p_WT.x + v_T.x * n.age_s, n.p_W.y - p_WT.y + v_T.y * n.age_s};
  const Level<T> v{n.v_W.x, n.v_W.y};
  const T square = Max(Dot(q, q), T(1.0));
  const auto near = Abs(Sqrt(square) - radius) < reach;
  const T angle = Select(near, Cross(q, v - v_T) / square * n.age_s, T(0.0));
  T s, c;
  SinCos(angle, &s, &c);
  const Level<T> straight{n.p_WN.x - p_WT.x, n.p_WN.y - p_WT.y};
  const Level<T> relative = v - v_T;
  const Level<T> turned{c * relative.x - s * relative.y, s * relative.x + c * relative.y};
  return {
      Select(near, T(1.0), T(0.0)),
      {Select(near, c * q.x - s * q.y, straight.x), Select(near, s * q.x + c * q.y, straight.y)},
      {turned.x + v_T.x, turned.y + v_T.y},
      n.p_WN.z};
}

/// The largest u for which |v_T + u direction| is `speed`; `otherwise` if there is none.
template <class T>
T SpeedAlong(const Level<T>& v_T, const Level<T>& direction, const T& speed, const T& otherwise) {
  const T b = Dot(v_T, direction);
  const T square = b * b + speed * speed - Dot(v_T, v_T);
  return Select(square > T(0.0), Sqrt(Max(square, T(0.0))) - b, otherwise);
}

/// A velocity that does not lead into a disc. A vehicle with the turning radius R_t whose course
/// leads into the disc at the angle a to the tangent comes nearer by 2 R_t (1 - cos a) while it
/// turns away at half of its largest turn rate; the other half is for the curvature of the edge. So
/// at the distance g from the edge the
/// steepest allowed way in is cos a = 1 - g / (2 R_t). Inside the disc, the way leads out. A
/// vehicle that wants to pass on the other side first turns away from the disc, because the shorter
/// turn leads into it.
/// @param v desired velocity, own present velocity of the vehicle [m/s]
/// @param there centre of the disc from the vehicle, `radius` of the disc, `turn_m` R_t [m]
template <class T>
Level<T> TurnedOff(const Level<T>& v, const Level<T>& own, const Level<T>& there, const T& radius,
                   const T& turn_m) {
  const T zero(0.0), one(1.0);
  const T range = Max(Norm(there), T(1e-3)), speed = Norm(v);
  const Level<T> at = there * (one / range);
  const T room = Clip((range - radius) / (T(2.0) * turn_m), -one, one);
  const T rest = one - Max(room, zero);
  const T steepest = Select(room < zero, room, Sqrt(Max(one - rest * rest, zero)));
  const T side = Select(Cross(at, own) < zero, -one, one);
  const Level<T> past{-at.y * side, at.x * side};
  const Level<T> turned =
      (at * steepest + past * Sqrt(Max(one - steepest * steepest, zero))) * speed;
  const auto leads_in = Dot(v, at) > steepest * speed;
  const auto outward = Dot(own, at) < T(-0.7) * Norm(own);
  const auto crosses = (Dot(v, past) < zero) && (room < one) && !outward;
  return {Select(crosses, -at.x * speed, Select(leads_in, turned.x, v.x)),
          Select(crosses, -at.y * speed, Select(leads_in, turned.y, v.y))};
}

/// Each AUV circles its estimate of the target anticlockwise at d* in the plane, at a depth of its
/// own. On the circle it moves towards the middle between the AUVs ahead and behind, whose
/// positions it predicts from their packets. Off the circle it approaches on a spiral. It avoids
/// AUVs that would pass too closely at a similar depth, and the obstacles of the scenario. In a
/// team that is too large for one circle, every other AUV flies inside and the others outside of
/// d*. In a closed basin it keeps the target's depth.
///
/// The radius of a turn over ground is the ground speed divided by the turn rate. Where a circle of
/// radius R runs against the target's course, this radius is R (1 - v_T / u)^2. The relative speed
/// u is v_T + cruise, and never less than v_T + slow.
struct Encircle {
  EncircleOptions options;

  template <class T>
  void Act(const ControllerInput<T>& in, T* action) const {
    Act(in, Guidance<T>(), action);
  }
  /// The same law, changed by a guidance.
  template <class T>
  void Act(const ControllerInput<T>& in, const Guidance<T>& guidance, T* action) const {
    const dynamics::VehicleConfig& vehicle = in.model.vehicle;
    const Vec3<T> v = Velocity(in, guidance);
    const auto& vmax = vehicle.max_velocity_mps;
    const T velocity[3] = {Clip(v.x * T(1.0 / vmax[0]), T(-1.0), T(1.0)),
                           Clip(v.y * T(1.0 / vmax[1]), T(-1.0), T(1.0)),
                           Clip(v.z * T(1.0 / vmax[2]), T(-1.0), T(1.0))};
    AskForVelocity(in, velocity, action);
  }

  // Parts that other laws with a ring use, too.
  /// Commanded height [m].
  template <class T>
  T Height(const ControllerInput<T>& in, const T& deeper_m) const;
  /// Radius of the circle in the plane [m] at the height difference dz to the target [m].
  template <class T>
  T Radius(const ControllerInput<T>& in, const T& dz) const;
  /// The same, changed by Guidance::radius_m. Two circles are near the edges of the band already,
  /// so the first 60 m of a change towards the nearer edge have no effect there.
  template <class T>
  T Guided(const ControllerInput<T>& in, const T& circle, const T& wider) const;
  /// Turns a velocity away from another vehicle or an obstacle that it would pass too closely.
  /// @param r, w position and velocity of the other relative to the own position and the ground
  /// @param dodge largest sideways speed as a share of the own speed
  /// @param matters 1; 0: ignore the other
  template <class T>
  Level<T> Miss(const Level<T>& v, const Level<T>& r, const Level<T>& w, const T& clearance,
                double dodge, const T& matters) const;
  /// The sideways speed of Miss. It is smaller in large teams: there an AUV that swerves meets the
  /// next one, and all of them leave the band.
  double Dodge(const AgentModel& model) const;
  /// A velocity in the plane that does not lead into an obstacle of the chart. This step is the
  /// last, because other AUVs avoid a collision, too, and obstacles do not.
  template <class T>
  Level<T> ClearOfChart(const ControllerInput<T>& in, Level<T> v) const;

 private:
  bool TwoCircles(const AgentModel& model) const;
  /// Desired velocity over ground, world axes [m/s].
  template <class T>
  Vec3<T> Velocity(const ControllerInput<T>& in, const Guidance<T>& guidance) const;
};

std::unique_ptr<Controller> MakeEncircle(const EncircleOptions& options);

}  // namespace stg::agent
