#pragma once

#include <map>
#include <string>
#include <vector>

#include "auv_common/numbers/vector.hpp"
#include "stg_env/scenario/scenario.hpp"

namespace stg::env {

/// A golden trace: states of the release's simulator under given actions. It is a folder with
/// config.yaml (initial state, settings) and steps.csv (one row per step and AUV; row 0 is the
/// initial state, the action of row k leads to row k).
struct Trace {
  Scenario scenario;
  std::vector<Vec3<double>> p_WB, p_WT, v_WT;  ///< initial world positions and target velocities
  std::vector<std::string> columns;
  std::vector<std::vector<double>> rows;  ///< NaN where a cell is empty
  std::string folder;
};

/// Reads a trace over the settings of `base` (the release's scenario). Throws
/// UserError with file, line and key or column.
Trace LoadTrace(const std::string& folder, const Scenario& base);

/// Absolute differences between a replay and its trace, each in the unit of its column.
struct TraceError {
  double max_abs_error = 0.0;
  std::map<std::string, double> by_group;  ///< state, tau, target, observation, reward
  std::map<std::string, double> by_column;
  int worst_step = 0, worst_agent = 0;
  std::string worst_column;
  int first_bad_step = -1;  ///< first one past the tolerance, or -1
  std::string first_bad_column;
  int steps = 0;
};

/// Replays the trace's actions in this simulator and compares every column.
TraceError ReplayTrace(const Trace& trace, double tolerance);

}  // namespace stg::env
