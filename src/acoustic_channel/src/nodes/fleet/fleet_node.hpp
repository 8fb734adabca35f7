#pragma once

#include <auv_msgs/AcousticPacket.h>
#include <auv_msgs/AcousticReception.h>
#include <auv_msgs/LinkStates.h>
#include <auv_msgs/TransmitStatus.h>
#include <nav_msgs/Odometry.h>
#include <ros/node_handle.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "acoustic_channel/channel_config.hpp"
#include "acoustic_channel/fleet/fleet_channel.hpp"
#include "acoustic_channel/nodes/packet_reports.hpp"
#include "acoustic_channel/nodes/topics.hpp"
#include "auv_common/nodes/health.hpp"
#include "packet_files.hpp"
#include "ping_desk.hpp"
#include "vehicle_list.hpp"

namespace stg::nodes {

/// The acoustic channel without the other nodes, for vehicles of any simulator, of a replayed bag,
/// or at sea.
///
/// Vehicles send odometry and packets at any time. The channel follows the clock of ROS, of any
/// source, with a short delay. No node waits for this one, and this one waits for other nodes at
/// most for its patience. If the clock goes back, a new run begins.
class FleetNode : private acoustics::FleetListener {
 public:
  /// Throws UserError.
  FleetNode();
  /// Returns when ROS shuts down, or at the end of the bag.
  void Spin();

 private:
  /// Frame of the twist in the odometry.
  enum class TwistFrame { kBody, kWorld, kNone };

  /// A message whose stamp is far from the clock. The clock may be the late one.
  struct Doubtful {
    TimeNs stamp;
    double since_s;                    ///< wall time
    std::function<void(bool)> decide;  ///< accepts or refuses the message
  };

  struct Member {
    ros::Publisher reception, status;
    ros::Subscriber odometry, packets;
    std::uint64_t late = 0;  ///< packets that arrived after their step was closed
  };

  static TwistFrame TwistParameter();
  void Connect();
  double Work();
  void ReplayBag();
  void ReadBag(rosbag::View view, const std::map<std::string, int>& odometry,
               const std::map<std::string, int>& packets);
  void Conclude();
  void WatchClock(TimeNs now);
  void StartAnew();
  void Advance(TimeNs now);
  void Tell();

  TimeNs Clock() const;
  bool Timely(TimeNs stamp) const;
  void Judge(TimeNs stamp, std::function<void(bool)> decide);
  void JudgeAgain();

  void OnOdometry(int vehicle, const nav_msgs::Odometry::ConstPtr& message);
  void Place(int vehicle, const nav_msgs::Odometry& message);
  void OnPacket(int vehicle, const auv_msgs::AcousticPacket::ConstPtr& message);
  void Offer(int vehicle, const auv_msgs::AcousticPacket& message, TimeNs stamp);
  std::string FarFromTheClock(TimeNs stamp) const;
  void RefuseOdometry(int vehicle, Refusals::Reason reason, const std::string& why);
  void RefusePacket(int vehicle, const auv_msgs::AcousticPacket& message, Refusals::Reason reason,
                    const std::string& why);
  void RefusePacket(int vehicle, auv_msgs::TransmitStatus* status, Refusals::Reason reason,
                    const std::string& why);
  void AskPings();

  void OnBegin(TimeNs start) override;
  void OnReceptions(int vehicle, const std::vector<acoustics::Reception>& received) override;
  void OnAbsent(const acoustics::Transmission& packet) override;
  void OnQueued(const acoustics::PacketInfo& packet) override;
  void OnDiscarded(const acoustics::PacketInfo& packet, acoustics::DropReason reason,
                   TimeNs t) override;
  void OnSent(const acoustics::PacketInfo& packet) override;
  void OnFate(const acoustics::PacketInfo& packet, const acoustics::PacketFate& fate) override;
  void OnPing(const acoustics::PingResult& result) override;
  void OnPingRefused(std::uint32_t tag, const std::string& why) override;

  auv_msgs::TransmitStatus StatusOf(int vehicle, TimeNs stamp) const;
  auv_msgs::TransmitStatus StatusOf(const acoustics::PacketInfo& packet, TimeNs stamp) const;
  void PublishStatus(int vehicle, const auv_msgs::TransmitStatus& status);
  void PublishLinks();
  void Report(diagnostic_updater::DiagnosticStatusWrapper& status);
  void ReportVehicles(diagnostic_updater::DiagnosticStatusWrapper* status) const;

  std::vector<FleetVehicle> vehicles_;
  acoustics::NetworkConfig network_;
  acoustics::FleetChannel fleet_;
  TwistFrame twist_;
  std::string frame_;  ///< frame of all odometry; empty: any frame
  TimeNs tolerance_;   ///< largest difference between stamps and the clock [ns]
  double display_period_s_;
  std::string bag_;
  double clock_deadline_s_;  ///< wall time until which the first time of the clock is waited for
  std::vector<Member> members_;
  PacketReports reports_;
  std::unique_ptr<rosbag::Bag> recording_;  ///< null: the vehicles send live
  PacketFiles files_;
  acoustics::PacketObserver* log_ = nullptr;  ///< log of this run

  TimeNs now_ = 0;      ///< clock of ROS [ns]; 0: unknown
  TimeNs settled_ = 0;  ///< clock a moment ago; messages that were on their way then have arrived
  double settled_s_ = 0.0;  ///< wall time of settled_
  std::deque<Doubtful> doubtful_;
  std::set<std::string> frames_;  ///< frames of accepted odometry, the first few
  std::uint64_t runs_ = 0, receptions_ = 0, odometry_ = 0, packets_ = 0;
  std::uint64_t foreign_messages_ = 0;  ///< messages of the bag with another type
  Refusals refused_odometry_, refused_packets_;
  std::string last_refusal_;
  ros::Publisher events_, links_;
  ros::WallTime links_sent_;
  auv_msgs::AcousticReception reception_message_;
  auv_msgs::LinkStates links_message_;
  PingDesk pings_{topics::kPing};
  Health health_;
};

}  // namespace stg::nodes
