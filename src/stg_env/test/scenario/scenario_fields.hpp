#pragma once

#include <vector>

#include "auv_common/config/value.hpp"
#include "stg_env/scenario/scenario.hpp"

namespace stg {

/// Every key of a scenario, in file order.
inline std::vector<config::Field> ScenarioFields(Scenario* scenario) {
  config::Table table;
  Describe(scenario, &table);
  return table.fields();
}

}  // namespace stg
