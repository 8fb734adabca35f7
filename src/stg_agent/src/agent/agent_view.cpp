#include "stg_agent/agent/agent_view.hpp"

namespace stg::agent {

NearestSights AgentView::Nearest(int most) const {
  NearestSights nearest;
  for (const int id : neighbours().known()) {
    const NeighbourSight<double> sight = sights_.at(id);
    int rank = nearest.size();
    while (rank > 0 && sight.distance_m < nearest[rank - 1].distance_m) --rank;
    if (rank >= most) continue;
    if (nearest.size() == most) nearest.pop_back();
    nearest.insert(rank, sight);
  }
  return nearest;
}

}  // namespace stg::agent
