#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include "auv_common/config/field.hpp"
#include "auv_common/time.hpp"

namespace stg {

/// Durations of physics steps, decisions and episodes.
struct TimeConfig {
  double dt_s = 0.1;        ///< physics step
  int decision_steps = 1;   ///< physics steps per decision
  int episode_steps = 500;  ///< decisions per episode (paper: T)
  int tail_steps = 100;     ///< last decisions of an episode, over which tail metrics are taken
};

/// Settings that all programs of one run share. Lengths have one consistent unit, read as metres
/// (the paper's tables label it kilometres). Time is in seconds. Body axes are FLU, and the world
/// is ENU.
struct RunConfig {
  std::string name = "medium";
  std::uint64_t seed = 0;
  int agents = 4;
  /// Number of nodes that only answer pings. In an acoustic network `agents` counts all nodes, and
  /// these are the last of them. A file has no key for it.
  int transponders = 0;
  /// Number of nodes whose clocks GPS keeps right. They stand directly before the transponders. A
  /// file has no key for it.
  int timekeepers = 0;
  TimeConfig time;

  double decision_dt_s() const { return time.dt_s * time.decision_steps; }
  /// The same durations in whole nanoseconds. Stamps are counted in these, so they never drift.
  TimeNs step_period() const { return static_cast<TimeNs>(std::llround(time.dt_s * 1e9)); }
  TimeNs decision_period() const { return step_period() * time.decision_steps; }
};

/// True if a period is a whole number of decisions.
inline bool IsWholeDecisions(double period_s, double decision_dt_s) {
  const double count = period_s / decision_dt_s;
  return std::abs(count - std::round(count)) <= 1e-6;
}

/// Adds the keys of the section `time`, with units and ranges.
void Describe(TimeConfig* c, config::Table* t);
/// Adds the keys of RunConfig at the top level.
void DescribeTop(RunConfig* c, config::Table* t);
/// Refuses an override of the key `seed`, because a simulation has the seed of its command.
void TakeSeedFromCommand(config::Table* t);
/// Adds all keys of RunConfig.
void Describe(RunConfig* c, config::Table* t);
/// Contradictions between the keys.
std::optional<config::Violation> FindConflict(const RunConfig& c);

}  // namespace stg
