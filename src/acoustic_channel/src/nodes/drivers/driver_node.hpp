#pragma once

#include <auv_msgs/AcousticPacket.h>
#include <auv_msgs/TransmitStatus.h>
#include <ros/node_handle.h>

#include <map>
#include <string>

#include "../fleet/ping_desk.hpp"
#include "acoustic_channel/driver/modem_port.hpp"
#include "auv_common/nodes/health.hpp"

namespace stg::nodes {

/// Connects the modem of one vehicle to the topics and the service that a vehicle of a simulated
/// fleet has: acoustic/tx, rx, status and ping, in wall time.
class DriverNode {
 public:
  /// Throws UserError.
  DriverNode();
  /// Returns when ROS shuts down.
  void Spin();

 private:
  void OnPacket(const auv_msgs::AcousticPacket::ConstPtr& message);
  void AskRanges();
  void TellReceptions();
  void TellEvents();
  void TellRanges();
  auv_msgs::TransmitStatus StatusOf(std::uint32_t tag, TimeNs t) const;
  void Report(diagnostic_updater::DiagnosticStatusWrapper& status);

  std::string vehicle_;
  int id_;
  double sound_speed_mps_;
  acoustics::ModemPort port_;
  TimeNs start_ = 0;                           ///< ROS time at time 0 of the steady clock [ns]
  std::map<std::uint32_t, int> destinations_;  ///< of packets in progress, by tag
  std::map<std::uint32_t, TimeNs> leaving_;    ///< start of each transmission, by tag
  std::uint32_t received_ = 0;
  std::uint32_t question_ = 0;  ///< tag of the open ping
  bool asks_ = false;
  PingDesk desk_;
  ros::Publisher receptions_, statuses_;
  ros::Subscriber packets_;
  Refusals refused_;
  Health health_;
};

}  // namespace stg::nodes
