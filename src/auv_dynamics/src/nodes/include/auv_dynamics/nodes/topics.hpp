#pragma once

#include "auv_common/nodes/topics.hpp"

/// Names of the topics, services and frames between world, controllers and the rest of the graph.
namespace stg::topics {

// Of each AUV, below Auv(i).
inline constexpr char kSensorFrame[] = "sensor_frame";
inline constexpr char kOdom[] = "odom";
inline constexpr char kTargetDetection[] = "target_detection";
inline constexpr char kCmdVel[] = "cmd_vel";
inline constexpr char kWrench[] = "wrench";
inline constexpr char kActuators[] = "actuators";
// Its instruments, as marine software knows them.
inline constexpr char kImu[] = "imu";
inline constexpr char kPressure[] = "pressure";
inline constexpr char kDvl[] = "dvl";
inline constexpr char kAltitude[] = "altitude";
inline constexpr char kGps[] = "gps";

// Of the whole run.
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
/// Where an altimeter's beam begins; x along it, straight down.
inline std::string Altimeter(int i) { return "auv_" + std::to_string(i) + "/altimeter"; }
inline std::string Target(int k) { return "target_" + std::to_string(k); }

}  // namespace stg::frames
