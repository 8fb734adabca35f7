#include "stg_agent/entities/entity_scales.hpp"

#include <algorithm>
#include <cmath>

namespace stg::agent {
namespace {

// Desired distance and length of a command in the field.
constexpr double kFieldDistance_m = 90.0, kFieldCommand_s = 5.0;

}  // namespace

float FarScale(double d) { return static_cast<float>(std::log(1.0 + d / 30.0) / 4.215); }
float MiddleScale(double d, double desired) {
  return static_cast<float>(std::tanh((d - desired) / 200.0));
}
float BandScale(double d, double desired) {
  return static_cast<float>(std::clamp((d - desired) / 30.0, -3.0, 3.0));
}
float AgeScale(double t) {
  return static_cast<float>(std::log(1.0 + std::max(t, 0.0) / 5.0) / 4.11);
}
float DeviationScale(double s) { return static_cast<float>(std::log(1.0 + s / 5.0) / 5.30); }

EntityScales::EntityScales(const AgentModel& model) : walls(std::isfinite(model.wall_m())) {
  if (!walls) return;
  length = model.task.desired_distance_m / kFieldDistance_m;
  time = model.run.decision_dt_s() / kFieldCommand_s;
  speed = length / time;
  apart_m = std::max(apart_m * length, 2.0 * model.vehicle.radius_m);
}

}  // namespace stg::agent
