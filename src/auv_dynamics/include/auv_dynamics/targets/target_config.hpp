#pragma once

#include <string>

#include "auv_common/config/options.hpp"

namespace stg::dynamics {

/// Targets and their motion.
struct TargetConfig {
  int count = 1;
  std::string motion = "constant_velocity";  ///< name in the registry of target motions
  double max_speed_mps = 0.05;
  double max_turn_rate_radps = 0.5;
  config::OptionsByName motions = {};  ///< options of each

  /// Target of an AUV: its index modulo the number of targets.
  int of(int agent) const { return agent % count; }
};

/// Keys, units and ranges of the section.
void Describe(TargetConfig* c, config::Table* t);

}  // namespace stg::dynamics
