#pragma once

#include <optional>
#include <string>

#include "acoustic_channel/access/contention_config.hpp"
#include "acoustic_channel/access/periodic_config.hpp"
#include "acoustic_channel/access/slots_config.hpp"
#include "acoustic_channel/models/extended_config.hpp"
#include "acoustic_channel/models/range_config.hpp"
#include "acoustic_channel/network/physical_config.hpp"
#include "auv_common/config/options.hpp"
#include "auv_common/config/run_config.hpp"

namespace stg::acoustics {

/// The section `channel`: the names of its parts, and their keys, which are described beside their
/// code.
struct ChannelConfig {
  std::string model = "extended";   ///< of PropagationModels()
  std::string access = "periodic";  ///< of MediumAccesses()
  double range_m = 0.45;            ///< R_c of Eq. 5
  RangeConfig range;
  ExtendedConfig extended;
  PhysicalConfig physical;
  PeriodicConfig periodic;
  SlotsConfig slots;
  ContentionConfig contention;
  config::OptionsByName models = {},
                        accesses = {};  ///< options of models and rules that are registered
};

/// Keys, units and ranges of the section.
void Describe(ChannelConfig* c, config::Table* t);
/// Contradictions between the section and the clocks of the run.
std::optional<config::Violation> FindConflict(const ChannelConfig& c, const RunConfig& run);

/// Makes keys that only scenarios read belong to them: episodes, shadows of the sea, and the range
/// of a model that has no range. For programs that run the network alone, after the other keys.
/// @param files_may a file may state them, because it may be a scenario
void OwnByScenarios(const ChannelConfig* c, bool files_may, config::Table* t);

/// Sections of a program that runs the network alone.
struct NetworkConfig {
  RunConfig run;
  ChannelConfig channel;
};
void Describe(NetworkConfig* c, config::Table* t);
std::optional<config::Violation> FindConflict(const NetworkConfig& c);

}  // namespace stg::acoustics
