#include "kinematic.hpp"

#include <cmath>

#include "auv_common/error.hpp"

namespace stg::dynamics {

Kinematic::Kinematic(const VehicleConfig& config)
    : lags_(config.kinematic),
      actuators_{{"speed", "m/s", config.kinematic.min_speed_mps, config.max_velocity_mps[0]},
                 {"turn_rate", "rad/s", -config.max_rate_radps[2], config.max_rate_radps[2]},
                 {"climb_rate", "m/s", -config.max_velocity_mps[2], config.max_velocity_mps[2]}},
      actions_(VelocityActions(config)) {
  if (lags_.min_speed_mps > config.max_velocity_mps[0]) {
    throw UserError("vehicle.kinematic.min_speed_mps: larger than vehicle.max_velocity_mps");
  }
}

void Kinematic::Step(const Pack* command, const Surroundings& around, double dt,
                     VehicleState<Pack>* s, Pack* internal) const {
  const auto share = [dt](double lag_s) { return Pack(1.0 - std::exp(-dt / lag_s)); };
  const Pack zero(0.0), half(0.5 * dt);
  Pack &speed = internal[0], &climb = internal[1], &rate = s->w_WB_B.z;
  speed += (Within(0, command[0]) - speed) * share(lags_.speed_lag_s);
  const Pack before = rate;
  rate += (Within(1, command[1]) - rate) * share(lags_.turn_lag_s);
  climb += (Within(2, command[2]) - climb) * share(lags_.climb_lag_s);

  // The chord of the arc of this step points along the heading at its middle.
  const Pack middle = s->rpy.z + (before + rate) * Pack(0.25 * dt);
  s->rpy = {zero, zero, WrapAngle(s->rpy.z + (before + rate) * half)};
  Pack sine, cosine;
  SinCos(middle, &sine, &cosine);
  const Vec3<Pack> v_WB{speed * cosine + around.v_WC.x, speed * sine + around.v_WC.y,
                        climb + around.v_WC.z};
  s->p_WB += v_WB * Pack(dt);
  QuaternionOf(s->rpy, &s->q_WB);
  s->R_WB = RotationOf(s->q_WB);
  s->v_WB_B = Vec3<Pack>{speed, zero, climb} + s->R_WB.TransposeTimes(around.v_WC);
  s->w_WB_B = {zero, zero, rate};
  FollowQuaternion(s);
}

}  // namespace stg::dynamics
