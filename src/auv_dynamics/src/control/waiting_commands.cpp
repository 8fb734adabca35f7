#include "auv_dynamics/control/waiting_commands.hpp"

#include <algorithm>
#include <cassert>

namespace stg::dynamics {

WaitingCommands::WaitingCommands(TimeNs period, TimeNs late) : period_(period), late_(late) {
  assert(period > 0 && late >= 0);
  commands_.reserve(kMost);
}

int WaitingCommands::Add(const Command& command) {
  for (Waiting& waiting : commands_) {
    if (waiting.command.stamp != command.stamp) continue;
    waiting = {command, waiting.acted};
    return 0;
  }
  int dropped = 0;
  if (commands_.size() == kMost) {
    dropped = commands_.front().acted ? 0 : 1;
    commands_.erase(commands_.begin());
  }
  commands_.push_back({command});
  return dropped;
}

int WaitingCommands::Advance(TimeNs stamp) {
  has_odometry_ = true;
  odometry_ = stamp;
  const TimeNs reach = static_cast<TimeNs>(kMost) * period_;
  int dropped = 0;
  const auto past = [&](const Waiting& waiting) {
    const TimeNs ahead = waiting.command.stamp - stamp;
    if (ahead >= -late_ && ahead <= reach) return false;
    if (!waiting.acted) ++dropped;
    return true;
  };
  commands_.erase(std::remove_if(commands_.begin(), commands_.end(), past), commands_.end());
  return dropped;
}

const WaitingCommands::Command* WaitingCommands::Current() const {
  const Waiting* found = Find();
  return found == nullptr ? nullptr : &found->command;
}

void WaitingCommands::Take() {
  const Waiting* found = Find();
  if (found != nullptr) commands_[static_cast<std::size_t>(found - commands_.data())].acted = true;
}

const WaitingCommands::Waiting* WaitingCommands::Find() const {
  const Waiting* newest = nullptr;
  if (!has_odometry_) return newest;
  for (const Waiting& waiting : commands_) {
    const TimeNs since = odometry_ - waiting.command.stamp;
    if (since < 0 || since > late_ || (waiting.acted && late_ == 0)) continue;
    if (newest == nullptr || waiting.command.stamp > newest->command.stamp) newest = &waiting;
  }
  return newest;
}

}  // namespace stg::dynamics
