#include "auv_common/nodes/health.hpp"

#include <numeric>

namespace stg::nodes {

std::uint64_t Refusals::total() const {
  return std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0});
}

void Refusals::Report(const std::string& topic,
                      diagnostic_updater::DiagnosticStatusWrapper* status) {
  static constexpr const char* kNames[kReasons] = {"not finite", "wrong frame", "stale",
                                                   "malformed"};
  for (std::size_t k = 0; k < kReasons; ++k) {
    status->add("refused " + topic + ": " + kNames[k], counts_[k]);
  }
  const std::uint64_t recent = total() - reported_;
  reported_ = total();
  if (recent > 0) {
    status->mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN,
                         "refused " + std::to_string(recent) + " " + topic);
  }
}

bool Throttle::Due() {
  const ros::WallTime now = ros::WallTime::now();
  if (!last_.isZero() && (now - last_).toSec() < period_s_) {
    ++kept_back_;
    return false;
  }
  last_ = now;
  more_ = kept_back_ > 0 ? " (and " + std::to_string(kept_back_) + " more)" : "";
  kept_back_ = 0;
  return true;
}

Health::Health(const std::string& name, const std::string& hardware, Report report)
    : last_(ros::WallTime::now()) {
  updater_.setHardwareID(hardware);
  updater_.add(name, std::move(report));
}

double Health::TickWhenQuiet(const ros::WallTime& busy) {
  constexpr double kQuiet_s = 0.005, kIdle_s = 0.2;
  const ros::WallTime now = ros::WallTime::now();
  const double late_s = (now - last_).toSec() - 1.0;
  const double left_s = kQuiet_s - (now - busy).toSec();
  if (late_s >= 0.0 && left_s > 0.0 && late_s < 1.0) return left_s;
  Tick();
  return kIdle_s;
}

void Health::Tick() {
  const ros::WallTime now = ros::WallTime::now();
  const double elapsed = (now - last_).toSec();
  if (elapsed < 1.0) return;
  period_s_ = elapsed;
  last_ = now;
  updater_.force_update();
}

}  // namespace stg::nodes
