#pragma once

#include <string>

#include "marl_trainer/learn/options.hpp"

namespace stg::learn {

/// Amount of exploration by environment: from `min` in the first to `max` in the last one, in equal
/// factors. There is no exploration if max is 0.
struct ExplorationRamp {
  double min = 0.0, max = 0.0;

  /// @param place of an environment among all of them, in [0, 1]
  double At(double place) const;
  /// Adds the options <name>-min and <name>-max, each up to `limit`.
  /// @param what name of the explored quantity, for the help
  void Describe(const std::string& name, double limit, const std::string& what,
                config::Table* table);
  /// Throws UserError that names one of the options if they contradict each other.
  void ValidateOrThrow(const std::string& name) const;
};

}  // namespace stg::learn
