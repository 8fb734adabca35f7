#include "display.hpp"

#include <ros/node_handle.h>

#include <iterator>

#include "auv_dynamics/nodes/conversions.hpp"
#include "auv_dynamics/nodes/topics.hpp"

namespace stg::nodes {
namespace {

constexpr std::uint32_t kDisplayQueue = 100;

}  // namespace

Display::Display(double rate_hz, std::uint32_t last_step)
    : period_s_(1.0 / rate_hz), last_step_(last_step) {
  // Latched, so that a display that starts late shows a paused run, too.
  publisher_ = ros::NodeHandle().advertise<auv_msgs::SwarmDisplay>(topics::kSwarmDisplay,
                                                                   kDisplayQueue, true);
}

void Display::Choose(const auv_msgs::SwarmState& state, double now_s) {
  const bool is_end = state.step == 0 || state.step == last_step_;
  if (!is_end && now_s - chosen_s_ < period_s_) return;
  chosen_s_ = now_s;
  chosen_.emplace(NsOf(state.header.stamp), now_s);
}

TimeNs Display::Overdue(double now_s) const {
  const bool overdue = !chosen_.empty() && now_s - chosen_.begin()->second > kPatience_s;
  return overdue ? chosen_.begin()->first : -1;
}

void Display::Send(const SwarmFrame& frame, const auv_msgs::StepReport* report,
                   const auv_msgs::LinkStates* links) {
  if (!frame.truth) return;
  const auto chosen = chosen_.find(NsOf(frame.truth->header.stamp));
  if (chosen == chosen_.end()) return;
  chosen_.erase(chosen_.begin(), std::next(chosen));  // older steps will not be judged any more
  message_.header = frame.truth->header;
  message_.state = *frame.truth;
  message_.agents.clear();
  message_.tasks.clear();
  for (std::size_t i = 0; i < frame.tasks.size(); ++i) {
    if (!frame.tasks[i]) continue;
    message_.agents.push_back(static_cast<std::uint32_t>(i));
    message_.tasks.push_back(*frame.tasks[i]);
  }
  message_.report = report == nullptr ? auv_msgs::StepReport() : *report;
  message_.report.global_state.clear();
  message_.report.final_state.clear();
  message_.links = links == nullptr ? auv_msgs::LinkStates() : *links;
  publisher_.publish(message_);
}

}  // namespace stg::nodes
