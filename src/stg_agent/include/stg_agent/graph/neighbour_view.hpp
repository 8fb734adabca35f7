#pragma once

#include "stg_agent/graph/neighbourhood.hpp"

/// The part of an AUV's knowledge about its neighbours: the nearest ones, and the means of Eq. 18.
namespace stg::agent {

/// The kNeighbourSlots nearest of the offered neighbours, nearest first; at equal distances, the
/// one that was offered first comes first.
template <class T>
struct NearestSlots {
  Vec3<T> offset[kNeighbourSlots];  ///< zero if there is none
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

/// An AUV's neighbours, from received packets (SeeNeighbours) or from true states (truth mode).
template <class T>
struct NeighbourView {
  Vec3<T> offset[kNeighbourSlots];  ///< in the order of the observation; zero if there is none
  T effective = T(0.0);             ///< number of effective neighbours
  T quality = T(0.0);               ///< sum of the link qualities
  T best = T(0.0);                  ///< largest link quality
  T mean_error = T(0.0);            ///< mean tracking error of the neighbours [m]
  T closest = T(0.0);               ///< 1: none of them is closer to the target, else 0
};

/// The view of the known neighbours of AUV `self`, whose target is at p_WT [m], in the order of
/// their indices.
/// @param sights [agents]
/// @param own tracking of the AUV itself; its error is the mean error if no neighbour is known
template <class T>
NeighbourView<T> SeeNeighbours(const AgentModel& s, int self,
                               const std::vector<NeighbourSight<T>>& sights, const Vec3<T>& p_WT,
                               const Tracking<T>& own) {
  const T half(0.5), nowhere(1e9), zero(0.0), one(1.0), farthest(1e300);
  const bool by_distance = s.observation.order == NeighbourOrder::kNearest;
  NeighbourView<T> view;
  NearestSlots<T> nearest;
  T count = zero, error = zero, closest_sq = farthest;  // closest_sq: to the target [m^2]
  int slot = 0;
  for (int j = 0; j < static_cast<int>(sights.size()); ++j) {
    if (j == self) continue;
    const NeighbourSight<T>& n = sights[static_cast<std::size_t>(j)];
    if (!n.heard()) {
      ++slot;
      continue;
    }
    const Mask<T> known = n.known > half;
    const T q = Select(known, n.link_quality, zero);
    count += Select(known, one, zero);
    view.effective += Select(known && (q > T(s.observation.link_available)), one, zero);
    view.quality += q;
    view.best = Max(view.best, q);
    error += Select(known, n.tracking_error, zero);
    const Vec3<T> r_NT_W = p_WT - n.p_WN;
    closest_sq = Min(closest_sq, Select(known, Dot(r_NT_W, r_NT_W), farthest));
    if (by_distance) {
      nearest.Offer(n.r_BN_W, Select(known, n.distance_m, nowhere));
    } else if (slot < kNeighbourSlots) {
      nearest.offset[slot++] = Select<T>(known, n.r_BN_W, Vec3<T>());
    }
  }
  for (int k = 0; k < kNeighbourSlots; ++k) view.offset[k] = nearest.offset[k];
  view.mean_error = Select(count > zero, error / Max(count, one), own.error);
  view.closest = Select(Dot(own.r_BT_W, own.r_BT_W) <= closest_sq, one, zero);
  return view;
}

}  // namespace stg::agent
