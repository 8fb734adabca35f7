#pragma once

#include <string>

#include "auv_common/numbers/lanes.hpp"
#include "auv_common/version.hpp"

/// Include this in a shared library that adds things of your own to this suite: reward terms,
/// controllers, vehicles, or other things of a registry (auv_common/registry.hpp). Every program
/// can then use them.
///
///   STG_PLUGIN { dynamics::TargetMotions().Add("zigzag", MakeZigzag); }
///
/// A configuration names its libraries in the key `plugins`, and a command line names them with
/// --plugin. See docs/how_to/load_a_plugin.md.
#define STG_PLUGIN                                   \
  extern "C" const char* stg_plugin_built_for() {    \
    static const std::string text = stg::BuiltFor(); \
    return text.c_str();                             \
  }                                                  \
  extern "C" void stg_plugin_register()

extern "C" {
/// The build that the library needs. STG_PLUGIN defines both functions.
const char* stg_plugin_built_for();
void stg_plugin_register();
}

namespace stg {

/// What two libraries must share to exchange the types of this suite: the minor version, and the
/// number of lanes, which the headers use in their types.
inline std::string BuiltFor() {
  return std::string(kMinorVersion) + " with " + std::to_string(kLanes) + " lanes";
}

}  // namespace stg
