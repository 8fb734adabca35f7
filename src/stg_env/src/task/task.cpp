#include "stg_env/task/task.hpp"

#include <algorithm>

#include "stg_env/task/estimate_totals.hpp"

namespace stg::task {

template <class T>
Task<T>::Task(const JudgeConfig& scenario)
    : scenario_(scenario),
      tracking_(static_cast<std::size_t>(scenario.run.agents)),
      followed_(tracking_.size(), T(-1.0)),
      terms_(tracking_.size()),
      totals_(scenario) {
  Effort<T> zero;
  zero.fill(T(0.0));
  previous_tau_.assign(tracking_.size(), zero);
  previous_action_ = previous_tau_;
  for (const auto& [name, weight] : scenario_.reward.terms) {
    if (weight != 0.0)
      extra_.push_back(
          {weight, RewardTermsByName().Make(name, scenario_.reward.term_options, scenario_)});
  }
}

template <class T>
void Task<T>::Start(const Mask<T>& lanes, const SwarmState<T>& swarm, const T& episode_steps) {
  Measure(swarm, &lanes);
  Remember(swarm);
  totals_.Start(lanes, episode_steps);
}

template <class T>
void Task<T>::Step(const SwarmState<T>& swarm) {
  Measure(swarm, nullptr);
  T coordination(0.0), communication(0.0), team(0.0), there(0.0);
  ShareReward(swarm, &coordination, &communication);
  for (int i = 0; i < scenario_.run.agents; ++i) {
    const auto u = static_cast<std::size_t>(i);
    T extra(0.0);
    for (const Weighted& e : extra_) {
      const TermInput<T> in{swarm, i, tracking_[u], previous_tau_[u], previous_action_[u]};
      extra += T(e.weight) * e.term->Evaluate(in);
    }
    terms_[u] = Reward(scenario_, InputOf(swarm, i), coordination, communication,
                       extra_.empty() ? nullptr : &extra);
    if (scenario_.agent.fleet.changes()) {
      const T& present = (*swarm.field)[u].present;
      terms_[u].total = Select(present > T(0.5), terms_[u].total, T(0.0));
      there += present;
    }
    team += terms_[u].total;
  }
  team_reward_ = scenario_.agent.fleet.changes() ? team / Max(there, T(1.0))
                                                 : team * T(1.0 / scenario_.run.agents);
  totals_.Add(swarm, tracking_, terms_);
  Remember(swarm);
}

template <class T>
void Task<T>::Remember(const SwarmState<T>& swarm) {
  // The paper's cost depends on actions, the release's cost on forces. A registered term may need
  // either.
  const bool paper = scenario_.reward.kind == RewardKind::kPaper;
  const bool actions = paper || !extra_.empty(), forces = !paper || !extra_.empty();
  for (std::size_t i = 0; i < tracking_.size(); ++i) {
    if (actions) previous_action_[i] = swarm.action[i];
    if (forces) previous_tau_[i] = swarm.tau[i];
  }
}

template <class T>
void Task<T>::Measure(const SwarmState<T>& swarm, const Mask<T>* starting) {
  const T zero(0.0), one(1.0);
  for (std::size_t i = 0; i < tracking_.size(); ++i) {
    const dynamics::VehicleState<T>& v = swarm.vehicles[i];
    const dynamics::TargetState<T>& t = swarm.target_of(i);
    Tracking<T>& k = tracking_[i];
    T before = k.distance;
    k.Measure(t.p_WT - v.p_WB, v.v_WB - t.v_WT, scenario_.agent.task.desired_distance_m);
    const T d = k.distance;
    if (swarm.following != nullptr) {
      // If the target changed, the previous distance is the present distance to the new target.
      const T& target = swarm.following->target[i];
      before = Select(target == followed_[i], before, d);
      k.previous_distance = Select(target == followed_[i], k.previous_distance, d);
      followed_[i] = target;
    }
    k.previous_distance = starting != nullptr ? Select(*starting, d, k.previous_distance) : before;
    k.confidence = agent::Confidence(d, scenario_.world.sensing.range_m);
    k.lost = Select(d > T(scenario_.agent.task.lost_distance_m), one, zero);
    if (swarm.field != nullptr) {
      k.lost = Max(k.lost, OffInOwnFrame(scenario_.agent.task, (*swarm.field)[i], k.r_BT_W));
    }
  }
}

template <class T>
void Task<T>::ShareReward(const SwarmState<T>& swarm, T* coordination, T* communication) const {
  const RewardConfig& c = scenario_.reward;
  T deviation(0.0);
  for (const Tracking<T>& k : tracking_) {
    deviation += c.kind == RewardKind::kReleaseRaw ? k.error : BandDeviation(c, k.distance);
  }
  deviation = deviation * T(1.0 / scenario_.run.agents);
  *coordination = CoordinationReward(c, deviation);
  *communication = c.kind == RewardKind::kPaper
                       ? swarm.link_quality
                       : ReleaseCommunication(deviation, scenario_.world.sensing.range_m);
}

template <class T>
RewardInput<T> Task<T>::InputOf(const SwarmState<T>& swarm, int i) const {
  const auto u = static_cast<std::size_t>(i);
  const Tracking<T>& k = tracking_[u];
  RewardInput<T> in;
  in.distance = k.distance;
  in.previous_distance = k.previous_distance;
  if (scenario_.agent.observation.release_bookkeeping) {
    const auto first = totals_.steps() < T(0.5);  // the release has no d(t-1) in the first step
    in.previous_distance = Select(first, k.distance, k.previous_distance);
  }
  in.closing = k.closing;
  in.confidence = k.confidence;
  in.lost = k.lost;
  if (scenario_.reward.weights.separation != 0.0) {
    for (int j = 0; j < scenario_.run.agents; ++j) {
      if (j == i) continue;
      in.crowding += SeparationPenalty(scenario_.reward, swarm.separations.distance(i, j));
    }
  }
  if (scenario_.reward.kind == RewardKind::kPaper) {
    in.action = swarm.action[u].data();
    in.previous_action = previous_action_[u].data();
  } else {
    in.tau = swarm.tau[u].data();
    in.previous_tau = previous_tau_[u].data();
  }
  return in;
}

template class Task<double>;
template class Task<Pack>;

}  // namespace stg::task
