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

/// Steps the world and paces the whole graph.
///
/// Every decision k at t_k: publish what the sensors give, wait for the wrench of every AUV and for
/// the channel, step. In real time a step also waits for the wall clock and never past it; in
/// lockstep (real_time_factor 0) it waits for the answers alone, at most `deadline` seconds. What
/// is missing then is a deadline miss: the AUV's last command is held, and the AUV (or channel) is
/// not waited for again before it has spoken again. All topics are latched, so a node that comes
/// late or comes back gets the present step and answers it.
///
/// Vehicles that are steered by autopilots get a command of their actuators more often: a decision
/// is then flown in parts, before each of which all AUVs, not the channel, are waited for.
///
/// A reset waits for the open step's answers too, and leaves the step unflown.
///
/// After the last decision of an episode the final state is published as step T and answered like
/// any other; its wrenches are not used. The next episode starts one decision later.
class WorldNode {
 public:
  /// Throws UserError.
  WorldNode();
  /// Returns after the last episode, when its summary is out. Throws UserError when the vehicles'
  /// motion gets out of hand, LostOutput when the run did not end as it was asked to.
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
  void TellWhoIsMissing(double now);
  void StepWorld();
  void OpenPart();
  /// Throws UserError when a vehicle's state is beyond what the nodes take.
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
  int part_ = 0;  ///< of the decision, whose commands are waited for
  Pacer pacer_;
  double summary_timeout_s_;
  int episodes_;                            ///< to run; 0: until stopped
  std::optional<ConnectionWatch> awaited_;  ///< must hear the run from its start on
  bool wait_for_metrics_;
  std::uint64_t seed_;  ///< episode e is drawn from seed_ + e - seed_episode_
  std::uint32_t seed_episode_ = 0;
  std::uint32_t episode_ = 0, step_ = 0;
  TimeNs start_;         ///< clock time of the present episode's step 0
  StepBarrier barrier_;  ///< AUVs 0 to n - 1, then the channel
  bool finishing_ = false, done_ = false, summary_lost_ = false;
  bool reset_ = false;       ///< the next episode begins when the open step is answered
  bool summarised_ = false;  ///< the episode that has ended
  std::uint64_t missed_steps_ = 0;
  Throttle losses_;        ///< of warnings about nodes that are given up
  std::string warning_;    ///< that waits; empty: none
  double warned_s_ = 0.0;  ///< wall time when it came up
  double told_s_;          ///< wall time when the start's delay was reported
  bool shown_ = true;      ///< observers have the present step
  EventRate steps_;
  double began_ = 0.0;            ///< WallSeconds() when the run began
  double opened_ = 0.0;           ///< when the present step's sensor data began to go out
  double give_up_s_ = 0.0;        ///< until when the last summary is waited for
  std::vector<float> answer_ms_;  ///< from there to each wrench, the last kMaxDelays
  std::size_t next_answer_ = 0;
  std::vector<std::uint8_t> fresh_;  ///< the command was for the last step
  bool channel_fresh_ = false;       ///< the channel had closed it
  std::unique_ptr<WorldPublisher> publisher_;
  std::unique_ptr<Instruments> instruments_;  ///< null: not asked for
  std::vector<ros::Subscriber> subscribers_;
  std::vector<ros::ServiceServer> services_;
  Health health_;
};

}  // namespace stg::nodes
