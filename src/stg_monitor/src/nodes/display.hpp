#pragma once

#include <auv_msgs/LinkStates.h>
#include <auv_msgs/StepReport.h>
#include <auv_msgs/SwarmDisplay.h>
#include <ros/publisher.h>

#include <map>

#include "auv_common/time.hpp"
#include "stg_env/nodes/swarm_frame.hpp"

namespace stg::nodes {

/// Sends some steps of a run to displays, because a run in lockstep has many more steps per second
/// than a person can see. It always sends the first and the last step of an episode.
///
/// It chooses a step when the world's state of this step arrives. It sends the step when the states
/// of all AUVs have arrived, too, or after kPatience_s. Times `now_s` are wall time in seconds.
class Display {
 public:
  static constexpr double kPatience_s = 0.1;

  /// @param rate_hz largest rate of messages [Hz of wall time]
  /// @param last_step number of the last step of an episode
  Display(double rate_hz, std::uint32_t last_step);

  /// Chooses the step of this state if the previous choice was long enough ago.
  void Choose(const auv_msgs::SwarmState& state, double now_s);

  /// The oldest chosen step if it has waited too long; -1: none.
  TimeNs Overdue(double now_s) const;

  /// Sends a frame if its step was chosen. @param report, links null: there is none
  void Send(const SwarmFrame& frame, const auv_msgs::StepReport* report,
            const auv_msgs::LinkStates* links);

  /// Forgets all choices, because another run begins.
  void Clear() { chosen_.clear(); }

 private:
  double period_s_;
  std::uint32_t last_step_;
  std::map<TimeNs, double> chosen_;  ///< stamps of chosen steps, and the times of the choice
  double chosen_s_ = 0.0;            ///< time of the last choice
  auv_msgs::SwarmDisplay message_;
  ros::Publisher publisher_;
};

}  // namespace stg::nodes
