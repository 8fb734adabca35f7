#pragma once

#include "../gaussian_mixture.hpp"
#include "auv_dynamics/measurements.hpp"
#include "stg_agent/agent_config.hpp"

namespace stg::agent {

/// Number of observers with separate errors. In larger swarms, they are the last ones with a
/// packet. Errors that drift are large when an observer comes back, so there are more of them.
inline constexpr int kSteadyObservers = 8;
inline constexpr int kMostObservers = 20;
inline constexpr int kMostStates = kTargetStates + 5 * kMostObservers;
inline constexpr int kMostStride = (kMostStates + 3) / 4 * 4;

/// Positions of the observers' errors in the state. Each observer has two of position (east,
/// north). It has one of heading if directions are measured. With `rates` it has two of the
/// velocity at which the position error grows. There are none while navigation is perfect. With
/// `rates` everything is in the own frame of navigation: errors of position are relative to the own
/// one, and those of block 0 are zero.
struct StateLayout {
  int per_observer = 0;
  int observers = 0;
  bool heading = false;
  bool rates = false;
  bool located = false;

  /// The errors are relative to the own one.
  bool relative() const { return rates || located; }
  /// Place of the first rate within a block.
  int rate() const { return heading ? 3 : 2; }

  /// Size of the state with all observers.
  int states() const { return kTargetStates + per_observer * observers; }
  /// Size of the state with the AUV itself as the only observer.
  int own_states() const { return kTargetStates + per_observer; }
  int block(int slot) const { return kTargetStates + per_observer * slot; }
};

/// How a detection fits one normal distribution.
struct SightingFit {
  double distance2;  ///< squared Mahalanobis distance of the innovation
  double density;    ///< probability density of the detection
};

/// How the target moves, and how its detections arise: the equations of the filter `measurements`
/// for one normal distribution. docs/estimation.md derives them.
class SightingModel {
 public:
  explicit SightingModel(const AgentModel& model);

  const StateLayout& layout() const { return layout_; }

  /// Predicts. Velocity is an Ornstein-Uhlenbeck process; its variance never exceeds the variance
  /// of possible velocities. Position is its integral. Errors of observers stay unchanged. Depths
  /// outside of the target's interval are unlikely: the moments of the interval are used whenever
  /// the depth is less certain than they are.
  void Predict(double dt_s, GaussianMixture* mixture) const;

  /// Writes the state of a target at a datum.
  void Datum(const Vec3<double>& p_WT, double std_m, Gaussian target, int stride) const;
  /// Fills an empty mixture with likely components before Update takes a first detection.
  void Seed(const dynamics::Detection& d, GaussianMixture* mixture) const;

  /// How much component k is too wide for the linearisation of a detection. Above 1 it should be
  /// split along the direction for which `Pa` and `variance` are written, see
  /// GaussianMixture::Split.
  double Excess(const dynamics::Detection& d, int slot, const GaussianMixture& mixture, int k,
                double* Pa, double* variance) const;

  /// Takes a detection: multiplies the component's weight by the likelihood. A detection that may
  /// be an outlier or a false alarm counts with the probability that it is true.
  /// @param mirror use mirror_azimuth_rad
  /// @param rivals how many times likelier it is to be of another target than false
  void Update(const dynamics::Detection& d, int slot, bool mirror, double rivals,
              GaussianMixture* mixture, int k) const;

  /// How a detection fits component k. The covariance of the innovation includes the second order
  /// of the linearisation.
  SightingFit Fit(const dynamics::Detection& d, int slot, bool mirror,
                  const GaussianMixture& mixture, int k) const;
  /// One over the probability density of a false detection in the place of this one.
  double ClutterVolume(const dynamics::Detection& d) const;
  /// Share of false detections.
  double false_share() const { return false_share_; }

  /// Reduces the weight of components that are faster than the target can be.
  void DoubtTheFast(double dt_s, GaussianMixture* mixture) const;
  /// Adds the mirror image of the heaviest component at the vertical plane through two observers,
  /// with unknown velocity. Returns false if the two places are not different.
  bool AddMirror(const Vec3<double>& p_WA, const Vec3<double>& p_WB, double weight,
                 GaussianMixture* mixture) const;

 private:
  struct Geometry;  // target and observer, for one component
  struct Row;       // of a measurement matrix
  struct Form;      // one measured number
  struct Point;     // a measured point
  Geometry GeometryOf(const dynamics::Detection& d, int slot, const GaussianMixture& mixture,
                      int k) const;
  Form RangeForm(const dynamics::Detection& d, int slot, const GaussianMixture& mixture,
                 int k) const;
  Form AzimuthForm(const dynamics::Detection& d, double azimuth_rad, int slot, const Geometry& at,
                   const Gaussian& g) const;
  Form ElevationForm(const dynamics::Detection& d, int slot, const Geometry& at) const;
  Point PointOf(const dynamics::Detection& d, double azimuth_rad) const;
  Form PointForm(const Point& point, int axis, int slot, const Geometry& at,
                 const Gaussian& g) const;
  void UpdateRange(const dynamics::Detection& d, int slot, double rivals, GaussianMixture* mixture,
                   int k) const;
  void UpdateBearing(const dynamics::Detection& d, double azimuth_rad, int slot, double rivals,
                     GaussianMixture* mixture, int k) const;
  void UpdatePoint(const dynamics::Detection& d, double azimuth_rad, int slot, double rivals,
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
  double false_share_;  // share of false detections
};

}  // namespace stg::agent
