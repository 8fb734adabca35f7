#pragma once

#include <algorithm>

#include "stg_agent/graph/knowledge.hpp"

/// The task's part of an observation, from an AUV's knowledge: the tracking diagnostics of Eq. 14,
/// phase and quality of Eqs. 15-16, and the task-graph summary of Eq. 18.
namespace stg::agent {

/// c of Eq. 13.
template <class T>
inline T Confidence(const T& distance, double sensing_range) {
  return Clip(T(1.0) - distance * T(1.0 / sensing_range), T(0.0), T(1.0));
}

/// d(t-1) - d(t) and closing speed, normalised to [-1, 1]: P and C of Eq. 30.
template <class T>
inline T Progress(const ObservationConfig& c, const T& previous, const T& distance) {
  return Clip((previous - distance) * T(1.0 / c.progress_scale_m), T(-1.0), T(1.0));
}
template <class T>
inline T Closing(const ObservationConfig& c, const T& closing_speed) {
  return Clip(closing_speed * T(1.0 / c.closing_scale_mps), T(-1.0), T(1.0));
}

/// Progress in the observation.
template <class T>
inline T ShownProgress(const ObservationConfig& c, const Knowledge<T>& k) {
  return c.release_bookkeeping ? T(0.0) : Progress(c, k.previous_distance, k.distance);
}

/// One-hot phase (Eq. 15): lost, else stable within the near range, else
/// approach when the distance fell, else search.
template <class T>
inline void PhaseOneHot(const ObservationConfig& c, const T& lost, const T& distance,
                        const T& progress, T (*phase)[kPhases]) {
  const T zero(0.0), one(1.0);
  const auto is_lost = lost > T(0.5);
  const auto near_target = distance <= T(c.near_range_m);
  const auto improving = progress > zero;
  (*phase)[kLost] = Select(is_lost, one, zero);
  (*phase)[kStable] = Select(is_lost, zero, Select(near_target, one, zero));
  const T rest = one - (*phase)[kLost] - (*phase)[kStable];
  (*phase)[kApproach] = Select(improving, rest, zero);
  (*phase)[kSearch] = rest - (*phase)[kApproach];
}

/// One-hot observation quality (Eq. 16) by thresholds on the confidence.
template <class T>
inline void QualityOneHot(const ObservationConfig& c, const T& confidence,
                          T (*quality)[kQualities]) {
  const T zero(0.0), one(1.0);
  const T high = Select(confidence >= T(c.quality_high), one, zero);
  const T medium = Select(confidence >= T(c.quality_medium), one, zero);
  const T low = Select(confidence > zero, one, zero);
  (*quality)[kHigh] = high;
  (*quality)[kMedium] = medium - high;
  (*quality)[kLow] = low - medium;
  (*quality)[kUnavailable] = one - low;
}

/// z_track of Eq. 14, normalised.
template <class T>
inline void TrackingVector(const ObservationConfig& c, const Knowledge<T>& k,
                           T (*z)[kTrackingNumbers]) {
  const T zero(0.0), one(1.0), two(2.0);
  (*z)[kZDistance] = Clip(k.distance * T(1.0 / c.distance_scale_m), zero, two);
  (*z)[kZError] = Clip(k.error * T(1.0 / c.error_scale_m), zero, two);
  (*z)[kZProgress] = ShownProgress(c, k);
  (*z)[kZClosing] = Closing(c, k.closing);
  (*z)[kZMeanError] = Clip(k.mean_error * T(1.0 / c.error_scale_m), zero, two);
  (*z)[kZConfidence] = k.confidence;
  (*z)[kZLost] = k.lost;
  (*z)[kZLostSteps] = Clip(k.lost_steps * T(1.0 / c.lost_scale_steps), zero, one);
}

/// Graph summary of Eq. 18 in the observation: effective-neighbour fraction,
/// mean and best link quality, mean neighbour error, advantage (Eq. 19), role. Numbers that an
/// ablation leaves out are 0.
template <class T>
inline void GraphSummary(const ObservationConfig& c, const Knowledge<T>& k,
                         T (*graph)[kGraphNumbers]) {
  const T zero(0.0), one(1.0);
  const T scale(1.0 / c.error_scale_m);
  const T neighbour_error = Clip(k.mean_neighbour_error * scale, zero, one);
  const T advantage = neighbour_error - Clip(k.error * scale, zero, one);  // in [-1, 1]
  const T confident = Select(k.confidence >= T(c.role_confidence), one, zero);
  (*graph)[kGraphEffective] = c.links ? k.effective_fraction : zero;
  (*graph)[kGraphMeanQuality] = c.links ? k.mean_quality : zero;
  (*graph)[kGraphBestQuality] = c.links ? k.best_quality : zero;
  (*graph)[kGraphNeighbourError] = neighbour_error;
  (*graph)[kGraphAdvantage] = c.roles ? advantage : zero;
  (*graph)[kGraphRole] = c.roles ? Select(advantage > zero, confident, zero) : zero;
}

/// Phase and quality of one AUV, as in the one-hot vectors.
inline int PhaseOf(const ObservationConfig& c, const Knowledge<double>& k) {
  double phase[kPhases];
  PhaseOneHot(c, k.lost, k.distance, ShownProgress(c, k), &phase);
  return static_cast<int>(std::max_element(phase, phase + kPhases) - phase);
}
inline int QualityOf(const ObservationConfig& c, const Knowledge<double>& k) {
  double quality[kQualities];
  QualityOneHot(c, k.confidence, &quality);
  return static_cast<int>(std::max_element(quality, quality + kQualities) - quality);
}

}  // namespace stg::agent
