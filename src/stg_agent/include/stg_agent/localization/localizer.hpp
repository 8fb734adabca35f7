#pragma once

#include <memory>

#include "acoustic_channel/modem/packet.hpp"
#include "auv_common/numbers/vector.hpp"
#include "auv_common/registry.hpp"
#include "stg_agent/packet/neighbour_state.hpp"

namespace stg::agent {

struct AgentModel;

/// Estimate of the horizontal error of a position: mean and covariance.
struct PlaneError {
  double x = 0.0, y = 0.0;              ///< [m]
  double xx = 0.0, xy = 0.0, yy = 0.0;  ///< [m^2]

  /// Standard deviation of a component, along the larger axis [m].
  double std_m() const;
};

/// Own reckoning at a decision.
struct OwnReckoning {
  Vec3<double> p_WB;            ///< never corrected [m]
  double position_std_m = 0.0;  ///< stated by the navigation
  // The newest GPS fix, which does not correct p_WB.
  TimeNs fix_stamp = 0;                   ///< time of the fix
  Vec3<double> p_WF = {};                 ///< position at that time [m]
  double fix_std_m = 0.0;                 ///< of each horizontal component; 0: there was none
  double q_WB[4] = {1.0, 0.0, 0.0, 0.0};  ///< attitude, with the error of the heading
};

/// Estimates the errors of the reckoned positions of this AUV and its neighbours. The reckoned
/// position itself is not corrected: it stays smooth, and the vehicle steers in its frame. "Error"
/// is reckoned minus true position.
///
/// Use in each episode: Reset; then, for each decision, Hear for each packet, in any order, and
/// Advance. Deterministic; the result does not depend on the order of the packets between two calls
/// of Advance; allocates nothing after construction.
class Localizer {
 public:
  virtual ~Localizer() = default;
  virtual void Reset() = 0;
  /// Takes a packet of another member, and its reception.
  virtual void Hear(const NeighbourState& packet, const acoustics::Reception& reception) = 0;
  /// Takes an answer to an own ping of another member.
  virtual void HearAnswer(const acoustics::Reception& answer) = 0;
  virtual void Advance(TimeNs now, const OwnReckoning& own) = 0;

  /// Error of the own reckoned position at the last Advance.
  virtual PlaneError own() const = 0;
  /// The same after a time without readings, predicted.
  virtual PlaneError ahead(double ahead_s) const = 0;
  /// Number of own GPS fixes, and the time of the newest one; -1: there was none.
  virtual int fixes() const = 0;
  virtual TimeNs fixed() const = 0;
  /// Error of the reckoned position of AUV `id` minus the own error, at a time not after the last
  /// Advance.
  virtual PlaneError relative(int id, TimeNs at) const = 0;
  /// Estimate of the common current [m/s], [m^2/s^2].
  virtual PlaneError current() const = 0;
  /// Adds the content for other localizers to a packet of this member, which already contains own
  /// index, time and motion.
  virtual void Tell(NeighbourState* packet) const = 0;
  /// Assumed position of member `id` in its own frame [m], because packets contain positions modulo
  /// the region.
  virtual Vec3<double> NearTo(int id) const = 0;
};

/// Localizers for `localization.kind`. A new one is a new file and one line in
/// src/localization/localizers.cpp.
/// @param self index of the member of the network
using LocalizerRegistry = Registry<Localizer, const AgentModel&, const int&>;
LocalizerRegistry& Localizers();

/// Null for the kind `uncorrected`.
std::unique_ptr<Localizer> MakeLocalizer(const AgentModel& model, int self);

}  // namespace stg::agent
