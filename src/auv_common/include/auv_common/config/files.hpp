#pragma once

#include <string>
#include <vector>

#include "auv_common/config/loader.hpp"

/// Folders and names of the shipped scenario files.
namespace stg::config {

/// Finds shipped files by name. `medium` is <folder>/medium.yaml. Its condition `fast_target` is
/// <folder>/conditions/<name>/fast_target.yaml; <name> is the name of the file, or of its nearest
/// base that has this condition. If there is no such file, it is
/// <folder>/conditions/<stage>_fast_target.yaml with the file's reset.stage. `nominal` is no
/// overlay. A name with a slash, or with the ending .yaml, is a path. Throws UserError.
Source NamedSource(const std::string& folder, const std::string& scenario,
                   const std::string& condition = "nominal",
                   const std::vector<std::string>& overrides = {});

/// Names of the conditions of all scenarios in a folder.
std::vector<std::string> ConditionNames(const std::string& folder);

/// The folder of the shipped scenarios: the first of $STG_SCENARIOS, the folder that was installed
/// with this code, the folder of stg_bringup on ROS_PACKAGE_PATH, and the folder in this code's
/// source tree. Throws UserError.
std::string ScenarioFolder();

}  // namespace stg::config
