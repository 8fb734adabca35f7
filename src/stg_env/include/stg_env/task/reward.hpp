#pragma once

#include "stg_agent/graph/observation.hpp"
#include "stg_env/task/judge_config.hpp"

/// The task's reward (Eqs. 28-36) and the release's two variants, on true
/// states. T is double or Pack.
namespace stg::task {

/// Terms of one AUV, each before its weight, and their weighted sum.
template <class T>
struct RewardTerms {
  T total = T(0.0), track = T(0.0), observation = T(0.0), coordination = T(0.0),
    communication = T(0.0), semantic = T(0.0), separation = T(0.0), cost = T(0.0);
};

/// What the reward reads of one AUV after a step.
template <class T>
struct RewardInput {
  T distance = T(0.0), previous_distance = T(0.0);
  T closing = T(0.0);     ///< [m/s]
  T confidence = T(0.0);  ///< c, 0 when lost
  T lost = T(0.0);        ///< l, 0 or 1
  T crowding = T(0.0);    ///< sum over neighbours of SeparationPenalty
  // Input of the cost: arrays of the caller. Only the arrays of the chosen kind are read.
  const T* tau = nullptr;  ///< release: tau / tau_max of this and the previous step [kWrenchSize]
  const T* previous_tau = nullptr;
  const T* action = nullptr;  ///< paper: executed action [action_size]
  const T* previous_action = nullptr;
};

/// b of Eq. 28 [m].
template <class T>
inline T BandDeviation(const RewardConfig& c, const T& d) {
  return Max(T(0.0), Max(T(c.band_m.lo) - d, d - T(c.band_m.hi)));
}

/// 1 at zero distance, 0 at and beyond the separation distance.
template <class T>
inline T SeparationPenalty(const RewardConfig& c, const T& separation) {
  return Clip(T(1.0) - separation * T(1.0 / c.separation_distance_m), T(0.0), T(1.0));
}

/// Coordination term (Eq. 32) from the swarm's mean band deviation; the raw
/// baselines use the mean tracking error instead.
template <class T>
inline T CoordinationReward(const RewardConfig& c, const T& mean_deviation) {
  return Clip(T(1.0) - mean_deviation * T(1.0 / c.error_max_m), T(0.0), T(1.0));
}

/// The release's communication term, a function of target distance.
template <class T>
inline T ReleaseCommunication(const T& mean_deviation, double sensing_range_m) {
  return Clip(T(1.0) - mean_deviation * T(1.0 / sensing_range_m), T(0.0), T(1.0));
}

/// cost of Eq. 35. The release averages over the six normalised forces; the
/// paper takes the squared norm of the executed action.
template <class T>
inline T ControlCost(const RewardConfig& c, int action_size, const RewardInput<T>& in) {
  T level(0.0), change(0.0);
  if (c.kind == RewardKind::kPaper) {
    for (int k = 0; k < action_size; ++k) {
      const T delta = in.action[k] - in.previous_action[k];
      level += in.action[k] * in.action[k];
      change += delta * delta;
    }
    return Clip(T(0.6) * level + T(0.4) * change, T(0.0), T(1.0));
  }
  for (int k = 0; k < dynamics::kWrenchSize; ++k) {
    const T delta = in.tau[k] - in.previous_tau[k];
    level += in.tau[k] * in.tau[k];
    change += delta * delta;
  }
  const bool raw = c.kind == RewardKind::kReleaseRaw;
  return Clip(T((raw ? 0.65 : 0.6) / 6.0) * level + T((raw ? 0.35 : 0.4) / 6.0) * change, T(0.0),
              T(1.0));
}

/// Reward of one AUV. Coordination and communication are the same for the whole swarm.
/// @param extra weighted sum of registered terms, added before the total is clipped; null: none
template <class T>
inline RewardTerms<T> Reward(const JudgeConfig& s, const RewardInput<T>& in, const T& coordination,
                             const T& communication, const T* extra = nullptr) {
  const RewardConfig& c = s.reward;
  const T zero(0.0), one(1.0);
  const T& d = in.distance;
  const T P = agent::Progress(s.agent.observation, in.previous_distance, d);
  const T C = agent::Closing(s.agent.observation, in.closing);
  const T U = Clip((T(c.band_m.lo) - d) * T(1.0 / c.band_m.lo), zero, one);
  const T b = BandDeviation(c, d);
  const auto lost = in.lost > T(0.5);
  const auto in_band = b <= T(1e-9);
  RewardTerms<T> r;
  if (c.kind == RewardKind::kReleaseRaw) {
    const T error = Abs(d - T(s.agent.task.desired_distance_m));
    const T score = one - Clip(error * T(1.0 / c.error_max_m), zero, one);
    r.track = Clip(T(0.45) * score + T(0.40) * P + T(0.15) * C, -one, one);
  } else {
    const T B = Clip(one - b * T(1.0 / c.error_max_m), zero, one);
    const T R = Select(lost, P, Select(in_band, zero, T(0.5) * Max(zero, P)));
    r.track = Clip(T(c.w_band) * B + T(c.w_progress) * P + T(c.w_closing) * C +
                       T(c.w_reacquire) * R - T(c.w_too_close) * U,
                   -one, one);
  }
  r.observation = Clip(in.confidence - in.lost, -one, one);
  r.coordination = coordination;
  r.communication = communication;
  // The paper's third case of Eq. 34 is the stable phase, the release's the band.
  T phase[4];
  agent::PhaseOneHot(s.agent.observation, in.lost, d, P, &phase);
  const auto holding = c.kind == RewardKind::kPaper ? phase[agent::kStable] > T(0.5) : in_band;
  const T seeking = T(0.65) * P + T(0.35) * C - T(0.25) * U;
  const T stable = T(0.55) * in.confidence + T(0.45) * (one - U);
  if (c.kind == RewardKind::kReleaseRaw) {
    const T near_target = T(0.5) * (in.confidence + Select(in_band, one, zero));
    r.semantic = Select(
        lost, P,
        Select(d <= T(s.agent.observation.near_range_m), near_target, T(0.70) * P + T(0.30) * C));
  } else {
    r.semantic = Select(lost, P, Select(holding, stable, seeking));
  }
  r.separation = -in.crowding;
  r.cost = ControlCost(c, s.world.control.action_size(), in);
  const RewardWeights& w = c.weights;
  r.total = T(w.tracking) * r.track + T(w.observation) * r.observation +
            T(w.coordination) * r.coordination + T(w.communication) * r.communication +
            T(w.semantic) * r.semantic + T(w.separation) * r.separation -
            T(w.control_cost) * r.cost;
  if (extra != nullptr) r.total += *extra;
  r.total = Clip(r.total, T(-c.total_limit), T(c.total_limit));
  return r;
}

}  // namespace stg::task
