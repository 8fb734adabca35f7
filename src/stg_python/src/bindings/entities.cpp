#include "stg_agent/entities/entities.hpp"

#include <pybind11/numpy.h>

#include <stdexcept>

#include "arrays.hpp"
#include "bound_env.hpp"

namespace stg::python {
namespace {

/// A copy of `rows` rows without gaps.
py::array_t<float> RowsOf(const float* data, int rows, int numbers) {
  py::array_t<float> array(Shape{rows, numbers});
  std::copy(data, data + static_cast<std::ptrdiff_t>(rows) * numbers, array.mutable_data());
  return array;
}

}  // namespace

py::dict BoundEnv::Entities(int env, int agent) const {
  const Use use(this);
  const EnvPool::Place place = at(env);
  if (agent < 0 || agent >= agents_) {
    throw py::index_error("agent: " + std::to_string(agent) + " is not in 0 to " +
                          std::to_string(agents_ - 1));
  }
  if (place.envs.scenario(place.env).mode != InformationMode::kAcoustic) {
    throw py::value_error("entities are what an AUV finds out by itself: mode must be acoustic");
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
  return rows;
}

}  // namespace stg::python
