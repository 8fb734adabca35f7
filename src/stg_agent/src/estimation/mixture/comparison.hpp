#pragma once

#include <algorithm>
#include <cmath>

#include "snapshot.hpp"
#include "stg_agent/estimation/association.hpp"

namespace stg::agent {

/// The estimate of a target at the time of a look, for comparison with its detections.
class Comparison {
 public:
  /// @param state of the size that the states of Start have
  Comparison(const SightingModel& model, const Snapshot& state) : model_(model), state_(state) {}

  void Forget() { source_ = -1; }
  /// Whether it is for a detection of an AUV.
  bool IsOf(const dynamics::Detection& d, int source) const {
    return source_ == source && stamp_ == d.stamp;
  }

  /// Predicts a state to the time of the look. The state may contain looks of others at that time.
  void Start(const Snapshot& from, const dynamics::Detection& d, int source) {
    stamp_ = d.stamp;
    source_ = source;
    state_.mixture = from.mixture;
    state_.observers = from.observers;
    if (from.covers > d.stamp) state_.mixture.Clear();  // too late to compare
    if (state_.mixture.size() == 0) return;
    const double since_s = Seconds(d.stamp - from.stamp);
    model_.Predict(since_s, &state_.mixture);
    state_.observers.Predict(since_s, &state_.mixture);
    slot_ =
        state_.observers.Admit(source, d.stamp, d.p_WO_std_m, d.heading_std_rad, &state_.mixture);
  }

  DetectionFit Fit(const dynamics::Detection& d) const {
    DetectionFit fit;
    const GaussianMixture& mixture = state_.mixture;
    double density = 0.0;
    const int ways = d.ambiguous ? 2 : 1;
    for (int k = 0; k < mixture.size(); ++k) {
      for (int way = 0; way < ways; ++way) {
        const SightingFit of = model_.Fit(d, slot_, way == 1, mixture, k);
        fit.distance2 = std::min(fit.distance2, of.distance2);
        density += *mixture.at(k).weight * of.density / ways;
      }
    }
    const double share = model_.false_share();
    fit.gain = std::log((1.0 - share) / share * model_.ClutterVolume(d) * density);
    return fit;
  }

 private:
  SightingModel model_;
  Snapshot state_;
  TimeNs stamp_ = -1;
  int source_ = -1;  // whose detections they are; -1: none
  int slot_ = 0;     // block of that AUV's errors
};

}  // namespace stg::agent
