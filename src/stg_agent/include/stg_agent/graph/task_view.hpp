#pragma once

#include <array>

#include "stg_agent/graph/features.hpp"

namespace stg::agent {

/// The semantic state of one decision, as in the observation (Eqs. 14-19).
struct TaskView {
  std::array<double, kTrackingNumbers> z_track;
  int phase;    ///< Phase
  int quality;  ///< Quality
  std::array<double, kGraphNumbers> graph;
  bool role;
};

inline TaskView TaskOf(const ObservationConfig& c, const Knowledge<double>& k) {
  double z[kTrackingNumbers], graph[kGraphNumbers];
  TrackingVector(c, k, &z);
  GraphSummary(c, k, &graph);
  TaskView view;
  std::copy(z, z + kTrackingNumbers, view.z_track.begin());
  std::copy(graph, graph + kGraphNumbers, view.graph.begin());
  view.phase = PhaseOf(c, k);
  view.quality = QualityOf(c, k);
  view.role = graph[kGraphRole] > 0.5;
  return view;
}

}  // namespace stg::agent
