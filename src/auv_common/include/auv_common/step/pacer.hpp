#pragma once

namespace stg {

/// When the next step is due, and how long its answers are waited for.
///
/// On the wall clock (real_time_factor > 0) a step is due one period after the one before was due,
/// so that delays do not add up, and answers are waited for until then and no longer. A late run
/// catches up without a pause, but after more than kMaxBehind periods the lost time is let go. In
/// lockstep (real_time_factor 0) a step is due at once and waits for its answers alone, at most
/// `deadline_s`. Before the run begins, its first answers are waited for `start_timeout_s` in all.
///
/// All times are wall time in seconds of a clock of the caller's choice that does not go back, the
/// same for all calls. This class reads no clock. Not thread-safe.
class Pacer {
 public:
  struct Options {
    double period_s = 0.1;          ///< simulated time between two steps, > 0
    double real_time_factor = 1.0;  ///< simulated seconds per second of wall time; 0: lockstep
    double deadline_s = 0.5;        ///< patience of a step in lockstep, or just after a pause, >= 0
    double start_timeout_s = 30.0;  ///< patience before the run begins, >= 0
  };

  /// Periods that are caught up.
  static constexpr double kMaxBehind = 5.0;
  /// Bounds of WaitTime() while nothing or something is being waited for [s].
  static constexpr double kIdleWait_s = 0.05, kLongestWait_s = 0.2;

  explicit Pacer(const Options& options);

  /// A step is opened: says anew when it is due, and when patience with its answers ends. A step
  /// that is opened before the last one was due is due one period from now.
  void Open(double now_s);

  /// The start is over, and the step that is open is due. Once, after the first Open().
  void Begin(double now_s);

  /// While paused nothing is due. After it the open step is due at once, with new patience.
  /// Pausing twice, or resuming what is not paused, changes nothing.
  void Pause() { paused_ = true; }
  void Resume(double now_s);

  bool lockstep() const { return options_.real_time_factor == 0.0; }
  bool running() const { return running_; }  ///< Begin() was called
  bool paused() const { return paused_; }

  /// The open step may be taken once it is complete.
  bool Due(double now_s) const { return running_ && !paused_ && now_s >= due_s_; }
  double due_s() const { return due_s_; }
  /// When patience with the open step's answers ends.
  double deadline_s() const { return deadline_s_; }

  /// Seconds until something is to be done even without a message.
  /// @param waiting_until_s when the parties that have not answered will be given up
  ///        (StepBarrier::deadline_s()); infinity: there are none, so until the step is due.
  double WaitTime(double now_s, double waiting_until_s) const;

 private:
  Options options_;
  double period_s_;  ///< of wall time; 0 in lockstep
  bool opened_ = false, running_ = false, paused_ = false;
  double due_s_ = 0.0, deadline_s_ = 0.0;
};

}  // namespace stg
