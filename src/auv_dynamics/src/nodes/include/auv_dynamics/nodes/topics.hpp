#pragma once

#include "auv_common/nodes/topics.hpp"

/// Names of topics, services and frames between world, controllers and the other nodes.
namespace stg::topics {

// For each AUV, relative to Auv(i).
inline constexpr char kSensorFrame[] = "sensor_frame";
inline constexpr char kOdom[] = "odom";
inline constexpr char kTargetDetection[] = "target_detection";
inline constexpr char kCmdVel[] = "cmd_vel";
inline constexpr char kWrench[] = "wrench";
inline constexpr char kActuators[] = "actuators";
// Its instruments, with the names that marine software uses.
inline constexpr char kImu[] = "imu";
inline constexpr char kPressure[] = "pressure";
inline constexpr char kDvl[] = "dvl";
inline constexpr char kAltitude[] = "altitude";
inline constexpr char kGps[] = "gps";

// For the whole run.
inline std::string TargetOdom(int k) { return "/target_" + std::to_string(k) + "/odom"; }
inline constexpr char kClock[] = "/clock";
inline constexpr char kScenario[] = "/scenario";
inline constexpr char kReset[] = "/reset";
inline constexpr char kPause[] = "/pause";
inline constexpr char kSwarmDetections[] = "/swarm_detections";
inline constexpr char kSwarmDisplay[] = "/swarm_display";
inline constexpr char kStepReport[] = "/step_report";
inline constexpr char kEpisodeSummary[] = "/episode_summary";

}  // namespace stg::topics

namespace stg::frames {

inline constexpr char kWorldNed[] = "world_ned";
/// Origin of an altimeter's beam, with x along the beam, straight down.
inline std::string Altimeter(int i) { return "auv_" + std::to_string(i) + "/altimeter"; }
inline std::string Target(int k) { return "target_" + std::to_string(k); }

}  // namespace stg::frames
