#pragma once

#include <cstddef>
#include <vector>

#include "auv_common/numbers/vector.hpp"
#include "auv_common/time.hpp"
#include "stg_agent/localization/localization_config.hpp"
#include "stg_agent/localization/localizer.hpp"

namespace stg::agent {

/// Uncertainty of the position that a station sends.
struct AnchorModel {
  double std_m = 1.0;     ///< of each horizontal component
  double memory_s = 0.0;  ///< correlation time of the error; 0: it is constant
  bool on_time = true;    ///< its clock is right
};

/// Speed of sound by which an error of a clock is stated as a length.
inline constexpr double kClockSound_mps = 1500.0;

/// Errors of the clocks of AUVs and beacons.
struct ClockModel {
  bool estimated = false;     ///< false: all clocks are taken to be right
  double offset_std_s = 0.0;  ///< at the start
  double rate_std = 0.0;      ///< of d(clock)/dt - 1
};

/// Errors of the AUVs' headings.
struct HeadingModel {
  bool estimated = false;  ///< false: they only count as noise of the displacements
  double std_rad = 0.0;    ///< at the start
  double walk_rad = 0.0;   ///< deviation of the random walk after a second
};

/// A range from the travel time of one packet. The positions are those that both members reported
/// for the time at which the packet began to leave.
struct RangeReading {
  int receiver = 0, source = 0;  ///< members of the network
  TimeNs at = 0;
  Vec3<double> p_receiver, p_source;  ///< [m]
  double range_m = 0.0;
  double sound_mps = kClockSound_mps;  ///< with which the travel time became this range
};

/// The bearing of a received packet, with positions as above.
struct BearingReading {
  int receiver = 0, source = 0;  ///< members of the network
  TimeNs at = 0;
  Vec3<double> p_receiver, p_source;  ///< [m]
  double azimuth_rad = 0.0;           ///< of the source from the receiver, from east anticlockwise
  double std_rad = 0.0;
};

/// The direction of a received packet that the own modem measured, with positions as above. It is
/// in the axes of the own navigation, so it has the error of the own heading.
struct DirectionReading {
  int source = 0;  ///< member of the network
  TimeNs at = 0;
  Vec3<double> p_receiver, p_source;              ///< [m]
  double azimuth_rad = 0.0, elevation_rad = 0.0;  ///< of the source, from east and the horizontal
  double std_rad = 0.0;                           ///< in each direction across the line of sight
};

/// A GPS fix of an AUV.
struct FixReading {
  int member = 0;
  TimeNs at = 0;
  double error_x = 0.0, error_y = 0.0;  ///< its reckoned minus its GPS position at that time [m]
  double std_m = 0.0;                   ///< of each component
};

/// A Kalman filter of the errors of all reckoned positions that an AUV knows.
///
/// States: of each AUV the error e of its reckoned position and the velocity w by which its current
/// differs from the common one; the common current C; the share kappa by which ranges are too long;
/// for each station the error g of the position that it sends; where headings are estimated, the
/// error h of each AUV's heading; where clocks are estimated, the error and the rate of the clock
/// of each AUV and each beacon. For an AUV whose log measures
/// against the water, de/dt = -(C + w) + noise; C, w and the errors of craft are Ornstein-Uhlenbeck
/// processes, those of beacons and the rates of clocks constants. h is a random walk. It rotates
/// the reckoned displacement d of its AUV, so that e grows by h J d with the quarter turn J, and it
/// rotates the directions that the own modem measures. So ranges and directions of one beacon
/// cannot detect a rotation of all positions around this beacon, and the covariance of the filter
/// contains this uncertainty.
///
/// A range (1 + kappa) |p_j - p_l| of the age a depends on the errors at that time, e(t - a) = e +
/// a (C + w), so no old states are stored. Its curvature across the line of sight is taken to
/// second order. The filter uses only raw readings and reported positions, each once. So ranges
/// among AUVs do not change the mean error, the mean current or their variances.
class JointFilter {
 public:
  static constexpr int kMostObservers = 8;

  /// @param auvs members 0 .. auvs - 1; the anchors follow @param self is never removed
  JointFilter(const LocalizationConfig& config, double start_std_m, int auvs,
              const std::vector<AnchorModel>& anchors, int self, const ClockModel& clocks = {},
              const HeadingModel& heading = {});

  void Clear();
  /// Predicts all states to a time, which must not be before the last one.
  void Predict(TimeNs now);
  /// Sets whether the log of an AUV measures against the water (true) or the bottom.
  void SetAdrift(int id, bool adrift);
  /// Takes a reckoned displacement of an AUV, which the error of its heading has rotated.
  void Turn(int id, const Vec3<double>& way);
  /// Sets the depth of an AUV. The AUV's current changes with its depth.
  void SetDepth(int id, double depth_m);
  /// Adds an AUV that has no states yet. With more than kMostObservers, the AUV that was heard
  /// longest ago is removed.
  void Admit(int id, TimeNs heard);
  bool knows(int id) const { return IsAnchor(id) || SlotOf(id) >= 0; }

