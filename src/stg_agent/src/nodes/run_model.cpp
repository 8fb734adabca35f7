#include "run_model.hpp"

#include <ros/param.h>

#include "auv_common/error.hpp"
#include "auv_common/nodes/parameters.hpp"

namespace stg::nodes {

agent::AgentModel ModelOfRun() {
  agent::AgentModel model = LoadScenarioParameters<agent::AgentScenario>().model();
  const bool over_modems = ros::param::has("/acoustic_channel/ports");
  if (over_modems && (model.sensing.pings() || model.pings_members())) {
    throw UserError(
        "sensing.ranging, localization.ranges.by: over modems (argument 'modems') AUVs do not "
        "ping");
  }
  if (over_modems && model.stations.count() > 0) {
    throw UserError("stations: over modems (argument 'modems') there are none");
  }
  return model;
}

}  // namespace stg::nodes
