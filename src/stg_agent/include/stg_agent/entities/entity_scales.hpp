#pragma once

#include "stg_agent/agent_config.hpp"

/// Scales of the numbers in entities (docs/entities.md).
namespace stg::agent {

float FarScale(double distance_m);                       ///< L
float MiddleScale(double distance_m, double desired_m);  ///< M
float BandScale(double distance_m, double desired_m);    ///< B
float AgeScale(double time_s);                           ///< A
float DeviationScale(double std_m);                      ///< S

/// The same scales in the units of a scenario. In open water all units are 1, so the scales are
/// those above. Between walls, swarms may be of any size. So there the unit of length is d* / 90 m,
/// and the unit of time is a decision / 5 s, because a command lasts one decision. The numbers are
/// then as large as in the field.
struct EntityScales {
  EntityScales() = default;  ///< of open water
  explicit EntityScales(const AgentModel& model);

  bool walls = false;  ///< the scenario is not in open water
  double length = 1.0, time = 1.0, speed = 1.0;
  /// Scale of the distance between AUVs: 20 m, but at least the diameter of an AUV.
  double apart_m = 20.0;

  float Far(double distance_m) const { return FarScale(distance_m / length); }
  float Middle(double distance_m, double desired_m) const {
    return MiddleScale(distance_m / length, desired_m / length);
  }
  float Band(double distance_m, double desired_m) const {
    return BandScale(distance_m / length, desired_m / length);
  }
  float Age(double time_s) const { return AgeScale(time_s / time); }
  float Deviation(double std_m) const { return DeviationScale(std_m / length); }
  /// A speed against that of the vehicles of the field.
  double Speed(double mps) const { return mps / (kFieldSpeed_mps * speed); }

  static constexpr double kFieldSpeed_mps = 2.3;
};

}  // namespace stg::agent
