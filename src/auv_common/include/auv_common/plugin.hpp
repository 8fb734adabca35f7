#pragma once

#include <string>

#include "auv_common/numbers/lanes.hpp"
#include "auv_common/version.hpp"

/// What a shared library of your own needs whose things every program of this suite can use:
/// reward terms, controllers, vehicles, whatever a registry (auv_common/registry.hpp) holds.
///
///   STG_PLUGIN { dynamics::TargetMotions().Add("zigzag", MakeZigzag); }
///
/// A configuration names its libraries in the key `plugins`, a command line with --plugin. See
/// docs/how_to/load_a_plugin.md.
#define STG_PLUGIN                                   \
  extern "C" const char* stg_plugin_built_for() {    \
    static const std::string text = stg::BuiltFor(); \
    return text.c_str();                             \
  }                                                  \
  extern "C" void stg_plugin_register()

extern "C" {
/// What the library was built for; STG_PLUGIN writes both functions.
const char* stg_plugin_built_for();
void stg_plugin_register();
}

namespace stg {

/// What two libraries must share to exchange this suite's types: the minor version, and how many
/// numbers the registers hold that the headers compute with.
inline std::string BuiltFor() {
  return std::string(kMinorVersion) + " with " + std::to_string(kLanes) + " lanes";
}

}  // namespace stg