  /// Takes a reading with a stamp up to now, between known members. False: the gate rejected it.
  bool Take(const RangeReading& reading);
  bool Take(const BearingReading& reading);
  /// Uses azimuth and elevation, each with a gate of its own. False: neither was used.
  bool Take(const DirectionReading& reading);
  bool Take(const FixReading& reading);

  /// Error of a reported position, at a time up to now.
  PlaneError Error(int id, TimeNs at) const;
  /// Predicted error after a time without readings.
  PlaneError Ahead(int id, double ahead_s) const;
  /// Error of the first member minus that of the second.
  PlaneError Relative(int id, int than, TimeNs at) const;
  /// Mean error of the known AUVs.
  PlaneError MeanError() const;
  /// Estimate of the common current C [m/s].
  PlaneError Current() const;

  TimeNs now() const { return now_; }
  /// Squared innovation of the last Take, divided by its variance, before the gate.
  double last_nis() const { return nis_; }

 private:
  struct Reckoner {
    int id = -1;
    TimeNs heard = 0;
    bool adrift = true;
    bool dived = false;  ///< a depth is known
    double depth_m = 0.0;
  };
  struct Row;

  bool IsAnchor(int id) const { return id >= auvs_; }
  int SlotOf(int id) const;
  int ErrorAt(int slot) const { return 4 * slot; }
  int ShearAt(int slot) const { return 4 * slot + 2; }
  int CurrentAt() const { return 4 * slots_; }
  int ScaleAt() const { return CurrentAt() + 2; }
  int AnchorAt(int id) const { return ScaleAt() + 1 + 2 * (id - auvs_); }
  /// State with the error of a known AUV's heading; -1: it is not estimated.
  int HeadingAt(int id) const { return heading_.estimated ? first_heading_ + SlotOf(id) : -1; }
  void StartHeading(int id, double t_s);
  /// State with the error of a known member's clock, as a length at kClockSound_mps [m]. The next
  /// state is its rate [m/s]. -1: the clock is right.
  int ClockAt(int id) const;
  void StartClock(int clock, double t_s);
  double& P(int r, int c) { return P_[static_cast<std::size_t>(r * n_ + c)]; }
  double P(int r, int c) const { return P_[static_cast<std::size_t>(r * n_ + c)]; }
  /// @param heading state by which the bearing is turned; -1: none
  bool TakeAzimuth(const BearingReading& reading, int heading);
  bool TakeElevation(const DirectionReading& reading);
  void Scale(int i, double share);
  void Forget(int i, double share, double variance);
  void Grow(int i, int by, double share);
  void Start(int slot, int id);
  /// Adds `weight` times component `axis` of the error of a member, `age_s` ago, to a row.
  void AddError(int id, int axis, double weight, double age_s, Row* row) const;
  /// Adds `weight` times the error of a member's clock, `age_s` ago, to a row.
  void AddClock(int id, double weight, double age_s, Row* row) const;
  double Mean(const Row& row) const;
  double Column(const Row& row, double* column) const;
  PlaneError Spread(const Row& east, const Row& north) const;
  /// Reported offset of two members minus their errors [m], by axis.
  void Offset(int to, int from, const Vec3<double>& sent, double age_s, double (&offset)[2]) const;
  /// Variance that the currents of two members add in some time [m^2].
  double Wander(double age_s) const;
  /// Density of the innovation of a late sound [1/m].
  double LateDensity(double innovation, double std_m) const;
  /// Keeps the normalised innovation squared of a reading. Returns whether it is in the gate.
  /// @param innovation measured minus expected
  /// @param S variance of the innovation
  bool Passes(double innovation, double S);
  /// Updates with a reading that passes the gate. Returns whether it passes.
  bool Apply(const double* column, double innovation, double S);
  /// x += gain * column, P -= less * column column^T.
  void Update(const double* column, double gain, double less);

  LocalizationConfig config_;
  ClockModel clocks_;
  HeadingModel heading_;
  double start_variance_;
  int auvs_, self_, slots_;
  std::vector<AnchorModel> anchors_;
  std::vector<int> anchor_clocks_;  // [anchors], the state; -1: the clock is right
  int first_heading_;               // [rad], by slot
  int first_clock_, n_;             // clocks are the last states
  TimeNs now_ = 0;
  double nis_ = 0.0;
  std::vector<Reckoner> observers_;  // [slots]
  std::vector<double> x_, P_;        // [n], [n, n]
};

}  // namespace stg::agent
