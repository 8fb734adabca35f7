#pragma once

#include "stg_agent/graph/neighbourhood.hpp"

/// What of its neighbours enters an AUV's knowledge: the nearest ones, and the means of Eq. 18.
namespace stg::agent {

/// The kNeighbourSlots nearest of the neighbours offered one by one, nearest first; of two at
/// the same distance the one offered first.
template <class T>
struct NearestSlots {
  Vec3<T> offset[kNeighbourSlots];  ///< zero where there is none
  T distance[kNeighbourSlots] = {T(1e9), T(1e9), T(1e9)};

  void Offer(Vec3<T> r, T d) {
    // Insertion into the sorted slots, one branch-free exchange each.
    if (!Any(d < distance[kNeighbourSlots - 1])) return;
    for (int slot = 0; slot < kNeighbourSlots; ++slot) {
      const auto closer = d < distance[slot];
      const T d_out = Select(closer, distance[slot], d);
      const Vec3<T> r_out = Select<T>(closer, offset[slot], r);
      distance[slot] = Select(closer, d, distance[slot]);
      offset[slot] = Select<T>(closer, r, offset[slot]);
      d = d_out;
      r = r_out;
    }
  }
};

/// Lets the neighbours into an agent's knowledge, in the order of their indices.
template <class T>
struct NeighbourView {
  NearestSlots<T> nearest;
  T count = T(0.0), effective = T(0.0), quality = T(0.0), best = T(0.0), error = T(0.0);
  T closest_sq = T(1e300);  ///< to the target [m^2]

  /// @param known where false the other parameters mean nothing
  /// @param p_WN position of the neighbour, p_WT of the target as this agent believes [m]
  /// @param tracking_error as the neighbour reports it [m]
  void Add(const ObservationConfig& c, const Mask<T>& known, const Vec3<T>& p_WN,
           const Vec3<T>& p_WT, const T& link_quality, const T& tracking_error) {
    const T zero(0.0), one(1.0);
    const T q = Select(known, link_quality, zero);
    count += Select(known, one, zero);
    effective += Select(known && (q > T(c.link_available)), one, zero);
    quality += q;
    best = Max(best, q);
    error += Select(known, tracking_error, zero);
    const Vec3<T> r = p_WT - p_WN;
    closest_sq = Min(closest_sq, Select(known, Dot(r, r), T(1e300)));
  }
};

/// What of an AUV's neighbours its knowledge takes, whoever put it together: an agent from what it
/// has heard (NeighbourView), or somebody who sees them all.
template <class T>
struct NeighbourSummary {
  Vec3<T> offset[kNeighbourSlots];  ///< as they are to be shown; zero where there is none
  T effective = T(0.0);             ///< number of effective neighbours
  T quality = T(0.0);               ///< sum of the link qualities
  T best = T(0.0);                  ///< largest link quality
  T mean_error = T(0.0);            ///< mean tracking error of the neighbours [m]
  T closest = T(0.0);               ///< 1: none of them is closer to the target, else 0
};

/// All neighbours that AUV `self` knows of, seen by one whose target is at p_WT [m].
/// @param sights [agents]
template <class T>
NeighbourView<T> SeeNeighbours(const AgentModel& s, int self,
                               const std::vector<NeighbourSight<T>>& sights, const Vec3<T>& p_WT) {
  const T half(0.5), nowhere(1e9);
  const bool nearest = s.observation.order == NeighbourOrder::kNearest;
  NeighbourView<T> view;
  int slot = 0;
  for (int j = 0; j < static_cast<int>(sights.size()); ++j) {
    if (j == self) continue;
    const NeighbourSight<T>& n = sights[static_cast<std::size_t>(j)];
    if (!n.heard()) {
      ++slot;
      continue;
    }
    const Mask<T> known = n.known > half;
    view.Add(s.observation, known, n.p_WN, p_WT, n.link_quality, n.tracking_error);
    if (nearest) {
      view.nearest.Offer(n.r_BN_W, Select(known, n.distance_m, nowhere));
    } else if (slot < kNeighbourSlots) {
      view.nearest.offset[slot++] = Select<T>(known, n.r_BN_W, Vec3<T>());
    }
  }
  return view;
}

}  // namespace stg::agent
