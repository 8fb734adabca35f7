#include "stg_agent/agent/agent_view.hpp"

namespace stg::agent {

int AgentView::Nearest(int count, NeighbourSight<double>* sights) const {
  int found = 0;
  for (const int id : neighbours().known()) {
    const NeighbourSight<double> sight = sights_.at(id);
    int rank = found;
    while (rank > 0 && sight.distance_m < sights[rank - 1].distance_m) --rank;
    if (rank >= count) continue;
    if (found < count) ++found;
    for (int k = found - 1; k > rank; --k) sights[k] = sights[k - 1];
    sights[rank] = sight;
  }
  return found;
}

}  // namespace stg::agent
