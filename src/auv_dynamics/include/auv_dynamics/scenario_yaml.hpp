#pragma once

#include <string>
#include <vector>

#include "auv_dynamics/scenario.hpp"

namespace stg {

/// Loads a scenario file, then applies overlays (files with a subset of the
/// keys) and `key.path=value` overrides in order.
///
/// A scenario file either states every key or names another one with
/// `base: <file>` (relative to itself) and states the difference. An unknown or
/// missing key, a wrong type, a non-finite or out-of-range value throws
/// UserError with file, line and key.
Scenario LoadScenario(const std::string& file, const std::vector<std::string>& overlays = {},
                      const std::vector<std::string>& overrides = {});

/// As LoadScenario, but finds shipped files by name: `medium` is
/// <folder>/medium.yaml, condition `fast_target` of it is
/// <folder>/conditions/<stage>_fast_target.yaml (nominal: no overlay). A name
/// with a slash or ending in .yaml is taken as a path.
Scenario LoadNamedScenario(const std::string& folder, const std::string& scenario,
                           const std::string& condition = "nominal",
                           const std::vector<std::string>& overrides = {});

/// The folder with the shipped scenarios: $STG_SCENARIOS if set, else the
/// stg_bringup package found on ROS_PACKAGE_PATH or beside the source tree.
std::string ScenarioFolder();

/// Every key with its value; LoadScenario of the result gives the same struct.
std::string ToYaml(const Scenario& scenario);

/// FNV-1a 64 of ToYaml, hexadecimal; identifies the scenario in policy files.
std::string ScenarioHash(const Scenario& scenario);

}  // namespace stg
