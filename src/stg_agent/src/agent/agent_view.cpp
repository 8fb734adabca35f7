#include "stg_agent/agent/agent_view.hpp"

#include <cassert>

namespace stg::agent {

NearestSights AgentView::Nearest(int most) const {
  assert(0 < most && most <= kNearestKnown);
  // Sorts indices, because a sight has many numbers.
  struct Known {
    double distance_m;
    int id;
  };
  Known ranked[kNearestKnown];
  int count = 0;
  for (const int id : neighbours().known()) {
    const double distance_m = sights_.distance_m(id);
    if (count == most && !(distance_m < ranked[most - 1].distance_m)) continue;
    int rank = count < most ? count++ : most - 1;
    for (; rank > 0 && distance_m < ranked[rank - 1].distance_m; --rank) {
      ranked[rank] = ranked[rank - 1];
    }
    ranked[rank] = {distance_m, id};
  }
  NearestSights nearest;
  for (int k = 0; k < count; ++k) nearest.push_back(sights_.at(ranked[k].id));
  return nearest;
}

}  // namespace stg::agent
