#pragma once

#include <geometry_msgs/Point.h>
#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Vector3.h>

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "auv_dynamics/terrain/sea_config.hpp"

/// Data of a run for display: the newest message of each kind, and a short past. Lengths [m], frame
/// world; times [s] are simulated.
namespace stg::nodes {

/// The drawn part of a scenario.
struct SceneConfig {
  std::string name;
  double half_extent_m = 1.0;
  double shown_half_extent_m = 1.0;  ///< half extent of the overview at first, around target 0
  double sensing_range_m = 0.45;
  double band_lo_m = 0.010, band_hi_m = 0.015;
  double radius_m = 0.011;
  double decision_s = 0.1;
  double desired_distance_m = 0.015;  ///< d*
  double lost_std_m = 1.0;            ///< a less certain estimate is that of a lost target
  int beacons = 0;                    ///< stations with a lower index are beacons, others craft
  dynamics::SeaConfig sea;            ///< if it is open water, there are no walls
};

/// Values of auv_msgs/TaskState, and one for an AUV without a message so far.
enum class ShownPhase : std::uint8_t { kSearch, kApproach, kStable, kLost, kUnknown };

struct TrailPoint {
  double time = 0.0;
  geometry_msgs::Point position;
  ShownPhase phase = ShownPhase::kUnknown;
};

/// The newest measurement of a target by an AUV's own sensor.
struct DetectionView {
  double time = -1e9;
  bool has_range = false, has_bearing = false;
  double range_m = 0.0, azimuth_rad = 0.0, elevation_rad = 0.0;
};

struct VehicleView {
  bool seen = false;
  geometry_msgs::Pose pose;
  ShownPhase phase = ShownPhase::kUnknown;
  bool leader = false;     ///< role of Eq. 18
  double distance = -1.0;  ///< estimated distance to the target; negative: unknown
  bool target_known = false;
  geometry_msgs::Point estimate;  ///< estimated position of the target
  double estimate_std = 0.0;
  /// Covariance of the estimate, xx xy xz yy yz zz [m^2]; zero: unknown.
  std::array<double, 6> covariance{};
  DetectionView detection;
  std::deque<TrailPoint> trail;
};

struct MovingTarget {
  bool seen = false;
  geometry_msgs::Point position;
  geometry_msgs::Vector3 velocity;  ///< [m/s], world axes
  std::deque<TrailPoint> trail;
};

struct LinkView {
  double quality = 0.0;
  double age = 0.0;
  std::uint32_t delivered = 0, dropped = 0;
};

/// A packet that arrived or was lost; it is shown for a moment.
struct PacketEvent {
  int source = 0, destination = 0;
  double time = 0.0;
  bool lost = false;
  std::uint8_t reason = 0;  ///< constant of LinkState
};

/// Sound that a modem sends.
struct CarrierView {
  int source = 0;
  double begin = 0.0, end = 0.0;  ///< at the sender; equal if the model has no airtime
};

struct SwarmView {
  SceneConfig scene;
  double now = 0.0;
  double step_s = 0.0;  ///< last increase of time
  std::uint32_t episode = 0, step = 0;
  std::vector<VehicleView> vehicles;
  std::vector<MovingTarget> targets;
  /// Beacons and surface craft; empty: no position of it has arrived.
  std::vector<std::optional<geometry_msgs::Point>> stations;
  std::map<std::pair<int, int>, LinkView> links;  ///< by (source, destination)
  std::deque<PacketEvent> packets;
  std::deque<CarrierView> carriers;
};

}  // namespace stg::nodes
