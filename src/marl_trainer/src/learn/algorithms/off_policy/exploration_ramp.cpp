#include "marl_trainer/learn/algorithms/off_policy/exploration_ramp.hpp"

#include <cmath>

namespace stg::learn {

double ExplorationRamp::At(double place) const {
  return max > 0.0 ? min * std::pow(max / min, place) : 0.0;
}

void ExplorationRamp::Describe(const std::string& name, double limit, const std::string& what,
                               config::Table* table) {
  table->Add(
      name + "-min", &min, {0, limit}, "-",
      what +
          " in the first environment; it grows by equal factors from environment to environment");
  table->Add(name + "-max", &max, {0, limit}, "-", what + " in the last environment");
}

void ExplorationRamp::ValidateOrThrow(const std::string& name) const {
  RequireOption(min <= max, name + "-max", "must not be below --" + name + "-min");
  RequireOption(min > 0.0 || max == 0.0, name + "-min",
                "must not be 0 where --" + name + "-max is not");
}

}  // namespace stg::learn
