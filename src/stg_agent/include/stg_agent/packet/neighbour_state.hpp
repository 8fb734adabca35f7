#pragma once

#include <array>
#include <cstdint>

#include "auv_dynamics/measurements.hpp"

/// What one AUV tells its neighbours.
namespace stg::agent {

inline constexpr int kPacketBytes = 32;
using Packet = std::array<std::uint8_t, kPacketBytes>;

/// What packets say about the target.
enum class PacketLayout {
  kEstimate,     ///< the sender's estimate
  kMeasurements  ///< what it measured itself
};

/// Measurements in one packet, at most: of the one target that its sender is tasked with, and where
/// targets are chosen freely.
inline constexpr int kSightings = 2;
inline constexpr int kFreeSightings = 5;
/// Targets that may be chosen freely: a packet names them by 4 bits, one code of which is none.
inline constexpr int kMostFreeTargets = 15;
/// Ranges in one packet of agents that locate each other.
inline constexpr int kToldRanges = 2;

/// A range that a member of the network took of a packet of another one.
struct ToldRange {
  int source = 0;        ///< member that sent the packet
  TimeNs stamp = 0;      ///< when it began to leave
  double range_m = 0.0;  ///< by its travel time
};

/// A bearing at which a station heard an AUV.
struct ToldBearing {
  int source = 0;            ///< AUV whose packet it heard
  TimeNs stamp = 0;          ///< when that began to leave
  double azimuth_rad = 0.0;  ///< from the station, from east anticlockwise
};

/// State of one AUV and its target estimate, as its neighbours learn it. World axes (ENU).
struct NeighbourState {
  int source = 0;               ///< index of the AUV, 0-based
  TimeNs generation = 0;        ///< time at which this state was true
  Vec3<double> p_W;             ///< position [m]
  Vec3<double> v_W;             ///< velocity over ground [m/s]
  double confidence = 0.0;      ///< observation confidence c (Eq. 13), [0, 1]
  double tracking_error = 0.0;  ///< tracking error e (Eq. 12) [m]
  int phase = 0;                ///< 0 search, 1 approach, 2 stable, 3 lost
  double link_quality = 0.0;    ///< mean quality of the links it receives on, [0, 1]
  bool has_target = false;      ///< false: the fields below mean nothing and travel as zeros
  int target = 0;               ///< index of the target
  TimeNs target_stamp = 0;      ///< time of the target estimate, not after `generation`
  Vec3<double> p_WT;            ///< estimated target position [m]
  Vec3<double> v_WT;            ///< estimated target velocity [m/s]
  double target_std = 0.0;      ///< standard deviation of the estimate, each component [m]
  int followed = -1;            ///< target that it follows, as it tells; -1: it does not tell
  // Of the layout kMeasurements, in place of the estimate.
  double position_std_m = 0.0;  ///< of each horizontal component of p_W, as navigation states it
  int sightings = 0;            ///< how many of the following mean something
  /// Own measurements, newest first: of the target, or of any where targets are chosen freely.
  /// Deviations do not travel: everybody knows the sensor. Those of the observer's position and
  /// heading are the sender's at `generation`.
  std::array<dynamics::Detection, kFreeSightings> sighting;
  // Of agents that locate each other.
  bool adrift = false;  ///< its log measures against the water
  int ranges = 0;       ///< how many of the following mean something
  std::array<ToldRange, kToldRanges> range;
  bool has_bearing = false;  ///< of a station, which has no measurements of targets
  ToldBearing bearing;
  bool saturated = false;  ///< set by Encode when a value did not fit and was clipped
};

}  // namespace stg::agent
