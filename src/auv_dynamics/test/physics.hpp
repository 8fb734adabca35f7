#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "auv_dynamics/vehicle/integrator.hpp"
#include "auv_dynamics/vehicle/vehicle_model.hpp"
#include "auv_dynamics/world/world.hpp"

/// What the physics tests share.
namespace stg::dynamics {

/// REMUS 100 without velocity limits, so that the equations act alone.
inline VehicleConfig FreeVehicle() {
  VehicleConfig c;
  c.clip_velocity = false;
  return c;
}

/// The vehicle of the simulator that the authors released.
inline VehicleConfig ReleaseVehicle() {
  VehicleConfig c;
  c.profile = "release";
  c.added_mass_coriolis = AddedMassCoriolis::kOff;
  c.reversed_coriolis = true;
  c.restoring = false;
  c.integrator = Integrator::kSemiImplicit;
  return c;
}

/// Vehicle at the world's origin, at rest, at the given roll, pitch, yaw [rad].
inline VehicleState<double> AtAttitude(const Vec3<double>& rpy) {
  VehicleState<double> s;
  s.rpy = rpy;
  s.trig = TrigOf(rpy);
  s.R_WB = RotationOf(s.trig);
  QuaternionOf(rpy, &s.q_WB);
  return s;
}

/// Advances a free vehicle by `steps` of dt under a constant wrench.
inline void Advance(const VehicleModel& model, const Wrench<double>& tau, const Vec3<double>& v_WC,
                    double dt, int steps, VehicleState<double>* s) {
  for (int k = 0; k < steps; ++k) Integrate(model, tau, v_WC, dt, s);
}

inline Vec3<double> RandomVector(std::mt19937_64* random, double largest) {
  std::uniform_real_distribution<double> uniform(-largest, largest);
  const double x = uniform(*random), y = uniform(*random), z = uniform(*random);
  return {x, y, z};
}

inline BodyVelocity<double> RandomVelocity(std::mt19937_64* random) {
  const Vec3<double> v = RandomVector(random, 1.5), w = RandomVector(random, 1.2);
  return {v, w};
}

inline double Power(const BodyVelocity<double>& a, const BodyVelocity<double>& b) {
  return Dot(a.v, b.v) + Dot(a.w, b.w);
}

/// WorldScenario with `agents` vehicles and nothing random in it.
inline WorldScenario QuietScenario(int agents) {
  WorldScenario s;
  s.run.agents = agents;
  s.world.sensing.cue_std_m = 0.0;
  return s;
}

inline std::vector<Wrench<Pack>> NoForce(int agents) {
  return std::vector<Wrench<Pack>>(static_cast<size_t>(agents));
}

}  // namespace stg::dynamics
