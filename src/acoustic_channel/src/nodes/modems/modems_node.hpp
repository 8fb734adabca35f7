#pragma once

#include <auv_msgs/AcousticPacket.h>
#include <auv_msgs/AcousticReception.h>
#include <nav_msgs/Odometry.h>
#include <ros/node_handle.h>

#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "acoustic_channel/emulator/modem_server.hpp"
#include "acoustic_channel/log/packet_log.hpp"
#include "acoustic_channel/nodes/packet_reports.hpp"
#include "auv_common/nodes/health.hpp"

namespace stg::nodes {

/// Emulated modems in real time. Hosts connect to sockets, terminals and serial lines. Vehicles are
/// moved by their odometry, or have a fixed place in the file.
class ModemsNode : private acoustics::PacketObserver {
 public:
  /// Throws UserError.
  ModemsNode();
  /// Returns when ROS shuts down.
  void Spin();

 private:
  struct Member {
    ros::Publisher reception;
    ros::Subscriber odometry, packets;
    TimeNs heard = 0;  ///< time of the last message about its place
  };

  void Connect();
  void OnOdometry(int vehicle, const nav_msgs::Odometry::ConstPtr& message);
  void OnPacket(int vehicle, const auv_msgs::AcousticPacket::ConstPtr& message);
  void Tell();
  void PublishReceptions();
  void Report(diagnostic_updater::DiagnosticStatusWrapper& status);

  void OnQueued(const acoustics::PacketInfo& packet) override;
  void OnDiscarded(const acoustics::PacketInfo& packet, acoustics::DropReason reason,
                   TimeNs t) override;
  void OnSent(const acoustics::PacketInfo& packet) override;
  void OnFate(const acoustics::PacketInfo& packet, const acoustics::PacketFate& fate) override;

  acoustics::ModemFile file_;
  acoustics::ModemServer server_;
  TimeNs silent_after_;
  TimeNs start_ = 0;  ///< ROS time at time 0 of the network [ns]
  std::vector<Member> members_;
  PacketReports reports_;
  std::ofstream log_file_;
  std::unique_ptr<acoustics::PacketLog> log_;
  std::vector<acoustics::Reception> received_;
  ros::Publisher events_;
  Refusals refused_;
  Health health_;
};

}  // namespace stg::nodes
