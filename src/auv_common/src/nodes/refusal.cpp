#include <ros/console.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <string>

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

}  // namespace

void EndLaunchOfRefused() {
  const char* wanted = std::getenv("STG_REFUSAL_ENDS_LAUNCH");
  const pid_t parent = getppid();
  if (wanted == nullptr || std::string(wanted) != "1" || !IsRoslaunch(parent)) return;
  ROS_FATAL("the launch ends, as this node refuses its configuration");
  kill(parent, SIGINT);
}

}  // namespace stg::nodes
