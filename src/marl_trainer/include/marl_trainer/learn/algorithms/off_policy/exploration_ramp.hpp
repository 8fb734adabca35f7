#pragma once

#include <string>

#include "marl_trainer/learn/options.hpp"

namespace stg::learn {

/// How much is explored: from `min` in the first environment to `max` in the last one, by equal
/// factors; nowhere where max is 0.
struct ExplorationRamp {
  double min = 0.0, max = 0.0;

  /// @param place of an environment among all, in [0, 1]
  double At(double place) const;
  /// Adds the options <name>-min and <name>-max, each up to `limit`.
  /// @param what is explored with, for the help
  void Describe(const std::string& name, double limit, const std::string& what,
                config::Table* table);
  /// Throws UserError that names one of them when they contradict each other.
  void ValidateOrThrow(const std::string& name) const;
};

}  // namespace stg::learn
