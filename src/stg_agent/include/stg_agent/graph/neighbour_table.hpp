#pragma once

#include <vector>

#include "stg_agent/agent_config.hpp"
#include "stg_agent/packet/packet.hpp"

namespace stg::agent {

/// The newest received packet of each neighbour of one AUV. Fixed capacity (the swarm); allocates
/// nothing after construction.
///
/// The content depends on the set of packets received, not on their order: the packet with the
/// newest generation time of each AUV is kept.
class NeighbourTable {
 public:
  NeighbourTable(const AgentModel& model, int self);

  void Clear();

  /// Takes a packet's content. Returns false, without a change, for an own packet, a source outside
  /// the swarm, or a state that is not newer than the stored one.
  bool Update(const NeighbourState& state);

  /// Forgets neighbours silent for more than track.neighbour_max_age_s at time `now`.
  void Forget(TimeNs now);

  /// Indices of the known neighbours, ascending.
  const std::vector<int>& known() const { return known_; }
  /// Whether an AUV of the swarm is known; false for this AUV itself.
  bool knows(int id) const { return slot(id).known; }
  /// State of a known AUV at the time state.generation.
  const NeighbourState& state(int id) const { return slot(id).state; }

  /// Whether a target estimate of any neighbour is unread.
  bool unread() const { return unread_; }
  /// Whether the target estimate of this neighbour is unread.
  bool unread(int id) const { return slot(id).unread_target; }
  /// Marks all target estimates as read.
  void MarkRead() {
    if (!unread_) return;
    for (const int id : known_) slots_[static_cast<std::size_t>(id)].unread_target = false;
    unread_ = false;
  }

 private:
  struct Slot {
    NeighbourState state;
    bool known = false;  ///< false: the other fields have no meaning
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
