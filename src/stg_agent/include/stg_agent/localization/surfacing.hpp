#pragma once

#include <vector>

#include "auv_common/numbers/vector.hpp"
#include "auv_common/time.hpp"
#include "stg_agent/localization/localizer.hpp"
#include "stg_agent/packet/neighbour_state.hpp"

namespace stg::agent {

struct AgentModel;

/// Decides when an AUV goes up for a GPS fix (localization.ranges.surface_std_m), with any
/// controller or policy. One fix serves all AUVs that hear of it.
///
/// An AUV goes up if the deviation of its own position would be larger than surface_std_m by the
/// time at which it could have a fix, and if no AUV has announced within 300 s that it goes. Of the
/// AUVs heard within two minutes the shallowest one goes; of equally deep ones, the one with the
/// lowest index. Each deeper AUV waits a minute longer, in case the AUVs above it do not go. An AUV
/// on its way up turns back if it hears the announcement of an AUV with a lower index. With the fix
/// it returns to its former depth. Only its vertical velocity is commanded, so it continues to
/// circle in the plane.
///
/// Use, in every episode: Reset; then for every decision Hear each packet, in any order, and
/// Advance. Deterministic; allocates nothing after construction.
class Surfacing {
 public:
  Surfacing(const AgentModel& model, int self);

  void Reset();
  void Hear(const NeighbourState& packet);
  /// @param p_WB own position as reckoned, whose depth is right
  /// @param localizer after its Advance to the same time
  void Advance(TimeNs now, const Vec3<double>& p_WB, const Localizer& localizer);

  /// It goes up, or waits at the surface for a fix: its packets say so.
  bool announces() const { return phase_ == Phase::kUp; }
  /// It goes up, waits, or goes back down.
  bool under_way() const { return phase_ != Phase::kNone; }
  /// Vertical velocity then, as a share of the largest one [-], up.
  double climb_share() const { return climb_mps_ / limit_mps_; }

 private:
  enum class Phase { kNone, kUp, kBack };
  struct Heard {
    TimeNs at = -1;         ///< newest packet; -1: none
    double depth_m = 0.0;   ///< in it
    TimeNs announced = -1;  ///< newest packet that announced; -1: none
  };
  /// An AUV whose index is below this one has announced lately.
  bool Announced(TimeNs now, int below) const;
  int ShallowerThan(double depth_m, TimeNs now) const;
  bool Due(TimeNs now, double depth_m, const Localizer& localizer);

  int self_;
  double limit_mps_, surface_std_m_, first_fix_s_;
  std::vector<Heard> heard_;  // [auvs]
  Phase phase_ = Phase::kNone;
  double climb_mps_ = 0.0;
  double from_depth_m_ = 0.0;  // it came from
  TimeNs began_ = 0;           // the phase
  TimeNs due_since_ = -1;      // -1: it is not due
};

}  // namespace stg::agent
