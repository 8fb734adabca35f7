#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/time.h>

#include <array>
#include <cstdint>
#include <string>

/// What every node tells on /diagnostics, once per second of wall time.
namespace stg::nodes {

/// Counts events; tells how many came since the last report and how often.
class EventRate {
 public:
  void Add(std::uint64_t events = 1) { total_ += events; }
  std::uint64_t total() const { return total_; }
  /// Events since the last call.
  std::uint64_t TakeRecent() {
    const std::uint64_t recent = total_ - reported_;
    reported_ = total_;
    return recent;
  }

 private:
  std::uint64_t total_ = 0, reported_ = 0;
};

/// Messages that a node refused, by reason.
class Refusals {
 public:
  enum Reason { kNotFinite, kFrame, kStale, kMalformed, kReasons };
  void Add(Reason reason) { ++counts_[reason]; }
  std::uint64_t count(Reason reason) const { return counts_[reason]; }
  std::uint64_t total() const;
  /// Adds one line per reason; a warning when there were new ones since the last report.
  void Report(const std::string& topic, diagnostic_updater::DiagnosticStatusWrapper* status);

 private:
  std::array<std::uint64_t, kReasons> counts_{};
  std::uint64_t reported_ = 0;
};

/// Lets a message through once in a while, however often there is cause for it, and tells how many
/// were kept back. Wall time: simulated time may run a hundred times faster, or stand still.
class Throttle {
 public:
  explicit Throttle(double period_s = 2.0) : period_s_(period_s) {}
  /// True: say it now, with more() at its end.
  bool Due();
  /// " (and 41 more)", or nothing, of what was kept back before the last Due().
  const std::string& more() const { return more_; }

 private:
  double period_s_;
  ros::WallTime last_;
  std::uint64_t kept_back_ = 0;
  std::string more_;
};

/// Publishes one status of a node, paced by the wall clock: simulated time may run a hundred times
/// faster, or stand still.
class Health {
 public:
  using Report = std::function<void(diagnostic_updater::DiagnosticStatusWrapper&)>;
  Health(const std::string& name, const std::string& hardware, Report report);

  /// To be called often; publishes when a second has passed.
  void Tick();
  /// The same for a node whose answers are waited for: publishes only when it was quiet for 5 ms or
  /// is overdue by another second. Returns the seconds after which to call again.
  /// @param busy when the node last had something to do
  double TickWhenQuiet(const ros::WallTime& busy);
  /// Seconds of wall time between the last two reports.
  double period_s() const { return period_s_; }

 private:
  diagnostic_updater::Updater updater_;
  ros::WallTime last_;
  double period_s_ = 1.0;
};

}  // namespace stg::nodes
