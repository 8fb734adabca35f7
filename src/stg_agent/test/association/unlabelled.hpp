#pragma once

#include "estimation/fleet.hpp"

namespace stg::agent {

inline constexpr TimeNs kSecond_ns = 1'000'000'000;

/// Three AUVs with perfect navigation and two targets, whose detections are not labelled.
inline AgentModel UnlabelledModel(const char* sensor, double period_s = 0.0) {
  FleetOptions o;
  o.sensor = sensor;
  o.drift = false;
  o.observers = 3;
  AgentScenario s = FleetScenario(o);
  s.world.target.count = 2;
  s.world.sensing.labelled = false;
  s.world.sensing.period_s = period_s;
  s.agent.task.assignment = Assignment::kFree;
  return s.model();
}

inline dynamics::Detection PositionAt(TimeNs stamp, const Vec3<double>& p_WT, double std_m) {
  dynamics::Detection d;
  d.stamp = stamp;
  d.target = dynamics::kUnlabelled;
  d.p_WT = p_WT;
  d.std_m = std_m;
  return d;
}

}  // namespace stg::agent
