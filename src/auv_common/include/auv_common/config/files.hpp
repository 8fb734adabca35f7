#pragma once

#include <string>
#include <vector>

#include "auv_common/config/loader.hpp"

/// Where shipped scenario files lie and how they are named.
namespace stg::config {

/// Finds shipped files by name: `medium` is <folder>/medium.yaml, condition `fast_target` of it is
/// <folder>/conditions/<name>/fast_target.yaml, where name is that of the file or of the nearest of
/// its bases that has one, else <folder>/conditions/<stage>_fast_target.yaml, where stage is the
/// file's reset.stage (nominal: no overlay). A name with a slash or ending in .yaml is taken as a
/// path. Throws UserError.
Source NamedSource(const std::string& folder, const std::string& scenario,
                   const std::string& condition = "nominal",
                   const std::vector<std::string>& overrides = {});

/// Names of the conditions of all scenarios of a folder.
std::vector<std::string> ConditionNames(const std::string& folder);

/// The folder with the shipped scenarios: $STG_SCENARIOS, else the one that was installed with this
/// code, else stg_bringup's on ROS_PACKAGE_PATH, else that of this code's tree. Throws UserError.
std::string ScenarioFolder();

}  // namespace stg::config
