#include "stg_env/task/episode_totals.hpp"

#include <algorithm>
#include <cassert>

namespace stg::task {

template <class T>
EpisodeTotals<T>::EpisodeTotals(const JudgeConfig& s)
    : agents_(s.run.agents),
      action_size_(s.world.control.action_size()),
      episode_steps_(s.run.time.episode_steps),
      tail_steps_(s.run.time.tail_steps),
      decision_dt_s_(s.run.decision_dt_s()),
      band_m_(s.reward.band_m),
      field_(s),
      entered_(static_cast<std::size_t>(s.run.agents), T(-1.0)) {}

template <class T>
void EpisodeTotals<T>::Start(const Mask<T>& lanes, const T& episode_steps) {
  const T zero(0.0);
  const auto restart = [&](T* value, const T& first) { *value = Select(lanes, first, *value); };
  restart(&steps_, zero);
  restart(&counted_tail_, zero);
  restart(&length_, episode_steps);
  restart(&separation_, T(1e9));
  Sums& s = sums_;
  for (T* sum :
       {&s.episode_return, &s.norm, &s.saturated, &s.cost, &s.track, &s.observation,
        &s.coordination, &s.communication, &s.semantic, &s.crowding, &s.error, &s.lost, &s.pairs,
        &s.tail_distance, &s.tail_error, &s.tail_lost, &s.tail_band, &s.tail_pairs}) {
    restart(sum, zero);
  }
  for (T& entered : entered_) restart(&entered, T(-1.0));
  field_.Start(lanes);
}

template <class T>
void EpisodeTotals<T>::Add(const SwarmState<T>& swarm, const std::vector<Tracking<T>>& tracking,
                           const std::vector<RewardTerms<T>>& terms) {
  const T zero(0.0), one(1.0);
  Sums& s = sums_;
  steps_ += one;
  for (std::size_t i = 0; i < tracking.size(); ++i) {
    const Tracking<T>& k = tracking[i];
    const RewardTerms<T>& r = terms[i];
    s.episode_return += r.total;
    s.cost += r.cost;
    s.track += r.track;
    s.observation += r.observation;
    s.coordination += r.coordination;
    s.communication += r.communication;
    s.semantic += r.semantic;
    s.crowding += r.separation;
    T square = zero;
    for (const T& t : swarm.tau[i]) square += t * t;
    s.norm += Sqrt(square);
    for (int a = 0; a < action_size_; ++a) {
      const T& executed = swarm.action[i][static_cast<std::size_t>(a)];
      s.saturated += Select(Abs(executed) >= T(0.95), one, zero);
    }
    s.error += k.error;
    s.lost += k.lost;
    const auto within = k.distance <= T(band_m_.hi);
    entered_[i] = Select(within && (entered_[i] < zero), steps_, entered_[i]);
  }
  s.pairs += swarm.separations.colliding_pairs();
  separation_ = Min(separation_, swarm.separations.smallest());
  in_field_ = swarm.field != nullptr;
  const auto tail = steps_ > length_ - T(static_cast<double>(tail_steps_));
  if (in_field_) field_.Add(swarm, tracking, tail);
  if (Any(tail)) AddTail(tail, swarm, tracking);
}

template <class T>
void EpisodeTotals<T>::AddTail(const Mask<T>& tail, const SwarmState<T>& swarm,
                               const std::vector<Tracking<T>>& tracking) {
  const T zero(0.0), one(1.0);
  const auto add = [&](T* sum, const T& value) { *sum += Select(tail, value, zero); };
  add(&counted_tail_, one);
  for (const Tracking<T>& k : tracking) {
    add(&sums_.tail_distance, k.distance);
    add(&sums_.tail_error, k.error);
    add(&sums_.tail_lost, k.lost);
    const auto inside = (k.distance <= T(band_m_.hi)) && (k.distance >= T(band_m_.lo));
    add(&sums_.tail_band, Select(inside, one, zero));
  }
  add(&sums_.tail_pairs, swarm.separations.colliding_pairs());
}

template <class T>
EpisodeMetrics EpisodeTotals<T>::Metrics(int lane) const {
  const auto at = [lane](const T& value) { return Lane(value, lane); };
  const double n = static_cast<double>(agents_), steps = at(steps_);
  assert(steps > 0.0);
  const double tail_steps = std::max(1.0, at(counted_tail_));
  const double all = n * steps, tail = n * tail_steps;
  EpisodeMetrics m;
  m.steps = static_cast<int>(steps);
  m.episode_return = at(sums_.episode_return);
  m.tail_distance = at(sums_.tail_distance) / tail;
  m.tracking_error = at(sums_.tail_error) / tail;
  m.lost_rate = at(sums_.tail_lost) / tail;
  m.action_norm = at(sums_.norm) / all;
  m.saturation_rate = at(sums_.saturated) / (all * action_size_);
  m.control_cost = at(sums_.cost) / all;
  m.communication_quality = at(sums_.communication) / all;
  m.band_rate = at(sums_.tail_band) / tail;
  m.colliding_pairs = at(sums_.pairs) / steps;
  m.tail_colliding_pairs = at(sums_.tail_pairs) / tail_steps;
  m.min_separation = at(separation_);
  for (const T& entered : entered_) {
    const double step = at(entered) < 0.0 ? static_cast<double>(episode_steps_) : at(entered);
    m.time_to_band += step * decision_dt_s_ / n;
  }
  m.mean_error = at(sums_.error) / all;
  m.whole_lost_rate = at(sums_.lost) / all;
  m.reward_track = at(sums_.track) / all;
  m.reward_observation = at(sums_.observation) / all;
  m.reward_coordination = at(sums_.coordination) / all;
  m.reward_communication = at(sums_.communication) / all;
  m.reward_semantic = at(sums_.semantic) / all;
  m.reward_separation = at(sums_.crowding) / all;
  if (in_field_) m.field = field_.Metrics(lane, steps);
  return m;
}

template class EpisodeTotals<double>;
template class EpisodeTotals<Pack>;

}  // namespace stg::task
