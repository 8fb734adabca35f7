#pragma once

#include <vector>

#include "stg_env/task/estimate_totals.hpp"
#include "stg_env/task/judge_config.hpp"
#include "stg_env/task/metrics.hpp"
#include "stg_env/task/swarm_state.hpp"

namespace stg::task {

/// How evenly the AUVs of a target are distributed around it: one minus the length of the mean of
/// their bearings as unit vectors in the plane (the circular variance of N. I. Fisher, Statistical
/// analysis of circular data, 1993). 1: evenly, or balanced; 0: all on one side, or a single AUV.
template <class T>
T Spread(const SwarmState<T>& swarm, int target);

/// Squared error of an estimate, normalised by its covariance, r^T P^-1 r; 0 where P is not
/// positive definite.
/// @param covariance xx xy xz yy yz zz
template <class T>
T NormalisedSquare(const Vec3<T>& r, const T (&covariance)[6]);

/// Sums for SearchMetrics. Each lane counts its own decisions.
template <class T>
class SearchTotals {
 public:
  explicit SearchTotals(const JudgeConfig& scenario);

  void Start(const Mask<T>& lanes);
  /// Adds a decision. @param swarm with its field
  void Add(const SwarmState<T>& swarm, const std::vector<Tracking<T>>& tracking);
  /// Metrics of the episode up to now. @param steps decisions of this lane
  SearchMetrics Metrics(int lane, double steps) const;

 private:
  struct OfTarget {
    T detected = T(-1.0);          ///< decision of the first observation; -1: not yet
    T followed = T(0.0);           ///< decisions
    T way = T(0.0), net = T(0.0);  ///< in the whole windows up to now [m]
    Vec3<T> p_WT, p_window;        ///< at the last decision, and at the start of the window
    T window_way = T(0.0);
    double wanted = 2.0;  ///< AUVs that follow it
  };
  /// With task.assignment free.
  void AddChoices(const SwarmState<T>& swarm);
  void AddNearest(const SwarmState<T>& swarm);
  void AddSwaps(const SwarmState<T>& swarm, std::size_t i);
  T InBand(const Tracking<T>& k) const;
  void Follow(const Vec3<T>& p_WT, OfTarget* target) const;

  JudgeConfig scenario_;
  double window_;  // decisions
  T decisions_ = T(0.0), gathered_ = T(-1.0), info_spread_ = T(0.0);
  std::vector<OfTarget> targets_;
  // With task.assignment free.
  T switches_ = T(0.0), swaps_ = T(0.0), judged_ = T(0.0), ospa_ = T(0.0), gospa_ = T(0.0);
  T nearest_ = T(0.0), nearest_known_ = T(0.0);
  std::vector<T> chosen_;  // [agents] at the last decision
  /// [agents, targets], true target of an estimate when it was last good; -1: none. Empty with
  /// labelled detections.
  std::vector<T> of_;
};

/// Sums for FieldMetrics. Each lane counts its own decisions.
template <class T>
class FieldTotals {
 public:
  explicit FieldTotals(const JudgeConfig& scenario);

  void Start(const Mask<T>& lanes);
  /// Adds a decision.
  /// @param swarm with its field @param tracking [agents] @param tail lanes in their tail
  void Add(const SwarmState<T>& swarm, const std::vector<Tracking<T>>& tracking,
           const Mask<T>& tail);
  /// Metrics of the episode up to now. @param steps decisions of this lane
  FieldMetrics Metrics(int lane, double steps) const;

 private:
  struct Sums {
    T present = T(0.0), square = T(0.0), nees = T(0.0), judged = T(0.0), known = T(0.0),
      age = T(0.0), band = T(0.0), lost = T(0.0), losses = T(0.0), recovered = T(0.0),
      recovered_steps = T(0.0), spread = T(0.0), near_pairs = T(0.0), groundings = T(0.0),
      collisions = T(0.0), received = T(0.0), missed = T(0.0), modem_energy = T(0.0),
      propulsion = T(0.0), airtime = T(0.0), pings = T(0.0), ping_answers = T(0.0);
    T min_altitude = T(1e9), min_clearance = T(1e9);
  };

  JudgeConfig scenario_;
  Sums sums_;
  EstimateTotals<T> estimates_;
  SearchTotals<T> search_;
  NavigationTotals<T> navigation_;
  std::vector<T> spell_;               // [agents] decisions of the present spell of loss
  std::vector<T> band_;                // [agents] decisions in the band
  std::vector<T> there_;               // [agents] decisions in which the AUV was present
  std::vector<bool> turns_propeller_;  // [agents] whether tau contains the speed of a propeller
};

extern template class SearchTotals<double>;
extern template class SearchTotals<Pack>;
extern template class FieldTotals<double>;
extern template class FieldTotals<Pack>;

}  // namespace stg::task
