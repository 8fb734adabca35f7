#include "torpedo_autopilot.hpp"

#include <cmath>

#include "course.hpp"

namespace stg::dynamics {
namespace {

/// Time in which the hull reaches the speed of its shaft speed [s].
constexpr double kWayLag_s = 2.0;
/// Larger errors of speed occur while the speed changes; the integrator ignores them [m/s].
constexpr double kNearSpeed_mps = 0.7;
/// Smallest assumed flow over the fins, as a share of the smallest speed.
constexpr double kSlowest = 0.5;

}  // namespace

TorpedoAutopilot::TorpedoAutopilot(const VehicleConfig& vehicle, const AutopilotConfig& config)
    : c_(config),
      model_(vehicle.torpedo),
      max_rpm_(vehicle.torpedo.max_propeller_rpm),
      max_fin_(vehicle.torpedo.max_fin_rad),
      rpm_per_speed_(model_.SteadyRpmPerSpeed()),
      slowest_(std::max(0.1, kSlowest * config.min_speed_mps)),
      turn_authority_(model_.RudderAuthority()),
      turn_damping_(1.0 / vehicle.torpedo.yaw_time_s),
      pitch_authority_(model_.SternPlaneAuthority()),
      pitch_damping_(model_.PitchDamping()),
      righting_(model_.Righting()) {}

template <class T>
T TorpedoAutopilot::Shaft(const T& wanted, const T& speed, double dt, T* state) const {
  const T error = wanted - speed;
  const T raw = (wanted + state[kSpeed]) * T(rpm_per_speed_);
  const T rpm = Clip(raw, T(std::min(max_rpm_, c_.min_speed_mps * rpm_per_speed_)), T(max_rpm_));
  const T increment =
      Select(Abs(error) < T(kNearSpeed_mps), error * T(c_.speed_integral_ps * dt), T(0.0));
  Integrate(increment, raw, rpm, &state[kSpeed]);
  return rpm;
}

template <class T>
T TorpedoAutopilot::Rudder(const T& wanted, const T& rate, const T& flow, double dt,
                           T* state) const {
  const T error = wanted - rate;
  const T acceleration = wanted * T(turn_damping_) + error * T(c_.turn_gain_ps) + state[kTurn];
  // Positive rudder turns clockwise.
  const T raw = -acceleration / (T(turn_authority_) * flow * flow);
  const T rudder = Clip(raw, T(-max_fin_), T(max_fin_));
  Integrate(error * T(c_.turn_integral_ps2 * dt), -raw, -rudder, &state[kTurn]);
  return rudder;
}

template <class T>
T TorpedoAutopilot::SternPlane(const T& wanted, const T& climb, const T& sine, const T& rate,
                               const T& flow, double dt, T* state) const {
  // Desired pitch for the climb rate, bow up.
  const T most(c_.max_pitch_rad);
  const T raw_pitch = wanted / flow + state[kClimb];
  const T pitch = Clip(raw_pitch, -most, most);
  const T slope = (wanted - climb) / flow;
  // Stern plane for this pitch. At these pitches the sine equals the angle to second order.
  const T error = pitch - sine;
  const double w = c_.pitch_frequency_radps;
  const T acceleration =
      error * T(w * w) - rate * T(2.0 * w - pitch_damping_) + sine * T(righting_) + state[kPitch];
  // Positive stern plane lowers the bow.
  const T raw = -acceleration / (T(pitch_authority_) * flow * flow);
  const T stern_plane = Clip(raw, T(-max_fin_), T(max_fin_));
  Integrate(error * T(c_.pitch_integral_ps3 * dt), -raw, -stern_plane, &state[kPitch]);
  // The integrator of the climb rate waits while pitch or stern plane is at its limit.
  Integrate(Select(Abs(raw) > T(max_fin_), T(0.0), slope * T(c_.climb_integral_ps * dt)), raw_pitch,
            pitch, &state[kClimb]);
  return stern_plane;
}

template <class T>
void TorpedoAutopilot::Follow(const Vec3<T>& v_des_W, const Navigation<T>& nav, double dt, T* state,
                              T* command) const {
  const Mat3<T> R_WB = RotationOf(nav.q_WB);
  const Vec3<T> v_WB = R_WB * nav.v_WB_B;
  const Wish<T> wish = WishOf(c_, v_des_W, R_WB, v_WB);
  const T speed = Sqrt(v_WB.x * v_WB.x + v_WB.y * v_WB.y);
  const T flow = Max(state[kFlow], T(slowest_));
  command[0] = Shaft(wish.speed, speed, dt, state);
  command[1] = Rudder(wish.turn_rate, nav.w_WB_B.z, flow, dt, state);
  // In FLU axes, the last row of R_WB is the world's vertical, and positive q lowers the bow.
  command[2] = SternPlane(wish.climb, v_WB.z, R_WB.m[2][0], -nav.w_WB_B.y, flow, dt, state);
  state[kFlow] +=
      (command[0] * T(1.0 / rpm_per_speed_) - state[kFlow]) * T(1.0 - std::exp(-dt / kWayLag_s));
}

}  // namespace stg::dynamics
