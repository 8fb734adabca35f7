#include <ros/console.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>

#include "auv_common/nodes/node_main.hpp"

namespace stg::nodes {
namespace {

/// Whether a process, by its id, is roslaunch: the first or, after Python, the second word.
bool IsRoslaunch(pid_t process) {
  std::ifstream in("/proc/" + std::to_string(process) + "/cmdline");
  std::string word;
  for (int k = 0; k < 2 && std::getline(in, word, '\0'); ++k) {
    if (word.substr(word.find_last_of('/') + 1) == "roslaunch") return true;
  }
  return false;
}

/// First line of a file of the main thread of a process; empty where the kernel does not show it.
std::string OfMainThread(pid_t process, const char* file) {
  const std::string id = std::to_string(process);
  std::ifstream in("/proc/" + id + "/task/" + id + "/" + file);
  std::string line;
  std::getline(in, line);
  return line;
}

/// Whether a line of /proc/ID/syscall is of a thread that does something else than to sleep.
bool IsBusy(const std::string& syscall) {
  const std::string number = syscall.substr(0, syscall.find(' '));
  return !number.empty() && number != std::to_string(SYS_clock_nanosleep) &&
         number != std::to_string(SYS_pselect6);
}

/// Waits until roslaunch has started all nodes: for a second it starts none, and only sleeps, as
/// between two looks at its nodes. A roslaunch that is interrupted while it starts a node holds
/// that node's lock, then waits 20 s for the lock to end the nodes, and leaves some behind.
void AwaitLaunched(pid_t roslaunch) {
  using std::chrono::steady_clock;
  constexpr std::chrono::seconds kQuiet{1}, kMost{30};
  const auto start = steady_clock::now();
  auto changed = start;
  std::string children;
  while (!StoppedBySignal() && steady_clock::now() - changed < kQuiet &&
         steady_clock::now() - start < kMost) {
    const std::string now = OfMainThread(roslaunch, "children");
    if (now != children || IsBusy(OfMainThread(roslaunch, "syscall"))) {
      children = now;
      changed = steady_clock::now();
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

}  // namespace

void EndLaunchOfRefused() {
  const char* wanted = std::getenv("STG_REFUSAL_ENDS_LAUNCH");
  const pid_t parent = getppid();
  if (wanted == nullptr || std::string(wanted) != "1" || !IsRoslaunch(parent)) return;
  AwaitLaunched(parent);
  if (StoppedBySignal() || getppid() != parent) return;  // it ends already
  ROS_FATAL("this node refuses its configuration, so the launch ends");
  kill(parent, SIGINT);
}

}  // namespace stg::nodes
