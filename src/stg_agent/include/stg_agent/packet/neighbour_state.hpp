#pragma once

#include <array>
#include <cstdint>

#include "auv_common/numbers/short_list.hpp"
#include "auv_dynamics/measurements.hpp"

/// The content of an agent's packet.
namespace stg::agent {

inline constexpr int kPacketBytes = 32;
using Packet = std::array<std::uint8_t, kPacketBytes>;

/// Content of packets about the target.
enum class PacketLayout {
  kEstimate,     ///< the sender's estimate
  kMeasurements  ///< the sender's own measurements
};

/// Largest number of measurements in one packet, with task.assignment modulo and free.
inline constexpr int kSightings = 2;
inline constexpr int kFreeSightings = 5;
/// Largest number of targets with task.assignment free: a packet has 4 bits for a target, and one
/// code means none.
inline constexpr int kMostFreeTargets = 15;
/// Ranges in one packet of agents with a localizer, and the smallest and the largest one. Where
/// clocks are off, a range may be below 0.
inline constexpr int kSentRanges = 2;
inline constexpr double kLeastRange_m = -100.0, kMostRange_m = 4900.0;

/// A range that a member of the network measured from another member's packet.
struct SentRange {
  int source = 0;        ///< member that sent the packet
  TimeNs stamp = 0;      ///< when its transmission began
  double range_m = 0.0;  ///< by its travel time
};

/// The bearing at which a station received an AUV's packet.
struct SentBearing {
  int source = 0;            ///< AUV that sent the packet
  TimeNs stamp = 0;          ///< when its transmission began
  double azimuth_rad = 0.0;  ///< from the station, from east anticlockwise
};

/// An AUV's own GPS fix.
struct SentFix {
  TimeNs stamp = 0;
  double error_x = 0.0, error_y = 0.0;  ///< reckoned minus GPS position at that time [m]
  double std_m = 0.0;                   ///< of each component
};

/// State of one AUV and its target estimate, for its neighbours. World axes (ENU).
struct NeighbourState {
  int source = 0;               ///< index of the AUV, 0-based
  TimeNs generation = 0;        ///< time of this state
  Vec3<double> p_W;             ///< position [m]
  Vec3<double> v_W;             ///< velocity over ground [m/s]
  double confidence = 0.0;      ///< observation confidence c (Eq. 13), [0, 1]
  double tracking_error = 0.0;  ///< tracking error e (Eq. 12) [m]
  int phase = 0;                ///< 0 search, 1 approach, 2 stable, 3 lost
  double link_quality = 0.0;    ///< mean quality of the links on which it receives, [0, 1]
  bool has_target = false;      ///< false: the fields below have no meaning and are sent as zeros
  int target = 0;               ///< index of the target
  TimeNs target_stamp = 0;      ///< time of the target estimate, not after `generation`
  Vec3<double> p_WT;            ///< estimated target position [m]
  Vec3<double> v_WT;            ///< estimated target velocity [m/s]
  double target_std = 0.0;      ///< standard deviation of the estimate, each component [m]
  int followed = -1;            ///< target that it follows; -1: not stated
  // With the layout kMeasurements, instead of the estimate.
  double position_std_m = 0.0;  ///< of each horizontal component of p_W, stated by the navigation
  /// Own measurements, newest first: of the target, or of any target with task.assignment free.
  /// Standard deviations are not sent, because each agent knows the sensor. Those of the observer's
  /// position and heading are the sender's at `generation`.
  ShortList<dynamics::Detection, kFreeSightings> sightings;
  // With a localizer.
  bool adrift = false;  ///< its log measures against the water
  ShortList<SentRange, kSentRanges> ranges;
  bool has_bearing = false;  ///< only from a station, which has no measurements of targets
  SentBearing bearing;
  bool surfacing = false;  ///< it goes up for a fix by satellite
  bool has_fix = false;    ///< in place of the ranges
  SentFix fix;
  bool saturated = false;  ///< set by Encode when a value did not fit and was clipped
};

}  // namespace stg::agent
