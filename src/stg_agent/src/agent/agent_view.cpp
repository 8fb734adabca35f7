#include "stg_agent/agent/agent_view.hpp"

namespace stg::agent {

NearestSights AgentView::Nearest(int most) const {
  // Sorts indices, because a sight has many numbers.
  struct Known {
    double distance_m;
    int id;
  };
  ShortList<Known, kNearestKnown> ranked;
  for (const int id : neighbours().known()) {
    const double distance_m = sights_.distance_m(id);
    int rank = ranked.size();
    while (rank > 0 && distance_m < ranked[rank - 1].distance_m) --rank;
    if (rank >= most) continue;
    if (ranked.size() == most) ranked.pop_back();
    ranked.insert(rank, {distance_m, id});
  }
  NearestSights nearest;
  for (const Known& known : ranked) nearest.push_back(sights_.at(known.id));
  return nearest;
}

}  // namespace stg::agent
