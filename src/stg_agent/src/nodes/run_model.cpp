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
        "sensing.ranging, localization.ranges.by: with the argument 'modems' AUVs cannot ping");
  }
  if (over_modems && model.stations.count() > 0) {
    throw UserError("stations: a run with the argument 'modems' cannot have stations");
  }
  return model;
}

}  // namespace stg::nodes
