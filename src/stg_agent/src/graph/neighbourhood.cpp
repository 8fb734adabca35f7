#include "stg_agent/graph/neighbourhood.hpp"

#include <type_traits>

namespace stg::agent {

template <class T>
Neighbourhood<T>::Neighbourhood(const AgentModel& model, int self)
    : max_age_s_(model.track.neighbour_max_age_s),
      wall_m_(model.wall_m()),
      sights_(static_cast<std::size_t>(model.run.agents)) {
  // Constructed one by one, because a copy would not have the table's reserved memory.
  tables_.reserve(static_cast<std::size_t>(kLanesOf<T>));
  for (int lane = 0; lane < kLanesOf<T>; ++lane) tables_.emplace_back(model, self);
  const int padded = (model.run.agents + kLanes - 1) / kLanes * kLanes;
  for (auto* v : {&distance_, &age_, &learnt_, &quality_})
    v->assign(static_cast<std::size_t>(padded), 0.0);
}

template <class T>
void Neighbourhood<T>::Clear(int lane) {
  tables_[static_cast<std::size_t>(lane)].Clear();
  for (NeighbourSight<T>& n : sights_) SetLaneOf(&n, lane, NeighbourSight<double>());
}

template <class T>
bool Neighbourhood<T>::Update(int lane, const NeighbourState& state) {
  if (!tables_[static_cast<std::size_t>(lane)].Update(state)) return false;
  NeighbourSight<T>& n = sights_[static_cast<std::size_t>(state.source)];
  SetLane(&n.known, lane, 1.0);
  SetLane(&n.p_W, lane, state.p_W);
  SetLane(&n.v_W, lane, state.v_W);
  SetLane(&n.generation_ns, lane, static_cast<double>(state.generation));
  SetLane(&n.tracking_error, lane, state.tracking_error);
  return true;
}

template <class T>
void Neighbourhood<T>::Forget(int lane, TimeNs now) {
  NeighbourTable& table = tables_[static_cast<std::size_t>(lane)];
  table.Forget(now);
  for (std::size_t j = 0; j < sights_.size(); ++j) {
    if (!table.knows(static_cast<int>(j))) {
      SetLaneOf(&sights_[j], lane, NeighbourSight<double>());
    }
  }
}

template <class T>
Mask<T> Neighbourhood<T>::Age(const T& now_ns) {
  const T zero(0.0), half(0.5), oldest(max_age_s_);
  Mask<T> past = half < zero;
  for (NeighbourSight<T>& n : sights_) {
    if (!n.heard()) continue;
    // Whole nanoseconds below 2^53 are exact.
    n.age_s = Max((now_ns - n.generation_ns) * T(1e-9), zero);
    past = past || ((n.age_s > oldest) && (n.known > half));
  }
  return past;
}

template <class T>
void Neighbourhood<T>::Predict(const Vec3<T>& p_WB, const acoustics::LinkEstimator& links) {
  for (NeighbourSight<T>& n : sights_) {
    if (!n.heard()) continue;
    n.p_WN = DeadReckon(n.p_W, n.v_W, n.age_s, wall_m_);
    n.r_BN_W = n.p_WN - p_WB;
    n.distance_m = Norm(n.r_BN_W);
  }
  if constexpr (std::is_same_v<T, Pack>) {
    for (std::size_t j = 0; j < sights_.size(); ++j) {
      NeighbourSight<T>& n = sights_[j];
      if (!n.heard()) continue;
      const Pack learnt = Pack::load_unaligned(links.Learnt(static_cast<int>(j)));
      n.link_quality = links.Quality(n.distance_m, n.age_s, learnt);
    }
  } else {
    // Whole packs at once, because the exponentials cost as much for kLanes links as for one.
    // Entries after the last neighbour contain old numbers and are not used.
    std::size_t heard = 0;
    for (std::size_t j = 0; j < sights_.size(); ++j) {
      const NeighbourSight<T>& n = sights_[j];
      if (!n.heard()) continue;
      distance_[heard] = n.distance_m;
      learnt_[heard] = *links.Learnt(static_cast<int>(j));
      age_[heard++] = n.age_s;
    }
    for (std::size_t k = 0; k < heard; k += static_cast<std::size_t>(kLanes)) {
      const Pack d = Pack::load_unaligned(&distance_[k]);
      const Pack age = Pack::load_unaligned(&age_[k]);
      const Pack learnt = Pack::load_unaligned(&learnt_[k]);
      links.Quality(d, age, learnt).store_unaligned(&quality_[k]);
    }
    heard = 0;
    for (NeighbourSight<T>& n : sights_) {
      if (n.heard()) n.link_quality = quality_[heard++];
    }
  }
}

template <class T>
void Neighbourhood<T>::KeepOthers(const Mask<T>& lanes, const Sights& before) {
  for (std::size_t j = 0; j < sights_.size(); ++j) {
    stg::KeepOthers(lanes, before[j], &sights_[j]);
  }
}

template class Neighbourhood<double>;
template class Neighbourhood<Pack>;

}  // namespace stg::agent
