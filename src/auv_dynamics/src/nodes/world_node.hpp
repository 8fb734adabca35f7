#pragma once

#include <auv_msgs/EpisodeSummary.h>
#include <auv_msgs/Pause.h>
#include <auv_msgs/Reset.h>
#include <ros/node_handle.h>
#include <std_msgs/Header.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "auv_common/nodes/connection_watch.hpp"
#include "auv_common/nodes/health.hpp"
#include "auv_common/nodes/poll_loop.hpp"
#include "auv_common/step/pacer.hpp"
#include "auv_common/step/step_barrier.hpp"
#include "auv_dynamics/world/world.hpp"
#include "auv_dynamics/world/world_config.hpp"
#include "instruments.hpp"
#include "vehicle_commands.hpp"
#include "world_publisher.hpp"

namespace stg::nodes {

/// Steps the world and sets the pace of the whole graph.
///
/// At every decision k at t_k it publishes the sensor data, waits for the wrench of every AUV and
/// for the channel, and steps. On the wall clock a step also waits for its time, and never longer.
/// In lockstep (real_time_factor 0) it only waits for the answers, at most `deadline` seconds. A
/// missing answer is a deadline miss: the AUV's last command is used again, and the world does not
/// wait for this AUV (or the channel) until it sends again. All topics are latched, so a node that
/// is late or comes back gets the present step and answers it.
///
/// Vehicles with autopilots get commands for their actuators more often. A decision is then made of
/// several parts. Before each part the world waits for all AUVs, but not for the channel.
///
/// A reset also waits for the answers to the open step, and then drops this step.
///
/// After the last decision of an episode, the final state is published as step T and answered like
/// any other. Its wrenches are not used. The next episode starts one decision later.
class WorldNode {
 public:
  /// Throws UserError.
  WorldNode();
  /// Returns after the last episode, when its summary was published. Throws UserError if the motion
  /// of the vehicles becomes unstable, and LostOutput if the run did not end as requested.
  void Spin();

 private:
  void OnChannelDone(const std_msgs::Header::ConstPtr& message);
  void OnSummary(const auv_msgs::EpisodeSummary::ConstPtr& message);
  bool OnReset(auv_msgs::Reset::Request& request, auv_msgs::Reset::Response& response);
  bool OnPause(auv_msgs::Pause::Request& request, auv_msgs::Pause::Response& response);

  StepBarrier::Word Hear(int i, TimeNs stamp);
  double Work();
  int Channel() const { return scenario_.run.agents; }
  double OpenFor() const { return WallSeconds() - opened_; }
  double WaitTime() const;
  void Advance();
  bool ListenersReady(double now);
  void WarnOfLoss(int party);
  void Warn();
  void ReportMissing(double now);
  void StepWorld();
  void OpenPart();
  /// Throws UserError if a vehicle's state is outside the range that the nodes accept.
  void CheckState() const;
  void StartEpisode(std::uint32_t episode);
  void OpenStep();
  void ShowStep();
  void Finish();
  void KeepDelay();
  double DelayQuantile(double share) const;
  void Report(diagnostic_updater::DiagnosticStatusWrapper& status);
  TimeNs Now() const { return start_ + world_.time(0); }
  bool AtEnd() const {
    return step_ >= static_cast<std::uint32_t>(scenario_.run.time.episode_steps);
  }

  dynamics::WorldScenario scenario_;
  dynamics::World world_;
  TimeNs period_;  ///< of decisions [ns]
  VehicleCommands commands_;
  int part_ = 0;  ///< part of the decision whose commands are awaited
  Pacer pacer_;
  double summary_timeout_s_;
  int episodes_;                            ///< number of episodes to run; 0: until stopped
  std::optional<ConnectionWatch> awaited_;  ///< a node that must receive the run from its start on
  bool wait_for_metrics_;
  std::uint64_t seed_;  ///< seed of episode e: seed_ + e - seed_episode_
  std::uint32_t seed_episode_ = 0;
  std::uint32_t episode_ = 0, step_ = 0;
  TimeNs start_;         ///< clock time of the present episode's step 0
  StepBarrier barrier_;  ///< AUVs 0 to n - 1, then the channel
  bool finishing_ = false, done_ = false, summary_lost_ = false;
  bool reset_ = false;       ///< the next episode begins when the open step is answered
  bool summarised_ = false;  ///< the summary of the episode that has ended was published
  std::uint64_t missed_steps_ = 0;
  Throttle losses_;        ///< for warnings about nodes that are given up
  std::string warning_;    ///< delayed warning; empty: none
  double warned_s_ = 0.0;  ///< wall time of the delayed warning
  double reported_s_;      ///< wall time of the last message about the delayed start
  bool shown_ = true;      ///< observers have the present step
  EventRate steps_;
  double began_ = 0.0;            ///< WallSeconds() when the run began
  double opened_ = 0.0;           ///< when the publication of the present step's sensor data began
  double give_up_s_ = 0.0;        ///< until when the last summary is waited for
  std::vector<float> answer_ms_;  ///< time from opened_ to each wrench, the last kMaxDelays
  std::size_t next_answer_ = 0;
  std::vector<std::uint8_t> fresh_;  ///< the command was for the last step
  bool channel_fresh_ = false;       ///< the channel had closed the last step
  std::unique_ptr<WorldPublisher> publisher_;
  std::unique_ptr<Instruments> instruments_;  ///< null: not requested
  std::vector<ros::Subscriber> subscribers_;
  std::vector<ros::ServiceServer> services_;
  Health health_;
};

}  // namespace stg::nodes
