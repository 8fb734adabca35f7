#include "env_internal.hpp"

namespace stg::env {

EnvGroup::Totals::Totals(const Scenario& scenario)
    : scenario_(scenario), entered_(static_cast<size_t>(scenario.agents)) {
  Clear();
}

void EnvGroup::Totals::Clear() {
  steps_ = tail_steps_ = 0;
  for (Pack* p : {&return_, &distance_, &tail_error_, &tail_lost_, &norm_, &saturated_, &cost_,
                  &comm_, &band_, &pairs_, &tail_pairs_, &error_, &lost_, &track_, &observation_,
                  &coordination_, &semantic_, &crowding_}) {
    *p = Pack(0.0);
  }
  separation_ = Pack(1e9);
  for (Pack& p : entered_) p = Pack(-1.0);
}

void EnvGroup::Totals::Add(const EnvGroup& env, bool tail) {
  const Pack zero(0.0), one(1.0);
  const task::RewardConfig& c = scenario_.reward;
  ++steps_;
  if (tail) ++tail_steps_;
  const int size = scenario_.action_size();
  for (size_t i = 0; i < env.truth_.size(); ++i) {
    const agent::Knowledge<Pack>& k = env.truth_[i];
    const task::RewardTerms<Pack>& r = env.terms_[i];
    return_ += r.total;
    cost_ += r.cost;
    track_ += r.track;
    observation_ += r.observation;
    coordination_ += r.coordination;
    comm_ += r.communication;
    semantic_ += r.semantic;
    crowding_ += r.separation;
    Pack square = zero;
    for (const Pack& t : env.tau_[i]) square += t * t;
    norm_ += Sqrt(square);
    for (int a = 0; a < size; ++a) {
      saturated_ += Select(Abs(env.action_[i][static_cast<size_t>(a)]) >= Pack(0.95), one, zero);
    }
    error_ += k.error;
    lost_ += k.lost;
    const auto within = k.distance <= Pack(c.band_m.hi);
    if (tail) {
      distance_ += k.distance;
      tail_error_ += k.error;
      tail_lost_ += k.lost;
      band_ += Select(within, Select(k.distance >= Pack(c.band_m.lo), one, zero), zero);
    }
    entered_[i] = Select(within && (entered_[i] < zero), Pack(steps_), entered_[i]);
  }
  pairs_ += env.world_.colliding_pairs();
  if (tail) tail_pairs_ += env.world_.colliding_pairs();
  separation_ = Min(separation_, env.world_.smallest_separation());
}

task::EpisodeMetrics EnvGroup::Totals::Metrics(int lane) const {
  const double n = static_cast<double>(entered_.size());
  const double all = n * steps_, tail = n * std::max(1, tail_steps_);
  const auto at = [lane](const Pack& p) { return Lane(p, lane); };
  task::EpisodeMetrics m;
  m.steps = steps_;
  m.episode_return = at(return_);
  m.tail_distance = at(distance_) / tail;
  m.tracking_error = at(tail_error_) / tail;
  m.lost_rate = at(tail_lost_) / tail;
  m.action_norm = at(norm_) / all;
  m.saturation_rate = at(saturated_) / (all * scenario_.action_size());
  m.control_cost = at(cost_) / all;
  m.communication_quality = at(comm_) / all;
  m.band_rate = at(band_) / tail;
  m.colliding_pairs = at(pairs_) / steps_;
  m.tail_colliding_pairs = at(tail_pairs_) / std::max(1, tail_steps_);
  m.min_separation = at(separation_);
  for (const Pack& p : entered_) {
    const double step = at(p) < 0.0 ? static_cast<double>(scenario_.time.episode_steps) : at(p);
    m.time_to_band += step * scenario_.decision_dt_s() / n;
  }
  m.mean_error = at(error_) / all;
  m.whole_lost_rate = at(lost_) / all;
  m.reward_track = at(track_) / all;
  m.reward_observation = at(observation_) / all;
  m.reward_coordination = at(coordination_) / all;
  m.reward_communication = at(comm_) / all;
  m.reward_semantic = at(semantic_) / all;
  m.reward_separation = at(crowding_) / all;
  return m;
}

}  // namespace stg::env
