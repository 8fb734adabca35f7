#pragma once

#include <string>
#include <vector>

#include "acoustic_channel/channel_config.hpp"

namespace stg::acoustics {

/// The network of a fleet from a YAML file with the section `channel` and, if wanted, `seed` and
/// `time`; keys left out have their defaults. It may also be a whole scenario, which states its
/// `name`; other sections are then ignored. Throws UserError with file, line and key.
/// @param overrides key.path=value, after the file
/// @param vehicles number of vehicles, which replaces that of the file
NetworkConfig LoadFleetNetwork(const std::string& file, const std::vector<std::string>& overrides,
                               int vehicles);

}  // namespace stg::acoustics
