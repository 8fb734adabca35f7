#pragma once

namespace stg {

/// Computes when the next step is due, and how long to wait for its answers.
///
/// With a wall clock (real_time_factor > 0) a step is due one period after the previous one was
/// due, so delays do not add up. Answers are waited for until then and no longer. A late run
/// catches up without a pause; beyond kMaxBehind periods it gives up the lost time. In lockstep
/// (real_time_factor 0) a step is due at once and waits only for its answers, at most `deadline_s`.
/// Before the run begins, the first answers are waited for `start_timeout_s` in all.
///
/// All times are wall time in seconds. The caller chooses the clock; it must not go back, and all
/// calls must use the same one. This class reads no clock. Not thread-safe.
class Pacer {
 public:
  struct Options {
    double period_s = 0.1;          ///< simulated time between two steps, > 0
    double real_time_factor = 1.0;  ///< simulated seconds per second of wall time; 0: lockstep
    double deadline_s = 0.5;  ///< longest wait of a step in lockstep, or just after a pause, >= 0
    double start_timeout_s = 30.0;  ///< longest wait before the run begins, >= 0
  };

  /// A run that is late catches up at most this many periods.
  static constexpr double kMaxBehind = 5.0;
  /// Upper bounds of WaitTime(): while nothing is waited for, and while something is [s].
  static constexpr double kIdleWait_s = 0.05, kLongestWait_s = 0.2;

  explicit Pacer(const Options& options);

  /// Opens a step: computes when it is due, and when the wait for its answers ends. If the previous
  /// step is not due yet, the new one is due one period from now.
  void Open(double now_s);

  /// Ends the start: the open step is due. Call it once, after the first Open().
  void Begin(double now_s);

  /// While paused, no step is due. After the pause the open step is due at once, and the wait for
  /// its answers begins anew. A second Pause, or a Resume without a pause, changes nothing.
  void Pause() { paused_ = true; }
  void Resume(double now_s);

  bool lockstep() const { return options_.real_time_factor == 0.0; }
  bool running() const { return running_; }  ///< Begin() was called
  bool paused() const { return paused_; }

  /// True if the open step may end once it is complete.
  bool Due(double now_s) const { return running_ && !paused_ && now_s >= due_s_; }
  double due_s() const { return due_s_; }
  /// When the wait for the answers to the open step ends.
  double deadline_s() const { return deadline_s_; }

  /// Time [s] after which the caller must act even without a message.
  /// @param waiting_until_s when the parties without an answer will be given up
  /// (StepBarrier::deadline_s()); infinity: there are none, and the wait lasts until the step is
  /// due
  double WaitTime(double now_s, double waiting_until_s) const;

 private:
  Options options_;
  double period_s_;  ///< in wall time; 0 in lockstep
  bool opened_ = false, running_ = false, paused_ = false;
  double due_s_ = 0.0, deadline_s_ = 0.0;
};

}  // namespace stg
