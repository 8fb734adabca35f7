#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "stg_env/task/estimate_metrics.hpp"
#include "stg_env/task/judge_config.hpp"
#include "stg_env/task/swarm_state.hpp"

namespace stg::task {

/// 1 where the AUV has no estimate of its target, or an estimate with an error above
/// task.lost_error_m: the error of the vector from the AUV to the target, or of the position in the
/// world. Always 0 when that key is 0.
template <class T>
T OffInOwnFrame(const agent::TaskConfig& task, const FieldState<T>& field, const Vec3<T>& r_BT_W);
template <class T>
T OffInWorld(const agent::TaskConfig& task, const FieldState<T>& field, const Vec3<T>& p_WT);

/// Sums for EstimateMetrics. Each lane counts its own decisions.
template <class T>
class EstimateTotals {
 public:
  explicit EstimateTotals(const JudgeConfig& scenario);

  void Start(const Mask<T>& lanes);
  /// Adds a decision. @param swarm with its field @param tail lanes in the tail of their episode
  void Add(const SwarmState<T>& swarm, const std::vector<Tracking<T>>& tracking,
           const Mask<T>& tail);
  /// Metrics of the episode up to now.
  EstimateMetrics Metrics(int lane) const;

 private:
  static constexpr int kBins = 330;
  using Histogram = std::array<std::uint32_t, kBins>;
  struct Sums {
    T present = T(0.0), known = T(0.0), known_tail = T(0.0), own = T(0.0), own_tail = T(0.0),
      world = T(0.0), world_tail = T(0.0), vertical = T(0.0), lost_in_world = T(0.0);
  };
  void Count(int lane, double own_m, double world_m);

  JudgeConfig scenario_;
  Sums sums_;
  std::vector<Histogram> own_, world_;  // [lanes]
};

extern template class EstimateTotals<double>;
extern template class EstimateTotals<Pack>;

/// Sums for NavigationMetrics. Each lane counts its own decisions.
template <class T>
class NavigationTotals {
 public:
  void Start(const Mask<T>& lanes);
  /// Adds a decision. @param tail lanes in the tail of their episode
  void Add(const SwarmState<T>& swarm, const Mask<T>& tail);
  /// Metrics of the episode up to now; empty without a localizer.
  std::optional<NavigationMetrics> Metrics(int lane) const;

 private:
  struct Sums {
    T located = T(0.0), square = T(0.0), tail = T(0.0), in_tail = T(0.0), nees = T(0.0),
      relative = T(0.0), surfacing = T(0.0), before_fix = T(0.0), fixings = T(0.0);
  };

  Sums sums_;
  T fixes_ = T(-1.0);         // of all AUVs up to now; below 0: they never go up for one
  T newest_square_ = T(0.0);  // mean over the AUVs at the last decision
};

extern template class NavigationTotals<double>;
extern template class NavigationTotals<Pack>;

}  // namespace stg::task
