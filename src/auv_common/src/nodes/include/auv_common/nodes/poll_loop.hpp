#pragma once

#include <ros/time.h>

#include <functional>

namespace stg::nodes {

/// Wall time for barriers and pacers [s]. Corrections of the time of day do not change this clock.
inline double WallSeconds() { return ros::SteadyTime::now().toSec(); }

/// Wait time that ends a PollLoop.
inline constexpr double kLoopDone = -1.0;

/// Runs a node in the thread in which roscpp reads and writes its sockets.
///
/// With ros::spin a message changes threads twice on its way through a node: from the socket's
/// thread to the spinner's thread, and its answer goes back. Each change wakes a sleeping thread,
/// which costs more than all other work of a node here. In this loop one thread reads, handles and
/// answers messages: one wake-up for each batch of messages. The price: while a callback or `work`
/// runs, nothing is read or sent. So neither may wait for another node, e.g. in a service call.
///
/// The loop handles every message that is there, then calls `work`, and repeats. `work` returns the
/// wall time [s] after which it wants to be called again even without a message, or kLoopDone.
/// It is called at least every 0.1 s in any case. The loop returns when `work` is done or ROS
/// shuts down. Exceptions of `work` or of a callback pass through.
/// @param realtime_priority 1 to 99: the thread runs at this real-time priority (SCHED_RR), before
/// all ordinary threads of the machine. If the system does not permit it, the node reports this
/// once and runs as an ordinary one. 0: ordinary.
void PollLoop(const std::function<double()>& work, int realtime_priority = 0);

/// Call it before the first NodeHandle: the messages that a PollLoop publishes are then written to
/// the sockets in the same round. roscpp calls its poll listeners in the order in which they were
/// added. If this one came after roscpp's own, each message would wait for another round.
void ReservePollLoop();

/// The parameter `realtime_priority` of the node or of the whole graph, default 0. Throws
/// UserError.
int RealtimePriorityParameter();

}  // namespace stg::nodes
