#pragma once

#include <cmath>
#include <optional>

#include "auv_common/registry.hpp"
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

/// What an AUV believes of its target, in the true world frame: errors of its own navigation are
/// in the covariance. To be compared with the truth.
struct TargetBelief {
  TimeNs stamp = 0;        ///< time that it is of
  TimeNs information = 0;  ///< time of the newest observation that it rests on; the start before
  bool started = false;    ///< false: nothing else means anything
  bool observed = false;   ///< it rests on an observation, not on the cue alone
  Vec3<double> p_WT, v_WT;
  Covariance3 P_WT;  ///< of p_WT

  double position_std_m() const { return std::sqrt(P_WT.trace() / 3.0); }
};

/// Whether it is good enough to count as knowing where the target is.
inline bool Known(const AgentModel& model, const TargetBelief& belief) {
  return belief.started && belief.position_std_m() <= model.track.lost_std_m;
}

/// How far the frame of the own navigation may be off.
struct OwnFrame {
  double position_std_m = 0.0;  ///< as navigation states it; where no localizer knows better
  /// Where a localizer does: the error of the own position, which is not in the former.
  std::optional<PlaneError> error = {};
};

/// Follows one target for one AUV: from the cue, its own detections and what its neighbours share.
/// Deterministic; allocates nothing after construction.
///
/// Use, in every episode: Clear, then Start or not; then for every decision Hear each packet when
/// it arrives, in any order; Predict, Fuse the newest packet of each neighbour that has an unread
/// one, by index, Detect the own detection if there is one, Settle.
class TargetFilter {
 public:
  virtual ~TargetFilter() = default;

  /// What it can make use of.
  virtual bool Takes(dynamics::MeasurementKind kind, bool ambiguous) const = 0;
  /// What packets say about the target.
  virtual PacketLayout layout() const { return PacketLayout::kEstimate; }

  virtual void Clear() = 0;
  /// A datum of the target, true at `stamp`.
  virtual void Start(const Vec3<double>& p_WT, double std_m, TimeNs stamp) = 0;
  /// Any packet about this target, late or out of order.
  virtual void Hear(const NeighbourState& packet) { (void)packet; }
  virtual void Predict(TimeNs now) = 0;
  /// The newest packet of a neighbour, about this target.
  virtual void Fuse(const NeighbourState& packet) { (void)packet; }
  /// An own detection of this target, not of the future.
  virtual void Detect(const dynamics::Detection& detection) = 0;
  /// All of this decision is in.
  virtual void Settle(TimeNs now, const OwnFrame& own) {
    (void)now;
    (void)own;
  }

  /// In the frame of the own navigation: what own position and estimate differ by is what the
  /// vehicle has to steer by.
  virtual TargetEstimate estimate() const = 0;
  virtual TargetBelief belief() const = 0;
  /// What a packet of this AUV says about the target; own index, time and motion stand in it
  /// already.
  /// @param lost the agent takes the target for lost
  virtual void Tell(bool lost, NeighbourState* packet) const = 0;
};

/// What `track.filter` may name. A new one is a new file and one line in
/// src/estimation/target_filters.cpp; one of another program is added with Add before it loads a
/// scenario.
/// @param self index of the AUV
using FilterRegistry = Registry<TargetFilter, const AgentModel&, const int&>;
FilterRegistry& TargetFilters();

/// The packets of a scenario's agents: its filter says what is in them.
PacketLayout LayoutOf(const AgentModel& model);
/// A sensor that the filter cannot make use of.
std::optional<config::Violation> FindFilterConflict(const AgentModel& model);
/// What a localizer, or a station, does not go together with.
std::optional<config::Violation> FindLocalizationConflict(const AgentModel& model);

}  // namespace stg::agent
