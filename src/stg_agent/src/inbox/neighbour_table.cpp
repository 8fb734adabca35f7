#include "stg_agent/inbox/neighbour_table.hpp"

#include <algorithm>

namespace stg::agent {

NeighbourTable::NeighbourTable(const AgentConfig& scenario, int self)
    : links_(acoustics::MakeLinkEstimator(scenario.channel)),
      max_age_s_(scenario.track.neighbour_max_age_s),
      half_extent_m_(scenario.workspace.half_extent_m),
      self_(self),
      slots_(static_cast<std::size_t>(scenario.agents)) {
  const std::size_t padded =
      static_cast<std::size_t>((scenario.agents + kLanes - 1) / kLanes * kLanes);
  known_.reserve(slots_.size());
  distance_.assign(padded, 0.0);
  age_.assign(padded, 0.0);
  quality_.assign(padded, 0.0);
}

void NeighbourTable::Clear() {
  for (const int id : known_) slots_[static_cast<std::size_t>(id)] = Neighbour();
  known_.clear();
  unread_ = false;
}

bool NeighbourTable::Update(const NeighbourState& state) {
  const int id = state.source;
  if (id == self_ || id < 0 || id >= static_cast<int>(slots_.size())) return false;
  Neighbour& n = slots_[static_cast<std::size_t>(id)];
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

void NeighbourTable::MarkRead() {
  for (const int id : known_) slots_[static_cast<std::size_t>(id)].unread_target = false;
  unread_ = false;
}

void NeighbourTable::Predict(TimeNs now, const Vec3<double>& p_WB) {
  std::size_t kept = 0;
  for (const int id : known_) {
    Neighbour& n = slots_[static_cast<std::size_t>(id)];
    n.age_s = Max(0.0, Seconds(now - n.state.generation));
    if (n.age_s > max_age_s_) {
      n = Neighbour();
      continue;
    }
    n.p_WN = DeadReckon(n.state.p_W, n.state.v_W, n.age_s, half_extent_m_);
    n.r_BN_W = n.p_WN - p_WB;
    n.distance_m = Norm(n.r_BN_W);
    distance_[kept] = n.distance_m;
    age_[kept] = n.age_s;
    known_[kept++] = id;
  }
  known_.resize(kept);
  // Whole packs at once: the exponentials cost as much for kLanes links as for one. Entries
  // past the last neighbour hold old numbers and are not read back.
  for (std::size_t k = 0; k < kept; k += static_cast<std::size_t>(kLanes)) {
    const Pack d = Pack::load_unaligned(&distance_[k]);
    const Pack age = Pack::load_unaligned(&age_[k]);
    links_->Quality(d, age).store_unaligned(&quality_[k]);
  }
  for (std::size_t k = 0; k < kept; ++k) {
    slots_[static_cast<std::size_t>(known_[k])].link_quality = quality_[k];
  }
}

int NeighbourTable::Nearest(int count, int* ids) const {
  int found = 0;
  for (const int id : known_) {
    const double d = at(id).distance_m;
    int rank = found;
    while (rank > 0 && d < at(ids[rank - 1]).distance_m) --rank;
    if (rank >= count) continue;
    if (found < count) ++found;
    for (int k = found - 1; k > rank; --k) ids[k] = ids[k - 1];
    ids[rank] = id;
  }
  return found;
}

}  // namespace stg::agent
