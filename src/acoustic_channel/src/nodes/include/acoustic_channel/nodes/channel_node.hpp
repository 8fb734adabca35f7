#pragma once

#include <auv_msgs/AcousticPacket.h>
#include <auv_msgs/AcousticReception.h>
#include <auv_msgs/LinkStates.h>
#include <auv_msgs/SwarmState.h>
#include <ros/node_handle.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "acoustic_channel/channel/channel.hpp"
#include "acoustic_channel/channel_config.hpp"
#include "acoustic_channel/nodes/packet_reports.hpp"
#include "auv_common/nodes/health.hpp"
#include "auv_common/nodes/poll_loop.hpp"
#include "auv_common/step/step_barrier.hpp"
#include "auv_common/step/step_tracker.hpp"

namespace stg::nodes {

/// The acoustic channel of the whole swarm.
///
/// Step k closes when the positions at t_k have arrived, and the transmissions of all AUVs whose
/// packets can leave in it. Then each AUV gets its reception window (t_k, t_{k+1}], and the world
/// gets an acknowledgement. If the packet of an AUV is missing for `timeout` seconds, or the world
/// continues without its step, the channel treats the AUV as absent. It does not wait for this AUV
/// until it transmits again. Positions, velocities, step, episode and seed come from /swarm_state.
/// A message that contradicts the run is refused, see StepTracker.
class ChannelNode {
 public:
  /// Throws UserError.
  /// @param line_of_sight if obstacles may be in the water; empty: all lines are free
  explicit ChannelNode(acoustics::LineOfSight line_of_sight = {});
  /// Uses a channel that the caller makes from the run's scenario. Throws UserError.
  using MakeChannel =
      std::function<std::unique_ptr<acoustics::Channel>(const acoustics::NetworkConfig&)>;
  explicit ChannelNode(const MakeChannel& make);
  void Spin();

 private:
  struct Auv {
    auv_msgs::AcousticPacket::ConstPtr transmission;  ///< of the open step, or of a later one
    ros::Publisher reception;
    ros::Subscriber subscriber;
  };

  double Work();
  void OnSwarm(const auv_msgs::SwarmState::ConstPtr& message);
  void Greet();
  void AskForTransmissions();
  void OnTransmission(int i, const auv_msgs::AcousticPacket::ConstPtr& message);
  /// True if the message has no data, or data that the modem accepts.
  bool Sendable(const auv_msgs::AcousticPacket& message) const;
  /// The transmission in the message.
  acoustics::Transmission TransmissionOf(const auv_msgs::AcousticPacket& message) const;
  void CloseIfDue();
  void Close();
  /// Publishes the receptions of AUV i up to a time of the episode [ns]: all of received_.
  void PublishWindow(int i, TimeNs until);
  /// Publishes if `now`, or if the last message is old enough.
  void PublishPackets(bool now);
  /// @param last it is the last step of the episode
  void PublishLinks(TimeNs now, bool last);
  void Report(diagnostic_updater::DiagnosticStatusWrapper& status);

  acoustics::NetworkConfig scenario_;
  std::unique_ptr<acoustics::Channel> channel_;
  TimeNs period_;  ///< of decisions [ns]
  double timeout_s_, display_period_s_;
  StepTracker tracker_;
  StepBarrier barrier_;   ///< the parties are the AUVs
  bool gave_up_ = false;  ///< an AUV was given up in the open step
  TimeNs start_ = -1;     ///< clock time of the episode's step 0 [ns]
  std::uint32_t step_ = 0;
  ros::WallTime links_sent_;
  double packets_sent_s_ = 0.0;  ///< wall time
  std::vector<Auv> auvs_;
  std::vector<Vec3<double>> positions_, velocities_;
  std::vector<Mat3<double>> attitudes_;  // [AUVs]
  std::vector<acoustics::Transmission> offered_;
  std::vector<acoustics::Reception> received_;
  auv_msgs::AcousticReception reception_message_;
  auv_msgs::LinkStates links_message_;
  EventRate steps_;
  std::uint64_t incomplete_steps_ = 0;
  Refusals refused_swarm_, refused_transmissions_;
  PacketReports reports_;
  ros::Publisher done_, links_, packets_;
  ros::Subscriber swarm_;
  Health health_;
};

}  // namespace stg::nodes
