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

/// The acoustic channel by itself, for vehicles of any simulator, of a replayed bag or at sea.
///
/// Vehicles tell their odometry and offer packets when they like; the channel goes on with the
/// clock of ROS, whatever that is, a moment behind it. No node waits for this one, and it waits for
/// none longer than its patience. When the clock goes back, everything starts anew.
class FleetNode : private acoustics::FleetListener {
 public:
  /// Throws UserError.
  FleetNode();
  /// Returns when ROS shuts down, or at the end of the bag.
  void Spin();

 private:
  /// What the twist of odometry is.
  enum class TwistFrame { kBody, kWorld, kNone };

  /// A message whose stamp is far from the clock: of the two, the clock may be what is late.
  struct Doubtful {
    TimeNs stamp;
    double since_s;                    ///< wall time
    std::function<void(bool)> decide;  ///< take it, or refuse it
  };

  struct Member {
    ros::Publisher reception, status;
    ros::Subscriber odometry, packets;
    std::uint64_t late = 0;  ///< packets whose step was closed before they came in
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

  std::vector<Vehicle> vehicles_;
  acoustics::NetworkConfig network_;
  acoustics::FleetChannel fleet_;
  TwistFrame twist_;
  std::string frame_;  ///< of all odometry; empty: any
  TimeNs tolerance_;   ///< of stamps against the clock [ns]
  double display_period_s_;
  std::string bag_;
  double clock_deadline_s_;  ///< wall time until which the first time of the clock is waited for
  std::vector<Member> members_;
  PacketReports reports_;
  std::unique_ptr<rosbag::Bag> recording_;  ///< null: the vehicles speak
  PacketFiles files_;
  acoustics::PacketObserver* log_ = nullptr;  ///< of this run

  TimeNs now_ = 0;          ///< clock of ROS [ns]; 0: not known yet
  TimeNs settled_ = 0;      ///< the clock a moment ago: what was on its way then has come in
  double settled_s_ = 0.0;  ///< wall time of that
  std::deque<Doubtful> doubtful_;
  std::set<std::string> frames_;  ///< of odometry that was taken, the first few
  std::uint64_t runs_ = 0, receptions_ = 0, odometry_ = 0, packets_ = 0;
  std::uint64_t foreign_messages_ = 0;  ///< of the bag, of some other type
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
