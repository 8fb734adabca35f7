#pragma once

#include "auv_dynamics/measurements.hpp"
#include "gaussian_mixture.hpp"
#include "stg_agent/agent_config.hpp"

namespace stg::agent {

/// Where the errors of the observers lie in the state: of each one two of position (east, north),
/// where directions are measured one of heading, and with `rates` two of the velocity at which the
/// position error grows; none while navigation is perfect. With `rates` everything is in the own
/// frame of navigation, errors of position are against the own one, and those of block 0 are zero.
struct StateLayout {
  int per_observer = 0;
  int observers = 0;
  bool heading = false;
  bool rates = false;
  bool located = false;

  /// Errors are against the own one.
  bool relative() const { return rates || located; }
  /// Of the first number of a rate within a block.
  int rate() const { return heading ? 3 : 2; }

  int states() const { return kTargetStates + per_observer * observers; }
  int block(int slot) const { return kTargetStates + per_observer * slot; }
};

/// How the target moves, and how detections of it come about: the equations of the filter
/// `measurements`, one normal distribution at a time. docs/estimation.md derives them.
class SightingModel {
 public:
  explicit SightingModel(const AgentModel& model);

  const StateLayout& layout() const { return layout_; }

  /// Velocity: an Ornstein-Uhlenbeck process, whose variance never exceeds that of what targets
  /// can do; position: its integral. Errors of observers stay. Depths beyond the target's interval
  /// are unlikely: the interval's moments enter whenever the depth is less certain than they are.
  void Predict(double dt_s, GaussianMixture* mixture) const;

  /// The state of a target at a datum.
  void Datum(const Vec3<double>& p_WT, double std_m, Gaussian target, int stride) const;
  /// Fills an empty mixture with what is likely before a first detection is taken by Update.
  void Seed(const dynamics::Detection& d, GaussianMixture* mixture) const;

  /// How much too wide component k is for a linear view of a detection: above 1 it should be split
  /// along what `Pa` and `variance` are written for, see GaussianMixture::Split.
  double Excess(const dynamics::Detection& d, int slot, const GaussianMixture& mixture, int k,
                double* Pa, double* variance) const;

  /// Takes a detection; the component's weight is multiplied by its likelihood. One that may be an
  /// outlier, or a false alarm, counts by the probability that it is none.
  /// @param mirror take mirror_azimuth_rad
  void Update(const dynamics::Detection& d, int slot, bool mirror, GaussianMixture* mixture,
              int k) const;

  /// Takes weight from components that are faster than the target can be.
  void DoubtTheFast(double dt_s, GaussianMixture* mixture) const;
  /// Adds the mirror image of the heaviest component at the vertical plane through two observers,
  /// of unknown velocity; false where the two are no different places.
  bool AddMirror(const Vec3<double>& p_WA, const Vec3<double>& p_WB, double weight,
                 GaussianMixture* mixture) const;

  /// Moments of the depth as far as it is known beforehand [m], [m^2].
  double depth_mean() const { return depth_mean_; }
  double depth_variance() const { return depth_variance_; }

 private:
  struct Geometry;  // of target and observer, as one component has it
  struct Row;       // of a measurement matrix
  Geometry GeometryOf(const dynamics::Detection& d, int slot, const GaussianMixture& mixture,
                      int k) const;
  void UpdateRange(const dynamics::Detection& d, int slot, GaussianMixture* mixture, int k) const;
  void UpdateBearing(const dynamics::Detection& d, double azimuth_rad, int slot,
                     GaussianMixture* mixture, int k) const;
  void UpdatePoint(const dynamics::Detection& d, double azimuth_rad, int slot,
                   GaussianMixture* mixture, int k) const;
  double Take(const Row& row, double innovation, double variance, double alike, double clutter,
              Gaussian g, int stride) const;
  void Apply(const Row& row, double innovation, double variance, double truth, Gaussian g,
             int stride) const;
  Row RowOf(const Vec3<double>& direction, int slot) const;
  void AddHeading(double slope, int slot, Row* row) const;

  StateLayout layout_;
  double velocity_variance_, velocity_memory_s_;
  double depth_mean_, depth_variance_;
  double observer_depth_variance_;
  double range_m_, floor_std_m_, max_speed_mps_;
  double false_share_;  // of detections
};

}  // namespace stg::agent
