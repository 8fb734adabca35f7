#include "stg_agent/entities/entities.hpp"

#include <pybind11/numpy.h>

#include <stdexcept>

#include "arrays.hpp"
#include "bound_env.hpp"

namespace stg::python {
namespace {

/// A copy of `rows` rows, without gaps.
py::array_t<float> RowsOf(const float* data, int rows, int numbers) {
  py::array_t<float> array(Shape{rows, numbers});
  std::copy(data, data + static_cast<std::ptrdiff_t>(rows) * numbers, array.mutable_data());
  return array;
}

}  // namespace

void BoundEnv::RequireAgent(int agent) const {
  if (agent < 0 || agent >= agents_) {
    throw py::index_error("agent: " + std::to_string(agent) + " is not in 0 to " +
                          std::to_string(agents_ - 1));
  }
}

void BoundEnv::Follow(int env, int agent, int target) {
  const Use use(this);
  const EnvPool::Place place = at(env);
  RequireAgent(agent);
  const Scenario& s = place.envs.scenario(place.env);
  if (!s.agent.task.free()) {
    throw py::value_error(
        "follow: AUVs cannot choose targets in this scenario; set task.assignment to free");
  }
  if (target < 0 || target >= s.world.target.count) {
    throw py::index_error("target: " + std::to_string(target) + " is not in 0 to " +
                          std::to_string(s.world.target.count - 1));
  }
  place.envs.agent(place.env, agent).Follow(target);
}

int BoundEnv::followed(int env, int agent) const {
  const EnvPool::Place place = at(env);
  RequireAgent(agent);
  return place.envs.followed(place.env, agent);
}

py::dict BoundEnv::Entities(int env, int agent) const {
  const Use use(this);
  const EnvPool::Place place = at(env);
  RequireAgent(agent);
  if (place.envs.scenario(place.env).mode != InformationMode::kAcoustic) {
    throw py::value_error("entities hold only an AUV's own knowledge, so mode must be acoustic");
  }
  agent::Entities e;
  agent::BuildEntities(place.envs.agent(place.env, agent), &e);
  py::dict rows;
  rows["self"] = RowsOf(e.self, 1, agent::kSelfNumbers);
  rows["search"] = RowsOf(e.search, 1, agent::kSearchNumbers);
  rows["targets"] = RowsOf(e.target[0], e.targets, agent::kTargetNumbers);
  rows["neighbours"] = RowsOf(e.neighbour[0], e.neighbours, agent::kNeighbourNumbers);
  rows["obstacles"] = RowsOf(e.obstacle[0], e.obstacles, agent::kObstacleNumbers);
  py::array_t<float> edges(Shape{e.targets, e.neighbours, agent::kEdgeNumbers});
  float* to = edges.mutable_data();
  for (int t = 0; t < e.targets; ++t) {
    to = std::copy(e.edge[t][0], e.edge[t][0] + e.neighbours * agent::kEdgeNumbers, to);
  }
  rows["edges"] = edges;
  if (place.envs.scenario(place.env).agent.task.free()) {
    py::list of;
    for (int t = 0; t < e.targets; ++t) of.append(e.target_of_row[t]);
    rows["target_of_row"] = of;
  }
  return rows;
}

}  // namespace stg::python
