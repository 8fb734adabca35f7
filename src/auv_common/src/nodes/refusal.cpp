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

/// True if this process is roslaunch: the first word of its command line or, after Python, the
/// second.
bool IsRoslaunch(pid_t process) {
  std::ifstream in("/proc/" + std::to_string(process) + "/cmdline");
  std::string word;
  for (int k = 0; k < 2 && std::getline(in, word, '\0'); ++k) {
    if (word.substr(word.find_last_of('/') + 1) == "roslaunch") return true;
  }
  return false;
}

/// The parent of a process; 0 if the kernel does not show it.
pid_t ParentOf(pid_t process) {
  std::ifstream in("/proc/" + std::to_string(process) + "/status");
  for (std::string word; in >> word;) {
    if (word != "PPid:") continue;
    pid_t parent = 0;
    return in >> parent ? parent : 0;
  }
  return 0;
}

/// First line of a file of a process's main thread; empty if the kernel does not show it.
std::string OfMainThread(pid_t process, const char* file) {
  const std::string id = std::to_string(process);
  std::ifstream in("/proc/" + id + "/task/" + id + "/" + file);
  std::string line;
  std::getline(in, line);
  return line;
}

/// True if a line of /proc/ID/syscall belongs to a thread that is not asleep.
bool IsBusy(const std::string& syscall) {
  const std::string number = syscall.substr(0, syscall.find(' '));
  return !number.empty() && number != std::to_string(SYS_clock_nanosleep) &&
         number != std::to_string(SYS_pselect6);
}

/// Waits until roslaunch has started all nodes: until a second of looks shows no new node and a
/// roslaunch that only sleeps, as it does between two checks of its nodes. Looks are counted and
/// not time, because on a busy machine this process may get no processor for more than a second. A
/// roslaunch that is interrupted while it starts a node holds the lock of this node. It then waits
/// 20 s for the lock before it ends the nodes, and some of them stay alive.
void AwaitLaunched(pid_t roslaunch) {
  constexpr std::chrono::milliseconds kBetweenLooks{20};
  constexpr int kQuiet = 50, kMost = 1500;
  std::string children;
  for (int looks = 0, quiet = 0; !StoppedBySignal() && quiet < kQuiet && looks < kMost; ++looks) {
    const std::string now = OfMainThread(roslaunch, "children");
    quiet = now != children || IsBusy(OfMainThread(roslaunch, "syscall")) ? 0 : quiet + 1;
    children = now;
    std::this_thread::sleep_for(kBetweenLooks);
  }
}

}  // namespace

void EndLaunchOfRefused() {
  const char* wanted = std::getenv("STG_REFUSAL_ENDS_LAUNCH");
  const pid_t parent = getppid();
  if (wanted == nullptr || std::string(wanted) != "1") return;
  // A required node is the child of ends_launch. It must wait, too: a roslaunch whose required node
  // dies while it still starts others may hang.
  const pid_t roslaunch = IsRoslaunch(parent) ? parent : ParentOf(parent);
  if (!IsRoslaunch(roslaunch)) return;
  AwaitLaunched(roslaunch);
  if (StoppedBySignal() || getppid() != parent) return;  // the launch ends already
  ROS_FATAL("this node refuses its configuration, so the launch ends");
  kill(roslaunch, SIGINT);
}

}  // namespace stg::nodes
