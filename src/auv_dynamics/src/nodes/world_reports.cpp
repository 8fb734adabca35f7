#include <algorithm>
#include <string>

#include "auv_dynamics/nodes/topics.hpp"
#include "world_node.hpp"

/// Reports of the world about the run, for the terminal and for diagnostics.
namespace stg::nodes {
namespace {

constexpr std::size_t kMaxDelays = 10'000;
/// Period of messages about nodes that the start waits for [s].
constexpr double kWaitingNews_s = 5.0;

}  // namespace

void WorldNode::WarnOfLoss(int party) {
  if (!losses_.Due()) return;
  Warn();
  const std::string step = std::to_string(step_);
  warning_ = party == Channel()
                 ? "world: acoustic channel did not close step " + step +
                       "; the run goes on without waiting for it"
                 : "world: no command of AUV " + std::to_string(party) + " for step " + step +
                       "; the last command of this AUV stays in effect";
  warning_ += losses_.more();
  warned_s_ = WallSeconds();
}

void WorldNode::Warn() {
  if (!warning_.empty()) ROS_WARN("%s", warning_.c_str());
  warning_.clear();
}

/// Names the nodes whose first answer is missing, before the run begins.
void WorldNode::ReportMissing(double now) {
  if (now - reported_s_ < kWaitingNews_s) return;
  reported_s_ = now;
  std::string missing;
  for (int party = 0; party < barrier_.parties(); ++party) {
    if (barrier_.answered(party) || !barrier_.present(party)) continue;
    missing += missing.empty() ? "" : ", ";
    missing += party == Channel() ? "the acoustic channel" : "AUV " + std::to_string(party);
  }
  ROS_INFO("world: waiting for %s, at most %.0f s longer", missing.c_str(),
           std::max(0.0, pacer_.deadline_s() - now));
}

void WorldNode::KeepDelay() {
  if (!pacer_.running()) return;  // the first answers also wait for nodes to start
  const auto delay = static_cast<float>(OpenFor() * 1e3);
  if (answer_ms_.size() < kMaxDelays) {
    answer_ms_.push_back(delay);
  } else {
    answer_ms_[next_answer_++ % kMaxDelays] = delay;
  }
}

/// Largest time from detection to wrench [ms] of this share of the answers.
double WorldNode::DelayQuantile(double share) const {
  if (answer_ms_.empty()) return 0.0;
  std::vector<float> sorted = answer_ms_;
  const auto index = static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1));
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(index),
                   sorted.end());
  return sorted[index];
}

void WorldNode::Report(diagnostic_updater::DiagnosticStatusWrapper& status) {
  const char* state = pacer_.paused()    ? "paused"
                      : pacer_.running() ? "running"
                                         : "waiting for the first answers";
  status.summary(diagnostic_msgs::DiagnosticStatus::OK, state);
  const double rate = static_cast<double>(steps_.TakeRecent()) / health_.period_s();
  status.add("episode", episode_);
  status.add("step", step_);
  status.add("steps per second", rate);
  status.add("real time factor", rate * Seconds(period_));
  status.add("from detection to wrench, median [ms]", DelayQuantile(0.5));
  status.add("from detection to wrench, 99 % [ms]", DelayQuantile(0.99));
  status.add("steps with a deadline miss", missed_steps_);
  status.add("deadline misses of the channel", barrier_.misses(Channel()));
  for (int i = 0; i < scenario_.run.agents; ++i) {
    const std::string name = topics::AuvTopic(i, commands_.topic());
    status.add("deadline misses " + name, barrier_.misses(i));
    commands_.refused(i).Report(name, &status);
    if (scenario_.world.sea.open) {
      status.add("groundings " + name, Lane(world_.sea().groundings(i), 0));
    }
    if (!barrier_.present(i)) {
      status.mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN, "no " + name);
    }
  }
  if (!barrier_.present(Channel())) {
    status.mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN, "no acoustic channel");
  }
}

}  // namespace stg::nodes
