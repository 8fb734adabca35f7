#include "stg_agent/graph/neighbour_table.hpp"

#include <algorithm>

namespace stg::agent {

NeighbourTable::NeighbourTable(const AgentModel& model, int self)
    : max_age_s_(model.track.neighbour_max_age_s),
      self_(self),
      slots_(static_cast<std::size_t>(model.run.agents)) {
  known_.reserve(slots_.size());
}

void NeighbourTable::Clear() {
  for (const int id : known_) slots_[static_cast<std::size_t>(id)] = Slot();
  known_.clear();
  unread_ = false;
}

bool NeighbourTable::Update(const NeighbourState& state) {
  const int id = state.source;
  if (id == self_ || id < 0 || id >= static_cast<int>(slots_.size())) return false;
  Slot& n = slots_[static_cast<std::size_t>(id)];
  if (n.known && state.generation <= n.state.generation) return false;
  if (!n.known) {
    n.known = true;
    known_.insert(std::lower_bound(known_.begin(), known_.end(), id), id);
  }
  n.state = state;
  n.unread_target = state.has_target;
  unread_ = unread_ || state.has_target;
  return true;
}

void NeighbourTable::Forget(TimeNs now) {
  std::size_t kept = 0;
  for (const int id : known_) {
    Slot& n = slots_[static_cast<std::size_t>(id)];
    if (Seconds(now - n.state.generation) > max_age_s_) {
      n = Slot();
    } else {
      known_[kept++] = id;
    }
  }
  known_.resize(kept);
}

}  // namespace stg::agent
