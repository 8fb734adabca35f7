#include "stg_agent/entities/entity_policy.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "auv_common/error.hpp"

namespace stg::agent {

namespace {

/// Place of a name in a list. If it is not there, throws UserError "`what` 'name': none of ...".
std::size_t PlaceOf(const std::string& name, const std::vector<std::string>& names,
                    const std::string& what) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) throw UserError(what + " '" + name + "': none of " + JoinNames(names));
  return static_cast<std::size_t>(found - names.begin());
}

}  // namespace

const std::vector<std::string>& EntityActionNames() {
  static const std::vector<std::string> names = {"guidance", "law5", "course3", "velocity3"};
  return names;
}

std::string EntityActionName(EntityAction action) {
  return EntityActionNames()[static_cast<std::size_t>(action)];
}

EntityAction EntityActionNamed(const std::string& name) {
  return static_cast<EntityAction>(PlaceOf(name, EntityActionNames(), "action"));
}

void RequireFits(EntityAction action, const AgentModel& model) {
  const bool walls = std::isfinite(model.wall_m());
  if (walls == (action == EntityAction::kVelocity3)) return;
  throw UserError("the action '" + EntityActionName(action) + "' is for scenarios " +
                  (walls ? "in open water, and '" : "between walls, and '") + model.run.name +
                  (walls ? "' has walls" : "' is in open water"));
}

const std::vector<std::string>& EntityNetworkNames() {
  static const std::vector<std::string> names = {"pool", "graph"};
  return names;
}

std::string EntityNetworkName(EntityNetwork network) {
  return EntityNetworkNames()[static_cast<std::size_t>(network)];
}

EntityNetwork EntityNetworkNamed(const std::string& name) {
  return static_cast<EntityNetwork>(PlaceOf(name, EntityNetworkNames(), "network"));
}

PoolSpec EntityActorSpec(int outputs) {
  PoolSpec spec;
  spec.self = kSelfNumbers;
  spec.search = kSearchNumbers;
  spec.sets = {kTargetNumbers, kNeighbourNumbers, kObstacleNumbers};
  spec.outputs = outputs;
  return spec;
}

GraphSpec EntityGraphSpec(int outputs) {
  GraphSpec spec;
  spec.self = kSelfNumbers;
  spec.search = kSearchNumbers;
  spec.targets = kTargetNumbers;
  spec.neighbours = kNeighbourNumbers;
  spec.obstacles = kObstacleNumbers;
  spec.edges = kEdgeNumbers;
  spec.quality = kNeighbourQuality;
  spec.follows = kTargetFollowed;
  spec.outputs = outputs;
  return spec;
}

std::size_t EntityParameters(EntityNetwork network, int outputs) {
  return network == EntityNetwork::kGraph ? GraphBlocks(EntityGraphSpec(outputs)).size
                                          : PoolBlocks(EntityActorSpec(outputs)).size;
}

void EntityRows(const Entities& e, PoolRows (*sets)[kEntitySets]) {
  (*sets)[0] = {e.target[0], e.targets, kTargetNumbers};
  (*sets)[1] = {e.neighbour[0], e.neighbours, kNeighbourNumbers};
  (*sets)[2] = {e.obstacle[0], e.obstacles, kObstacleNumbers};
}

GraphRows EntityGraphRows(const Entities& e) {
  GraphRows rows;
  rows.self = e.self;
  rows.search = e.search;
  EntityRows(e, &rows.sets);
  rows.edges = e.edge[0][0];
  rows.edge_target_stride = kNeighbourRows * kEdgeNumbers;
  rows.edge_stride = kEdgeNumbers;
  return rows;
}

namespace {

std::variant<PoolNetwork, GraphNetwork> NetworkOf(const EntityPolicy::Parameters& p) {
  const int outputs = CommandSize(p.action);
  if (p.network == EntityNetwork::kGraph) return GraphNetwork(EntityGraphSpec(outputs), p.numbers);
  return PoolNetwork(EntityActorSpec(outputs), p.numbers);
}

}  // namespace

EntityPolicy::EntityPolicy(Parameters parameters)
    : parameters_(std::move(parameters)), network_(NetworkOf(parameters_)) {
  if (static_cast<int>(parameters_.log_std.size()) != CommandSize(parameters_.action)) {
    throw UserError("policy: has " + std::to_string(parameters_.log_std.size()) +
                    " deviations for " + std::to_string(CommandSize(parameters_.action)) +
                    " numbers of a command");
  }
  for (const float s : parameters_.log_std) {
    if (!std::isfinite(s)) throw UserError("policy: a deviation is not finite");
  }
  if (!(parameters_.noise_time_s >= 0.0 && parameters_.noise_time_s <= kMaxNoiseTime_s)) {
    throw UserError("policy: the correlation time of the exploration is not from 0 to 10000 s");
  }
  parameters_.metadata.observation_layout = kEntityLayout;
  parameters_.metadata.action_interface = EntityActionName(parameters_.action);
  parameters_.metadata.action_scale = 1.0;
}

void EntityPolicy::RequireFits(const AgentModel& model) const {
  try {
    agent::RequireFits(parameters_.action, model);
  } catch (const UserError& error) {
    throw UserError("policy '" + metadata().id + "': " + error.what());
  }
}

int EntityPolicy::Choices(const Entities& entities, float* logits, float* commands) const {
  int count = 1;
  if (const auto* graph = std::get_if<GraphNetwork>(&network_)) {
    graph->Forward(EntityGraphRows(entities), logits, commands);
    count = entities.targets + 1;
  } else {
    PoolRows sets[kEntitySets];
    EntityRows(entities, &sets);
    std::get<PoolNetwork>(network_).Forward(entities.self, entities.search, sets, commands);
    logits[0] = 0.0F;
  }
  const int numbers = count * CommandSize(parameters_.action);
  for (int k = 0; k < numbers; ++k) commands[k] = std::tanh(commands[k]);
  return count;
}

int EntityPolicy::Command(const Entities& entities, float* command) const {
  const int size = CommandSize(parameters_.action);
  float logits[kTargetRows + 1], commands[(kTargetRows + 1) * kCommandNumbers];
  const int count = Choices(entities, logits, commands);
  // The first of equal choices: with all zeros the present target stays.
  int choice = 0;
  for (int t = 1; t < count; ++t) {
    if (logits[t] > logits[choice]) choice = t;
  }
  std::copy(commands + choice * size, commands + (choice + 1) * size, command);
  return choice;
}

}  // namespace stg::agent
