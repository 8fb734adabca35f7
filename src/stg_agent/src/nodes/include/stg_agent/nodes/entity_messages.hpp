#pragma once

#include <auv_msgs/EntityStep.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "stg_agent/entities/entity_draw.hpp"

/// Conversions of commands that were drawn with a policy over entities.
namespace stg::nodes {

/// Writes rows, command and probability.
inline void SetDecision(const agent::EntityDecision& d, int command_size, auv_msgs::EntityStep* m) {
  const agent::Entities& e = d.entities;
  m->layout = agent::kEntityLayout;
  m->self.assign(e.self, e.self + agent::kSelfNumbers);
  m->search.assign(e.search, e.search + agent::kSearchNumbers);
  m->targets.assign(e.target[0], e.target[0] + e.targets * agent::kTargetNumbers);
  m->neighbours.assign(e.neighbour[0], e.neighbour[0] + e.neighbours * agent::kNeighbourNumbers);
  m->obstacles.assign(e.obstacle[0], e.obstacle[0] + e.obstacles * agent::kObstacleNumbers);
  m->edges.clear();
  for (int t = 0; t < e.targets; ++t) {
    const float* row = e.edge[t][0];
    m->edges.insert(m->edges.end(), row, row + e.neighbours * agent::kEdgeNumbers);
  }
  m->choice = static_cast<std::uint32_t>(d.choice);
  m->command.assign(d.command, d.command + command_size);
  m->log_probability = d.log_probability;
}

/// Number of rows with `numbers` numbers each; -1 if there are more than `most` or a part of a row.
inline int RowsOf(const std::vector<float>& rows, int numbers, int most) {
  const auto size = static_cast<std::size_t>(numbers);
  const std::size_t count = rows.size() / size;
  const bool fits = rows.size() % size == 0 && count <= static_cast<std::size_t>(most);
  return fits ? static_cast<int>(count) : -1;
}

/// Reads rows, command and probability. Returns false if the sizes do not fit the layout. The
/// targets of the rows are not in the message.
inline bool DecisionOf(const auv_msgs::EntityStep& m, agent::EntityDecision* d) {
  agent::Entities& e = d->entities;
  e.targets = RowsOf(m.targets, agent::kTargetNumbers, agent::kTargetRows);
  e.neighbours = RowsOf(m.neighbours, agent::kNeighbourNumbers, agent::kNeighbourRows);
  e.obstacles = RowsOf(m.obstacles, agent::kObstacleNumbers, agent::kObstacleRows);
  if (e.targets < 0 || e.neighbours < 0 || e.obstacles < 0) return false;
  const auto edges = static_cast<std::size_t>(e.targets * e.neighbours * agent::kEdgeNumbers);
  if (m.layout != agent::kEntityLayout || m.self.size() != agent::kSelfNumbers ||
      m.search.size() != agent::kSearchNumbers || m.edges.size() != edges ||
      m.command.size() > agent::kCommandNumbers) {
    return false;
  }
  std::copy(m.self.begin(), m.self.end(), e.self);
  std::copy(m.search.begin(), m.search.end(), e.search);
  std::copy(m.targets.begin(), m.targets.end(), e.target[0]);
  std::copy(m.neighbours.begin(), m.neighbours.end(), e.neighbour[0]);
  std::copy(m.obstacles.begin(), m.obstacles.end(), e.obstacle[0]);
  const std::ptrdiff_t row = e.neighbours * agent::kEdgeNumbers;
  for (int t = 0; t < e.targets; ++t) {
    std::copy_n(m.edges.begin() + t * row, row, e.edge[t][0]);
  }
  d->choice = static_cast<int>(std::min<std::uint32_t>(m.choice, agent::kMostChoices));
  std::copy(m.command.begin(), m.command.end(), d->command);
  d->log_probability = m.log_probability;
  return true;
}

}  // namespace stg::nodes
