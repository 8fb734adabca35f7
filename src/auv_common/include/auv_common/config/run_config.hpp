#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include "auv_common/config/field.hpp"
#include "auv_common/time.hpp"

namespace stg {

/// Clocks of physics, decisions and episodes.
struct TimeConfig {
  double dt_s = 0.1;        ///< physics step
  int decision_steps = 1;   ///< physics steps per decision
  int episode_steps = 500;  ///< decisions per episode (paper: T)
  int tail_steps = 100;     ///< last decisions that count for tail metrics
};

/// What all programs of one run share. Lengths are in one consistent unit, read as metres (the
/// paper's tables label it kilometres); time is in seconds; body axes are FLU, the world is ENU.
struct RunConfig {
  std::string name = "medium";
  std::uint64_t seed = 0;
  int agents = 4;
  /// Where `agents` counts the nodes of an acoustic network: how many of them, the last ones, only
  /// answer pings. It is no key.
  int transponders = 0;
  TimeConfig time;

  double decision_dt_s() const { return time.dt_s * time.decision_steps; }
  /// The same times in whole nanoseconds, in which stamps are counted: they never drift.
  TimeNs step_period() const { return static_cast<TimeNs>(std::llround(time.dt_s * 1e9)); }
  TimeNs decision_period() const { return step_period() * time.decision_steps; }
};

/// A period of something that happens at decisions.
inline bool IsWholeDecisions(double period_s, double decision_dt_s) {
  const double count = period_s / decision_dt_s;
  return std::abs(count - std::round(count)) <= 1e-6;
}

/// Keys, units and ranges of the section `time`.
void Describe(TimeConfig* c, config::Table* t);
/// The keys of RunConfig at the top level.
void DescribeTop(RunConfig* c, config::Table* t);
/// All of RunConfig.
void Describe(RunConfig* c, config::Table* t);
/// Contradictions between its keys.
std::optional<config::Violation> FindConflict(const RunConfig& c);

}  // namespace stg
