#pragma once

#include <ros/time.h>

#include <functional>

namespace stg::nodes {

/// Wall time for barriers and pacers [s]: of a clock that no correction of the time of day moves.
inline double WallSeconds() { return ros::SteadyTime::now().toSec(); }

/// Wait time that ends a PollLoop.
inline constexpr double kLoopDone = -1.0;

/// Runs a node in the thread in which roscpp reads and writes its sockets.
///
/// With ros::spin a message changes threads twice on its way through a node: from the socket's
/// thread to the spinner's, and what that publishes back again. Each change wakes a sleeping
/// thread, which costs more than all the rest of a node here. In this loop, messages are read,
/// handled and answered in one go: one wake-up for each batch of messages. The price: while a
/// callback or `work` runs, nothing is read or sent, and neither may wait for another node, as a
/// service call does.
///
/// Handles every message that is there, then calls `work`, over and over. `work` returns the
/// seconds of wall time after which it wants to be called again even without a message (coarser
/// than 0.1 s: as often), or kLoopDone. Returns when `work` is done or ROS shuts down; what `work`
/// or a callback throws is thrown here.
/// @param realtime_priority 1 to 99: the thread runs at this real-time priority (SCHED_RR), before
///        all ordinary threads of the machine; where the system does not permit it the node says so
///        once and runs as an ordinary one. 0: ordinary.
void PollLoop(const std::function<double()>& work, int realtime_priority = 0);

/// To be called before the first NodeHandle: what a PollLoop publishes is then written to its
/// sockets in the same round. roscpp asks its listeners in the order in which they came, and one
/// that came after its own has everything it publishes wait for another round.
void ReservePollLoop();

/// The parameter `realtime_priority` of a node or of the whole graph, default 0. Throws UserError.
int RealtimePriorityParameter();

}  // namespace stg::nodes
