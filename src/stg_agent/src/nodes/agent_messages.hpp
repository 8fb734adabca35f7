#pragma once

#include <auv_msgs/SensorFrame.h>
#include <auv_msgs/TaskState.h>

#include <vector>

#include "stg_agent/agent/agent.hpp"

namespace stg::nodes {

/// Whether pose, twist, deviations and fix of a frame are numbers that an agent can use.
bool FiniteFrame(const auv_msgs::SensorFrame& message);
/// The navigation of a frame. @param start clock time of the episode's step 0
dynamics::NavState NavOf(const auv_msgs::SensorFrame& message, TimeNs start);
/// The cue of a frame about `target`; its target is -1 if there is no usable cue.
dynamics::Cue CueOf(const auv_msgs::SensorFrame& message, int target);
/// The cues of a frame about the other targets of an agent that hunts target `own`. There are none
/// if `cue`, that of its own target, or one of the others is not usable.
std::vector<dynamics::Cue> OtherCues(const auv_msgs::SensorFrame& message, const dynamics::Cue& cue,
                                     int own, int targets);

/// Writes an agent's knowledge and action after Observe and Act. The caller sets header, episode
/// and step.
void SetTaskState(const agent::Agent& agent, const agent::AgentOutput& output,
                  auv_msgs::TaskState* message);

}  // namespace stg::nodes
