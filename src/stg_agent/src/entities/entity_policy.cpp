#include "stg_agent/entities/entity_policy.hpp"

#include <cmath>
#include <utility>

#include "auv_common/error.hpp"

namespace stg::agent {

std::string EntityActionName(EntityAction action) {
  switch (action) {
    case EntityAction::kGuidance:
      return "guidance";
    case EntityAction::kLaw5:
      return "law5";
    case EntityAction::kCourse3:
      break;
  }
  return "course3";
}

EntityAction EntityActionNamed(const std::string& name) {
  for (const EntityAction action :
       {EntityAction::kGuidance, EntityAction::kLaw5, EntityAction::kCourse3}) {
    if (name == EntityActionName(action)) return action;
  }
  throw UserError("action '" + name + "': none of guidance, law5, course3");
}

PoolSpec EntityActorSpec(int outputs) {
  PoolSpec spec;
  spec.self = kSelfNumbers;
  spec.search = kSearchNumbers;
  spec.sets = {kTargetNumbers, kNeighbourNumbers, kObstacleNumbers};
  spec.outputs = outputs;
  return spec;
}

void EntityRows(const Entities& e, PoolRows (*sets)[kEntitySets]) {
  (*sets)[0] = {e.target[0], e.targets, kTargetNumbers};
  (*sets)[1] = {e.neighbour[0], e.neighbours, kNeighbourNumbers};
  (*sets)[2] = {e.obstacle[0], e.obstacles, kObstacleNumbers};
}

EntityPolicy::EntityPolicy(Parameters parameters)
    : parameters_(std::move(parameters)),
      network_(EntityActorSpec(CommandSize(parameters_.action)), parameters_.numbers) {
  if (static_cast<int>(parameters_.log_std.size()) != CommandSize(parameters_.action)) {
    throw UserError("policy: has " + std::to_string(parameters_.log_std.size()) +
                    " deviations for " + std::to_string(CommandSize(parameters_.action)) +
                    " numbers of a command");
  }
  for (const float s : parameters_.log_std) {
    if (!std::isfinite(s)) throw UserError("policy: a deviation is not finite");
  }
  parameters_.metadata.observation_layout = kEntityLayout;
  parameters_.metadata.action_interface = EntityActionName(parameters_.action);
  parameters_.metadata.action_scale = 1.0;
}

void EntityPolicy::Command(const Entities& entities, float* command) const {
  PoolRows sets[kEntitySets];
  EntityRows(entities, &sets);
  network_.Forward(entities.self, entities.search, sets, command);
  for (int k = 0; k < CommandSize(parameters_.action); ++k) command[k] = std::tanh(command[k]);
}

}  // namespace stg::agent
