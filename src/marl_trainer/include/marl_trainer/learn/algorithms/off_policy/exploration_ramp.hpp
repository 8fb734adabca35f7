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
  /// Adds the options <name>-min and <name>-max, each up to `limit`, and what they must not be.
  /// @param what is explored with, for the help
  void Describe(const std::string& name, double limit, const std::string& what, OptionTable* table);
};

}  // namespace stg::learn
