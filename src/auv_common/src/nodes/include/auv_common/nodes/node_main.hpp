#pragma once

#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <sched.h>

#include <atomic>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <string>
#include <vector>

#include "auv_common/error.hpp"
#include "auv_common/nodes/memory_limit.hpp"
#include "auv_common/nodes/parameters.hpp"
#include "auv_common/nodes/poll_loop.hpp"

namespace stg::nodes {

/// Low latency for small messages: every subscription asks for it.
inline ros::TransportHints NoDelay() { return ros::TransportHints().tcpNoDelay(); }

/// Handles incoming messages as they come, for at most `wait_s` seconds of wall time when none is
/// there. Single-threaded: nodes need no locks.
inline void HandleMessages(double wait_s) {
  ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(wait_s));
}

/// For a process that only watches: its wake-ups interrupt no process at work, so that a step is
/// decided first and looked at then. To be called before ros::init, as threads inherit it. What
/// `nice` does not do here: roslaunch gives each node a session, and Linux shares out the processor
/// by session first.
inline void WatchOnly() {
  const sched_param parameters{};
  sched_setscheduler(0, SCHED_BATCH, &parameters);  // fails: it watches as any other process
}

/// Where a node has its simulated time from.
enum class NodeClock {
  kTopic,     ///< /clock, as every node of ROS
  kMessages,  ///< the stamps of the messages that it answers, by SetNodeTime(): each message
              ///< on /clock would wake two of its threads, just when it has to decide
};

/// For nodes with NodeClock::kMessages: what a diagnostic or a log message will be stamped with.
/// Only for a PossibleStamp: with others ROS ends the process sooner or later.
inline void SetNodeTime(const ros::Time& stamp) {
  if (ros::Time::isSimTime()) ros::Time::setNow(stamp);
}

/// What a run was asked to write and could not; thrown at its end.
class LostOutput : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The user or roslaunch ended this process, and not another node that took its name.
inline std::atomic<bool>& StoppedBySignal() {
  static std::atomic<bool> stopped{false};
  return stopped;
}

/// After a shutdown the log of ROS is closed.
inline void SayWhyItEnds(const char* why) {
  if (ros::ok()) {
    ROS_FATAL("%s", why);
  } else {
    std::fprintf(stderr, "[FATAL] %s\n", why);
  }
}

/// A configuration that was refused once will be refused again. roslaunch starts a node anew
/// whatever its exit status: where its launch file says so (STG_REFUSAL_ENDS_LAUNCH), it is asked
/// to end instead, as by Ctrl-C. `./stg run` hears of the status itself.
void EndLaunchOfRefused();

/// A node's main: Node has a constructor without arguments that may throw UserError, and Spin(),
/// which returns when ROS shuts down. SIGTERM shuts down as SIGINT does. The exit code: 0, 2 after
/// a UserError, 3 after any other exception, 4 after LostOutput.
/// @param memory bytes that the process may have; 0: no limit
template <class Node>
int RunNode(int argc, char** argv, const std::string& name, NodeClock clock = NodeClock::kTopic,
            std::size_t memory = kNodeMemory) {
  if (memory > 0) LimitMemory(memory);
  std::setvbuf(stdout, nullptr, _IOLBF, 0);  // news is news in a pipe, too, as of `| tee`
  std::vector<char*> arguments(argv, argv + argc);
  // roscpp listens to /clock if it finds this parameter.
  char no_clock[] = "/use_sim_time:=/not_asked/use_sim_time";
  if (clock == NodeClock::kMessages) arguments.push_back(no_clock);
  int count = static_cast<int>(arguments.size());
  arguments.push_back(nullptr);
  ros::init(count, arguments.data(), name, ros::init_options::NoSigintHandler);
  ReservePollLoop();
  StoppedBySignal() = false;
  for (const int number : {SIGINT, SIGTERM}) {
    std::signal(number, [](int) {
      StoppedBySignal() = true;
      ros::requestShutdown();
    });
  }
  // Outlives the node: with the last handle ROS ends, and a fatal message would go nowhere.
  ros::NodeHandle keeps_ros_running;
  if (clock == NodeClock::kMessages && SimulatedTimeParameter()) ros::Time::setNow(ros::Time());
  try {
    Node node;
    node.Spin();
  } catch (const UserError& error) {
    SayWhyItEnds(error.what());
    EndLaunchOfRefused();
    return 2;
  } catch (const LostOutput& error) {
    SayWhyItEnds(error.what());
    return 4;
  } catch (const std::exception& error) {
    SayWhyItEnds(error.what());
    return 3;
  }
  return 0;
}

}  // namespace stg::nodes
