#pragma once

#include <memory>
#include <vector>

#include "acoustic_channel/link/link_estimator.hpp"
#include "auv_dynamics/measurements.hpp"
#include "stg_agent/agent/agent_config.hpp"
#include "stg_agent/packet/packet.hpp"

namespace stg::agent {

/// Dead reckoning p + v age inside the walls [m].
template <class T>
Vec3<T> DeadReckon(const Vec3<T>& p_W, const Vec3<T>& v_W, const T& age_s, double half_extent_m) {
  return Clip(p_W + v_W * age_s, -half_extent_m, half_extent_m);
}

/// What one AUV knows of another: its newest packet, carried forward to now.
struct Neighbour {
  NeighbourState state;        ///< as received; true at state.generation
  bool known = false;          ///< false: nothing below or above means anything
  bool unread_target = false;  ///< state has a target estimate that the track has not taken yet
  double age_s = 0.0;          ///< now minus state.generation, not negative
  Vec3<double> p_WN;           ///< dead-reckoned position p + v age, inside the walls [m]
  Vec3<double> r_BN_W;         ///< p_WN minus own position [m]
  double distance_m = 0.0;     ///< length of r_BN_W
  double link_quality = 0.0;   ///< the channel's estimate at distance and age
};

/// The neighbours of one AUV, fed by received packets only. Fixed capacity (the
/// swarm); allocates nothing after construction.
///
/// The content depends on the set of packets received, not on their order: of each
/// AUV the newest generation stays.
class NeighbourTable {
 public:
  NeighbourTable(const AgentConfig& scenario, int self);

  void Clear();

  /// Takes a packet's content. False, and nothing changes, for an own packet, a
  /// source outside the swarm, or a state no newer than the one known.
  bool Update(const NeighbourState& state);

  /// Forgets neighbours silent for more than track.neighbour_max_age_s, and carries
  /// the others to time `now`, seen from own position p_WB [m].
  void Predict(TimeNs now, const Vec3<double>& p_WB);

  /// Indices of the known neighbours, ascending.
  const std::vector<int>& known() const { return known_; }
  /// Any AUV of the swarm; `known` is false for oneself and for those not heard of.
  const Neighbour& at(int id) const { return slots_[static_cast<std::size_t>(id)]; }

  /// Writes the indices of the `count` known neighbours nearest to this AUV, nearest
  /// first (ties: lower index first); returns how many there were.
  int Nearest(int count, int* ids) const;

  /// What the links to the neighbours are worth.
  const acoustics::LinkEstimator& links() const { return *links_; }

  /// Some neighbour's target estimate is unread.
  bool unread() const { return unread_; }
  /// The track has taken all target estimates.
  void MarkRead();

 private:
  std::shared_ptr<const acoustics::LinkEstimator> links_;
  double max_age_s_;
  double half_extent_m_;
  int self_;
  bool unread_ = false;
  std::vector<Neighbour> slots_;  // [agents]
  std::vector<int> known_;
  std::vector<double> distance_, age_, quality_;  // of known_, padded to whole packs
};

}  // namespace stg::agent
