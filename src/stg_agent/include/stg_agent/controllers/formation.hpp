#pragma once

#include <memory>

#include "stg_agent/controllers/encircle.hpp"

/// Controllers that keep a place in a ring that moves with the target: `formation` and `contain`.
namespace stg::agent {

/// Which bearings the ring has, as seen from the target.
enum class Slots {
  kFree,   ///< even, turned so that the AUVs have the least way to them
  kCourse  ///< even, and symmetric to the target's course
};

/// Constants of the law. Lengths and speeds are those of the sea.
struct FormationOptions {
  Slots slots = Slots::kFree;
  double radius = 1.0;           ///< of the ring, as a share of d*
  double gain_ps = 0.05;         ///< speed towards the own place per missing length
  double slow_mps = 0.9;         ///< over ground, at least
  double fast_mps = 2.3;         ///< over ground, at most
  double weave_below_mps = 0.5;  ///< a slower target is circled
  double team_range_m = 600.0;   ///< others farther from the target have no place in the ring
  double lead_s = 4.0;           ///< the vehicle is taken to be where it will be then
  double clearance_m = 30.0;     ///< others are to be missed by this, in the plane
  double doubt_mps = 0.3;        ///< and by this times the age of what they said
};

void Describe(FormationOptions* o, config::Table* t);

/// The same with places symmetric to the target's course.
struct ContainOptions : FormationOptions {
  ContainOptions() { slots = Slots::kCourse; }
};

/// Gives each AUV a place in an even ring around its target, in the order of their bearings, which
/// every AUV knows from packets: no message has to assign places, and ways do not cross.
/// It flies with the target's estimated velocity and closes up on its place by going around
/// the ring. A target slower than the vehicles can fly is circled (`encircle`).
struct Formation {
  FormationOptions options;

  template <class T>
  void Act(const ControllerInput<T>& in, T* action) const {
    Act(in, Guidance<T>(), action);
  }
  /// The same law, guided: the speed is one along the ring, the phase turns the own place.
  template <class T>
  void Act(const ControllerInput<T>& in, const Guidance<T>& guidance, T* action) const;

 private:
  /// Bearing of the own place from the target [rad], and the number of places.
  template <class T>
  T Slot(const ControllerInput<T>& in, const Level<T>& v_T) const;
  /// Desired velocity over ground in the plane, by the place alone [m/s].
  template <class T>
  Level<T> Keep(const ControllerInput<T>& in, const Level<T>& v_T, const T& radius,
                const Guidance<T>& guidance) const;
};

std::unique_ptr<Controller> MakeFormation(const FormationOptions& options);
std::unique_ptr<Controller> MakeContain(const ContainOptions& options);

}  // namespace stg::agent
