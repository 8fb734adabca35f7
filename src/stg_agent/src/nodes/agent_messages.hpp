#pragma once

#include <auv_msgs/SensorFrame.h>
#include <auv_msgs/TaskState.h>
#include <nav_msgs/OccupancyGrid.h>

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

/// Whether the step at `time` of an episode, which begins `step` after the last one, is one that
/// shows the search map: the first step, and one in every 5 s.
bool ShowsSearchMap(TimeNs time, TimeNs step);

/// Writes a search map as a grid whose row 0 is in the south and whose column 0 is in the west. The
/// value of a cell is its probability as a share of the largest one, in percent: the cell in which
/// the target most likely is has 100. So values of two messages, or of two AUVs, cannot be
/// compared. A cell outside of the workspace belongs to no map and has -1.
///
/// The frame is world, but the cells are where the AUV's reckoned navigation puts them, as the
/// agent uses them: the error of that navigation is in the map, and no localization corrects it.
/// The grid lies at the surface, because the map has no depth and that of a datum is uncertain.
/// @param stamp clock time of the agent's last Observe
/// @return false, and no grid: no datum has arrived, so there is no map
bool SetSearchMap(const agent::SearchMemory& search, const ros::Time& stamp,
                  nav_msgs::OccupancyGrid* message);

}  // namespace stg::nodes
