#pragma once

#include <vector>

#include "stg_agent/agent_config.hpp"
#include "stg_agent/packet/packet.hpp"

namespace stg::agent {

/// The newest packet of each neighbour of one AUV, as received. Fixed capacity (the swarm);
/// allocates nothing after construction.
///
/// The content depends on the set of packets received, not on their order: of each AUV the newest
/// generation stays.
class NeighbourTable {
 public:
  NeighbourTable(const AgentModel& model, int self);

  void Clear();

  /// Takes a packet's content. False, and nothing changes, for an own packet, a
  /// source outside the swarm, or a state no newer than the one known.
  bool Update(const NeighbourState& state);

  /// Forgets neighbours silent for more than track.neighbour_max_age_s at time `now`.
  void Forget(TimeNs now);

  /// Indices of the known neighbours, ascending.
  const std::vector<int>& known() const { return known_; }
  /// Any AUV of the swarm; false for oneself and for those not heard of.
  bool knows(int id) const { return slot(id).known; }
  /// Of an AUV that is known: its state, true at state.generation.
  const NeighbourState& state(int id) const { return slot(id).state; }

  /// Some neighbour's target estimate is unread.
  bool unread() const { return unread_; }
  /// The target estimate of this neighbour is unread.
  bool unread(int id) const { return slot(id).unread_target; }
  /// The track has taken all target estimates.
  void MarkRead();

 private:
  struct Slot {
    NeighbourState state;
    bool known = false;  ///< false: nothing else means anything
    bool unread_target = false;
  };
  const Slot& slot(int id) const { return slots_[static_cast<std::size_t>(id)]; }

  double max_age_s_;
  int self_;
  bool unread_ = false;
  std::vector<Slot> slots_;  // [agents]
  std::vector<int> known_;
};

}  // namespace stg::agent
