#pragma once

#include <auv_msgs/AcousticPacket.h>
#include <auv_msgs/AcousticReception.h>
#include <auv_msgs/LinkStates.h>
#include <auv_msgs/SwarmState.h>
#include <ros/node_handle.h>

#include <memory>
#include <string>
#include <vector>

#include "acoustic_channel/channel/channel.hpp"
#include "acoustic_channel/channel/channel_config.hpp"
#include "auv_common/nodes/health.hpp"

namespace stg::nodes {

/// The acoustic channel of the whole swarm.
///
/// Step k closes when the position and the transmission of every AUV at t_k are in; then each AUV
/// gets its reception window (t_k, t_{k+1}], and the world its acknowledgement. An AUV that is
/// silent for `timeout` seconds, or whose step the world has left behind, is gone for the channel
/// and not waited for again before it transmits again. Positions, velocities, step, episode
/// and seed come with /swarm_state.
class ChannelNode {
 public:
  /// Throws UserError.
  ChannelNode();
  void Spin();

 private:
  struct Auv {
    bool present = true;                              ///< its transmissions are waited for
    auv_msgs::AcousticPacket::ConstPtr transmission;  ///< newest one
    ros::Publisher reception;
    ros::Subscriber subscriber;
  };

  double Work();
  void OnSwarm(const auv_msgs::SwarmState::ConstPtr& message);
  void OnTransmission(int i, const auv_msgs::AcousticPacket::ConstPtr& message);
  bool Usable(int i, const auv_msgs::AcousticPacket& message);
  /// Says nothing, or something that the modem takes.
  bool Sendable(const auv_msgs::AcousticPacket& message) const;
  /// What the message offers.
  acoustics::Transmission TransmissionOf(const auv_msgs::AcousticPacket& message) const;
  bool Complete(bool wait_for_all) const;
  void CloseIfDue();
  void Close();
  void PublishReceptions(int i, TimeNs until);
  void PublishLinks(TimeNs now);
  void Report(diagnostic_updater::DiagnosticStatusWrapper& status);

  acoustics::NetworkConfig scenario_;
  std::unique_ptr<acoustics::Channel> channel_;
  TimeNs period_;  ///< of decisions [ns]
  double timeout_s_, display_period_s_;
  bool open_ = false, started_ = false;
  TimeNs stamp_ = -1;  ///< clock time of the open or last step [ns]
  TimeNs start_ = -1;  ///< clock time of the episode's step 0 [ns]
  std::uint32_t episode_ = 0, step_ = 0;
  ros::WallTime opened_, links_sent_;
  std::vector<Auv> auvs_;
  std::vector<Vec3<double>> positions_, velocities_;
  std::vector<acoustics::Transmission> offered_;
  std::vector<acoustics::Reception> received_;
  auv_msgs::AcousticReception reception_message_;
  auv_msgs::LinkStates links_message_;
  EventRate steps_;
  std::uint64_t incomplete_steps_ = 0;
  Refusals refused_swarm_, refused_transmissions_;
  ros::Publisher done_, links_;
  ros::Subscriber swarm_;
  Health health_;
};

}  // namespace stg::nodes
