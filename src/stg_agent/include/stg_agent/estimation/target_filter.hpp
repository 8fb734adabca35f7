#pragma once

#include <cmath>
#include <memory>
#include <optional>

#include "auv_common/registry.hpp"
#include "stg_agent/estimation/association.hpp"
#include "stg_agent/estimation/target_track.hpp"
#include "stg_agent/localization/localizer.hpp"
#include "stg_agent/packet/packet.hpp"

namespace stg::agent {

/// Symmetric 3x3: covariance of a position [m^2].
struct Covariance3 {
  double xx = 0.0, xy = 0.0, xz = 0.0, yy = 0.0, yz = 0.0, zz = 0.0;

  double trace() const { return xx + yy + zz; }
  /// Squared length of an error, in units of this covariance: chi-squared with 3 degrees of freedom
  /// where the covariance is right. Infinite for a singular one.
  double SquaredNorm(const Vec3<double>& error) const;
};

/// An AUV's estimate of its target in the true world frame, for comparison with the truth: the
/// covariance includes errors of its own navigation.
struct TargetBelief {
  TimeNs stamp = 0;        ///< time of the estimate
  TimeNs information = 0;  ///< time of its newest observation; before the first one, of the start
  bool started = false;    ///< false: the other fields have no meaning
  bool observed = false;   ///< it contains an observation, not only the cue
  Vec3<double> p_WT, v_WT;
  Covariance3 P_WT;  ///< covariance of p_WT

  double position_std_m() const { return std::sqrt(P_WT.trace() / 3.0); }
};

/// Whether the estimate is certain enough that the target is not lost.
inline bool Known(const AgentModel& model, const TargetBelief& belief) {
  return belief.started && belief.position_std_m() <= model.track.lost_std_m;
}

/// Uncertainty of the frame of the own navigation.
struct OwnFrame {
  double position_std_m = 0.0;  ///< stated by the navigation, without a localizer
  /// With a localizer: error of the own position, which position_std_m then leaves out.
  std::optional<PlaneError> error = {};
};

/// Estimates one target for one AUV, from the cue, its own detections and the neighbours' packets.
/// Deterministic; allocates nothing after construction.
///
/// Use in each episode: Clear, then Start if there is a cue. Then, for each decision: Hear for each
/// packet when it arrives, in any order; Predict; Fuse for the newest unread packet of each
/// neighbour, by index; Detect for an own detection; Settle.
class TargetFilter {
 public:
  virtual ~TargetFilter() = default;

  /// Whether it can use such measurements.
  virtual bool Takes(dynamics::MeasurementKind kind, bool ambiguous) const = 0;
  /// Layout of its packets.
  virtual PacketLayout layout() const { return PacketLayout::kEstimate; }

  virtual void Clear() = 0;
  /// Starts from a position of the target at the time `stamp`.
  virtual void Start(const Vec3<double>& p_WT, double std_m, TimeNs stamp) = 0;
  /// Takes any packet about this target, also a late one.
  virtual void Hear(const NeighbourState& packet) { (void)packet; }
  virtual void Predict(TimeNs now) = 0;
  /// Takes the newest packet of a neighbour about this target.
  virtual void Fuse(const NeighbourState& packet) { (void)packet; }
  /// Whether it can compare detections with its estimate; then it has Fit and Assign.
  virtual bool Associates() const { return false; }
  /// Compares a detection of an AUV, before it is taken, with the estimate at that time.
  virtual DetectionFit Fit(const dynamics::Detection& detection, int source) {
    (void)detection;
    (void)source;
    return {};
  }
  /// Takes a detection of an AUV that Fit has compared with the estimate, as one of this target.
  /// @param rivals how many times likelier it is of another target than false, see RivalsOf
  virtual void Assign(const dynamics::Detection& detection, int source, double rivals) {
    (void)detection;
    (void)source;
    (void)rivals;
  }
  /// Takes an own detection of this target, with a stamp up to now.
  virtual void Detect(const dynamics::Detection& detection) = 0;
  /// Ends the input of a decision.
  virtual void Settle(TimeNs now, const OwnFrame& own) {
    (void)now;
    (void)own;
  }

  /// In the frame of the own navigation, so that its difference to the own position is the offset
  /// to steer by.
  virtual TargetEstimate estimate() const = 0;
  virtual TargetBelief belief() const = 0;
  /// Writes the target into a packet of this AUV, which already contains own index, time and
  /// motion.
  /// @param lost the target counts as lost
  virtual void Tell(bool lost, NeighbourState* packet) const = 0;
};

/// Filters for `track.filter`. A new one is a new file and one line in
/// src/estimation/target_filters.cpp; another program registers its own with Add before it loads a
/// scenario.
/// @param self index of the AUV
using FilterRegistry = Registry<TargetFilter, const AgentModel&, const int&>;
FilterRegistry& TargetFilters();

/// The filter that the model chooses, with its options.
std::unique_ptr<TargetFilter> MakeFilter(const AgentModel& model, int self);

/// Layout of the packets of a scenario's agents, as its filter chooses it.
PacketLayout LayoutOf(const AgentModel& model);
/// Refuses a sensor that the filter cannot use.
std::optional<config::Violation> FindFilterConflict(const AgentModel& model);
/// Refuses settings that contradict a localizer or stations.
std::optional<config::Violation> FindLocalizationConflict(const AgentModel& model);

}  // namespace stg::agent
