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

/// Low latency for small messages; every subscription uses it.
inline ros::TransportHints NoDelay() { return ros::TransportHints().tcpNoDelay(); }

/// Handles incoming messages. If there is none, waits for one for at most `wait_s` seconds of wall
/// time. Single-threaded: nodes need no locks.
inline void HandleMessages(double wait_s) {
  ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(wait_s));
}

/// For a process that only displays: its wake-ups do not interrupt processes at work, so a step is
/// decided first and displayed then. Call it before ros::init, because threads inherit the setting.
/// `nice` does not have this effect: roslaunch gives each node a session, and Linux shares the
/// processor between sessions first.
inline void WatchOnly() {
  const sched_param parameters{};
  sched_setscheduler(0, SCHED_BATCH, &parameters);  // if this fails, the process runs as any other
}

/// Source of the simulated time of a node.
enum class NodeClock {
  kTopic,     ///< /clock, as for every node of ROS
  kMessages,  ///< stamps of the messages that it answers, by SetNodeTime(). Each message on /clock
              ///< would wake two of its threads just when it has to decide
};

/// Sets the time for the stamps of diagnostics and log messages, in nodes with
/// NodeClock::kMessages. The stamp must be a PossibleStamp; other stamps make ROS end the process
/// sooner or later.
inline void SetNodeTime(const ros::Time& stamp) {
  if (ros::Time::isSimTime()) ros::Time::setNow(stamp);
}

/// Thrown at the end of a run if some output could not be written.
class LostOutput : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// True if the user or roslaunch ended this process; false if another node took its name.
inline std::atomic<bool>& StoppedBySignal() {
  static std::atomic<bool> stopped{false};
  return stopped;
}

/// After a shutdown the log of ROS is closed, so stderr is used.
inline void SayWhyItEnds(const char* why) {
  if (ros::ok()) {
    ROS_FATAL("%s", why);
  } else {
    std::fprintf(stderr, "[FATAL] %s\n", why);
  }
}

/// Ends the launch after a configuration was refused, because it would be refused again. roslaunch
/// restarts a node whatever its exit status is. If the launch file sets STG_REFUSAL_ENDS_LAUNCH,
/// this function makes roslaunch end, as Ctrl-C does. `./stg run` reads the exit status itself.
void EndLaunchOfRefused();

/// The main function of a node. Node has a constructor without arguments, which may throw
/// UserError, and Spin(), which returns when ROS shuts down. SIGTERM shuts the node down as SIGINT
/// does. Exit status: 0; 2 after a UserError; 3 after any other exception; 4 after LostOutput.
/// @param memory memory limit of the process in bytes; 0: no limit
template <class Node>
int RunNode(int argc, char** argv, const std::string& name, NodeClock clock = NodeClock::kTopic,
            std::size_t memory = kNodeMemory) {
  if (memory > 0) LimitMemory(memory);
  // So that a pipe such as `| tee` gets each line at once.
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  std::vector<char*> arguments(argv, argv + argc);
  // roscpp subscribes to /clock if this parameter is set, so its name is changed to an unset one.
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
  // This handle outlives the node: ROS ends with the last handle, and a fatal message would be
  // lost.
  ros::NodeHandle keeps_ros_running;
  if (clock == NodeClock::kMessages && SimulatedTimeParameter()) ros::Time::setNow(ros::Time());
  try {
    Node node;
    RequireAllParametersRead();
    ReturnFreeMemory();
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
