#pragma once

#include <array>
#include <optional>

#include "auv_common/config/field.hpp"

namespace stg::dynamics {

/// Water current; the hull forces of Eq. 3 act on the velocity relative to it.
struct CurrentConfig {
  std::array<double, 3> velocity_mps{0.0, 0.0, 0.0};  ///< world frame, irrotational
  /// Added at four depths, linear in between: none while all velocities are zero.
  std::array<double, 4> layer_depth_m{0.0, 50.0, 100.0, 200.0};
  std::array<double, 4> layer_east_mps{0.0, 0.0, 0.0, 0.0};
  std::array<double, 4> layer_north_mps{0.0, 0.0, 0.0, 0.0};
  /// Added: amplitude to east and north, cos(2 pi t / period + phase).
  std::array<double, 2> tide_mps{0.0, 0.0};
  double tide_period_s = 44714.2;  ///< M2, 12.4206 h
  double tide_phase_rad = 0.0;
  // Added and drawn per episode: a speed at each of the four depths, a direction that turns between
  // them, and a tide with a random phase.
  config::Interval random_mps{0.0, 0.0};
  double random_turn_deg = 28.6;  ///< standard deviation, from one depth to the next
  double random_tide_mps = 0.0;   ///< amplitude; its direction is drawn, too

  bool random() const { return random_mps.hi > 0.0; }
  bool layered() const;  ///< any of the layers' velocities is not zero
  bool tidal() const;    ///< the tide that is not drawn is not zero
  /// No current of an episode is faster than this: the sum of the largest speeds of all parts
  /// [m/s].
  double largest_mps() const;
};

/// First-order Gauss-Markov disturbance w of Eq. 3, body axes.
struct DisturbanceConfig {
  double force_std_n = 0.0;
  double moment_std_nm = 0.0;
  double correlation_time_s = 2.0;
};

/// Repulsion between vehicles: stiffness * softness * softplus((2 radius - distance) / softness).
struct ContactConfig {
  double stiffness = 100.0;  ///< [N per m of softplus argument]
  double softness_m = 0.001;
};

/// The box, and the shares of a velocity that remain after contact with a wall: its normal and
/// tangential world components, and the body velocity and rates of the vehicle.
struct WorkspaceConfig {
  double half_extent_m = 1.0;  ///< walls at +-half_extent on each axis
  double restitution = 0.2;
  double tangential = 0.85;
  double body_velocity = 0.7;
  double body_rate = 0.8;
};

/// Keys, units and ranges of the sections.
void Describe(CurrentConfig* c, config::Table* t);
std::optional<config::Violation> FindConflict(const CurrentConfig& c);
void Describe(DisturbanceConfig* c, config::Table* t);
void Describe(ContactConfig* c, config::Table* t);
void Describe(WorkspaceConfig* c, config::Table* t);

}  // namespace stg::dynamics
