#pragma once

#include <string>
#include <vector>

#include "acoustic_channel/channel_config.hpp"

namespace stg::acoustics {

/// The network of a fleet from a YAML file with the section `channel` and, optionally, `seed` and
/// `time`. Missing keys have their defaults. The file may also be a whole scenario, which states
/// its `name`; its other sections are then ignored. Throws UserError with file, line and key.
/// @param overrides key.path=value, after the file
/// @param vehicles number of vehicles; it replaces the number in the file
NetworkConfig LoadFleetNetwork(const std::string& file, const std::vector<std::string>& overrides,
                               int vehicles);

}  // namespace stg::acoustics
