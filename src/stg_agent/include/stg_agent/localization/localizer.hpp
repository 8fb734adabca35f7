#pragma once

#include <memory>

#include "acoustic_channel/modem/packet.hpp"
#include "auv_common/numbers/vector.hpp"
#include "auv_common/registry.hpp"
#include "stg_agent/packet/neighbour_state.hpp"

namespace stg::agent {

struct AgentModel;

/// What is believed of the horizontal error of a position: its mean and its covariance.
struct PlaneError {
  double x = 0.0, y = 0.0;              ///< [m]
  double xx = 0.0, xy = 0.0, yy = 0.0;  ///< [m^2]

  /// Of each component, the larger axis counts.
  double std_m() const;
};

/// Own reckoning at a decision.
struct OwnReckoning {
  Vec3<double> p_WB;            ///< never corrected [m]
  double position_std_m = 0.0;  ///< as navigation states it
};

/// Finds out how far reckoned positions are off, the own one and those of the neighbours. The
/// reckoned position itself is never corrected: it goes on smoothly, and what the vehicle steers by
/// lives in its frame. "Error" is reckoned minus true position.
///
/// Use, in every episode: Reset; then for every decision Hear each packet, in any order, and
/// Advance. Deterministic; the result does not depend on the order in which packets came between
/// two Advances; allocates nothing after construction.
class Localizer {
 public:
  virtual ~Localizer() = default;
  virtual void Reset() = 0;
  /// A packet of another member, as it was sent, and how it came.
  virtual void Hear(const NeighbourState& packet, const acoustics::Reception& reception) = 0;
  /// An answer to an own ping of another member, as it came.
  virtual void HearAnswer(const acoustics::Reception& answer) = 0;
  virtual void Advance(TimeNs now, const OwnReckoning& own) = 0;

  /// Error of the own reckoned position at the last Advance.
  virtual PlaneError own() const = 0;
  /// Error of the reckoned position of AUV `id` less the own one, at a time not after the last
  /// Advance.
  virtual PlaneError relative(int id, TimeNs at) const = 0;
  /// Of the current that carries everybody [m/s], [m^2/s^2].
  virtual PlaneError current() const = 0;
  /// Adds to a packet of this member what the others' localizers read; own index, time and motion
  /// stand in it already.
  virtual void Tell(NeighbourState* packet) const = 0;
  /// Where member `id` may be, in the frame in which it tells its positions [m]: a packet's
  /// positions are reported modulo the region.
  virtual Vec3<double> NearTo(int id) const = 0;
};

/// What `localization.kind` may name. A new one is a new file and one line in
/// src/localization/localizers.cpp.
/// @param self index of the member of the network
using LocalizerRegistry = Registry<Localizer, const AgentModel&, const int&>;
LocalizerRegistry& Localizers();

/// Null where the section leaves positions uncorrected.
std::unique_ptr<Localizer> MakeLocalizer(const AgentModel& model, int self);

}  // namespace stg::agent
