#pragma once

#include <memory>

#include "stg_agent/controllers/encircle.hpp"

/// Controllers that keep a place in a ring that moves with the target: `formation` and `contain`.
namespace stg::agent {

/// Which bearings the ring has, as seen from the target.
enum class Slots {
  kFree,   ///< even, turned so that the AUVs' ways to them are shortest
  kCourse  ///< even, and symmetric to the target's course
};

/// Constants of the law. Lengths and speeds are those of the sea.
struct FormationOptions {
  Slots slots = Slots::kFree;
  double radius = 1.0;           ///< radius of the ring, as a share of d*
  double gain_ps = 0.05;         ///< speed towards the AUV's place per distance from it
  double slow_mps = 0.9;         ///< smallest speed over ground
  double fast_mps = 2.3;         ///< largest speed over ground
  double weave_below_mps = 0.5;  ///< the AUVs circle a slower target
  double team_range_m = 600.0;   ///< AUVs farther from the target have no place in the ring
  double lead_s = 4.0;           ///< the law uses the vehicle's position after this time
  double clearance_m = 30.0;     ///< horizontal distance at which it passes other AUVs
  double doubt_mps = 0.3;        ///< added to it per second of age of their packet
};

void Describe(FormationOptions* o, config::Table* t);

/// The same with places symmetric to the target's course, and constants of its own.
struct ContainOptions : FormationOptions {
  ContainOptions() {
    slots = Slots::kCourse;
    radius = 0.83;
    gain_ps = 0.038;
    slow_mps = 0.89;
    weave_below_mps = 0.53;
    team_range_m = 386.0;
    lead_s = 4.9;
    clearance_m = 24.0;
    doubt_mps = 0.19;
  }
};

/// Each AUV has a place in an even ring around its target. The places follow the order of the AUVs'
/// bearings, which each AUV knows from packets, so that no message assigns places and ways do not
/// cross. The AUV flies with the target's estimated velocity and reaches its place along the ring.
/// If the target is slower than weave_below_mps, the AUVs circle it (`encircle`).
struct Formation {
  FormationOptions options;

  template <class T>
  void Act(const ControllerInput<T>& in, T* action) const {
    Act(in, Guidance<T>(), action);
  }
  /// The same law, changed by a guidance: its speed acts along the ring, its phase turns the AUV's
  /// place.
  template <class T>
  void Act(const ControllerInput<T>& in, const Guidance<T>& guidance, T* action) const;

 private:
  /// Bearing of the AUV's place from the target [rad].
  template <class T>
  T Slot(const ControllerInput<T>& in, const Level<T>& v_T) const;
  /// Desired velocity over ground in the plane [m/s], from the place alone.
  template <class T>
  Level<T> Keep(const ControllerInput<T>& in, const Level<T>& v_T, const T& radius,
                const Guidance<T>& guidance) const;
};

std::unique_ptr<Controller> MakeFormation(const FormationOptions& options);
std::unique_ptr<Controller> MakeContain(const ContainOptions& options);

}  // namespace stg::agent
