#pragma once

#include <geometry_msgs/Point.h>
#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Vector3.h>

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "auv_dynamics/terrain/sea_config.hpp"

/// What a viewer knows of a run: the newest of everything that was published, and a short past.
/// Lengths [m], frame world; times [s] of simulated time.
namespace stg::nodes {

/// The part of a scenario that is drawn.
struct SceneConfig {
  std::string name;
  double half_extent_m = 1.0;
  double shown_half_extent_m = 1.0;  ///< of what the overview shows at first, around target 0
  double sensing_range_m = 0.45;
  double band_lo_m = 0.010, band_hi_m = 0.015;
  double radius_m = 0.011;
  double decision_s = 0.1;
  dynamics::SeaConfig sea;  ///< open: instead of walls
};

/// Values of auv_msgs/TaskState, and one for an AUV that has not said anything yet.
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
  double distance = -1.0;  ///< to the target as the AUV estimates it; negative: unknown
  bool target_known = false;
  geometry_msgs::Point estimate;  ///< where the AUV believes its target to be
  double estimate_std = 0.0;
  std::array<double, 6> covariance{};  ///< of it, xx xy xz yy yz zz [m^2]; zero: not known
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

/// A packet that arrived or was lost, shown for a moment.
struct PacketEvent {
  int source = 0, destination = 0;
  double time = 0.0;
  bool lost = false;
  std::uint8_t reason = 0;  ///< LinkState's constants
};

/// Sound that a modem sends.
struct CarrierView {
  int source = 0;
  double begin = 0.0, end = 0.0;  ///< at the sender; equal where the model has no airtime
};

struct SwarmView {
  SceneConfig scene;
  double now = 0.0;
  double step_s = 0.0;  ///< by which time went on last
  std::uint32_t episode = 0, step = 0;
  std::vector<VehicleView> vehicles;
  std::vector<MovingTarget> targets;
  std::vector<geometry_msgs::Point> stations;     ///< beacons and surface craft
  std::map<std::pair<int, int>, LinkView> links;  ///< by (source, destination)
  std::deque<PacketEvent> packets;
  std::deque<CarrierView> carriers;
};

}  // namespace stg::nodes
