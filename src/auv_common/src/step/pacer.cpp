#include "auv_common/step/pacer.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace stg {

Pacer::Pacer(const Options& options)
    : options_(options), period_s_(lockstep() ? 0.0 : options.period_s / options.real_time_factor) {
  assert(options.period_s > 0.0 && std::isfinite(options.period_s));
  assert(options.real_time_factor >= 0.0 && std::isfinite(options.real_time_factor));
  assert(options.deadline_s >= 0.0 && options.start_timeout_s >= 0.0);
}

void Pacer::Open(double now_s) {
  assert(std::isfinite(now_s));
  if (!running_) {
    // A step that replaces the first one before the run begins keeps the first one's deadline.
    if (!opened_) deadline_s_ = now_s + options_.start_timeout_s;
  } else if (lockstep()) {
    due_s_ = now_s;
    deadline_s_ = now_s + options_.deadline_s;
  } else {
    due_s_ = std::min(due_s_, now_s) + period_s_;
    if (now_s - due_s_ > kMaxBehind * period_s_) due_s_ = now_s;
    deadline_s_ = due_s_;
  }
  opened_ = true;
}

void Pacer::Begin(double now_s) {
  assert(opened_ && !running_ && std::isfinite(now_s));
  running_ = true;
  due_s_ = now_s;
}

void Pacer::Resume(double now_s) {
  assert(std::isfinite(now_s));
  if (!paused_) return;
  paused_ = false;
  due_s_ = now_s;
  deadline_s_ = now_s + (running_ ? options_.deadline_s : options_.start_timeout_s);
}

double Pacer::WaitTime(double now_s, double waiting_until_s) const {
  if (!running_ || paused_) return kIdleWait_s;
  const double next_s = std::isinf(waiting_until_s) ? due_s_ : waiting_until_s;
  return std::clamp(next_s - now_s, 0.0, kLongestWait_s);
}

}  // namespace stg
