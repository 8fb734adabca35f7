#pragma once

#include <string>
#include <vector>

#include "acoustic_channel/channel_config.hpp"

namespace stg::acoustics {

/// The network of a fleet from a YAML file with the section `channel` and, if wanted, `seed` and
/// `time`; keys left out have their defaults. A whole scenario will do, too: one that states its
/// `name`, of which the other sections are left to their own readers. Throws UserError with file,
/// line and key.
/// @param overrides key.path=value, after the file
/// @param vehicles whatever number of AUVs the file states
NetworkConfig LoadFleetNetwork(const std::string& file, const std::vector<std::string>& overrides,
                               int vehicles);

}  // namespace stg::acoustics
