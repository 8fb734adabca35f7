#pragma once

#include <array>

#include "auv_dynamics/measurements.hpp"
#include "stg_agent/agent_config.hpp"

/// Probability of the place of a target that no AUV detects.
namespace stg::agent {

/// Probability of the target's place in the plane, in 32 x 32 cells around its datum, or over the
/// workspace where that is smaller: a Bayes filter on a grid (Bourgault et al. 2003). A look
/// without a detection lowers the probability of the cells in its range; a detection weights all
/// cells; time spreads the probability. World axes. Allocates nothing.
///
/// The target's motion is modelled as a random walk: in a time t its variance grows by 2 s^2 m t,
/// with s = track.measurements.velocity_std_mps and m = velocity_memory_s. The target stays inside
/// the workspace.
class SearchMap {
 public:
  static constexpr int kSide = 32;
  static constexpr int kCells = kSide * kSide;

  explicit SearchMap(const AgentModel& model);

  /// Starts with a Gaussian around a datum of time 0.
  void Start(const dynamics::Cue& cue);
  /// Spreads the map until `now`, in steps of kStep_s.
  void Advance(TimeNs now);
  /// Takes a look from p_WO without a detection.
  void LookInVain(const Vec3<double>& p_WO);
  /// Takes a detection of the target by any AUV: a range or a position. A bearing alone has no
  /// effect.
  void Find(const dynamics::Detection& detection);

  /// Middle of the map and of a cell [m].
  double x(int column) const { return x0_ + (column + 0.5) * cell_m_; }
  double y(int row) const { return y0_ + (row + 0.5) * cell_m_; }
  double half_m() const { return 0.5 * kSide * cell_m_; }
  /// Side of a cell [m].
  double cell_m() const { return cell_m_; }
  /// Whether the middle of a cell is in the workspace. The others belong to no map.
  bool Inside(int row, int column) const {
    return row >= row_lo_ && row <= row_hi_ && column >= column_lo_ && column <= column_hi_;
  }
  /// Probability of a cell; all of them sum up to 1.
  double mass(int row, int column) const {
    return mass_[static_cast<std::size_t>(row * kSide + column)] / total_;
  }
  /// Probability that a look from `range_m` detects the target.
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
