#pragma once

#include <array>

#include "auv_dynamics/measurements.hpp"
#include "stg_agent/agent_config.hpp"

/// Where a target may be that no AUV sees.
namespace stg::agent {

/// Probability of the target's place in the plane, in 32 x 32 cells around its datum, or over the
/// workspace where that is smaller: Bayes'
/// filter on a grid (Bourgault et al. 2003). A look that finds nothing takes from the cells in its
/// reach what it would have found there; a detection weighs all cells; time spreads them. World
/// axes. Allocates nothing.
///
/// The target is taken for a walker without memory: in a time t it spreads by 2 s^2 m t, with
/// s = track.measurements.velocity_std_mps and m = velocity_memory_s, and it stays inside the
/// workspace.
class SearchMap {
 public:
  static constexpr int kSide = 32;
  static constexpr int kCells = kSide * kSide;

  explicit SearchMap(const AgentModel& model);

  /// A Gaussian around a datum of time 0.
  void Start(const dynamics::Cue& cue);
  /// Spreads it until `now`, in steps of kStep_s.
  void Advance(TimeNs now);
  /// An observer at p_WO looked and found nothing.
  void LookInVain(const Vec3<double>& p_WO);
  /// Somebody found the target: by a range, or where it measured it to be. A bearing alone changes
  /// nothing.
  void Find(const dynamics::Detection& detection);

  /// Middle of the map and of a cell [m].
  double x(int column) const { return x0_ + (column + 0.5) * cell_m_; }
  double y(int row) const { return y0_ + (row + 0.5) * cell_m_; }
  double cell_m() const { return cell_m_; }
  double half_m() const { return 0.5 * kSide * cell_m_; }
  /// Probability of a cell; all of them sum up to 1.
  double mass(int row, int column) const {
    return mass_[static_cast<std::size_t>(row * kSide + column)] / total_;
  }
  /// Probability that a look from `range_m` finds the target.
  double DetectionProbability(double range_m) const;

 private:
  static constexpr double kStep_s = 25.0;
  void Spread(double time_s);
  void Normalise();

  double cell_m_, range_m_, probability_, at_range_, diffusivity_, workspace_m_;
  double x0_ = 0.0, y0_ = 0.0, total_ = 1.0;
  int column_lo_ = 0, column_hi_ = kSide - 1, row_lo_ = 0, row_hi_ = kSide - 1;  // inside
  TimeNs time_ = 0;
  std::array<double, kCells> mass_{};
};

}  // namespace stg::agent
