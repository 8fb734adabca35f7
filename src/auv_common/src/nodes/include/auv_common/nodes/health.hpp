#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/time.h>

#include <array>
#include <cstdint>
#include <string>

/// Reports of every node on /diagnostics, once per second of wall time.
namespace stg::nodes {

/// Counts events in total and since the last report.
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

/// Counts the messages that a node refused, by reason.
class Refusals {
 public:
  enum Reason { kNotFinite, kFrame, kStale, kMalformed, kReasons };
  void Add(Reason reason) { ++counts_[reason]; }
  std::uint64_t count(Reason reason) const { return counts_[reason]; }
  std::uint64_t total() const;
  /// Adds one line per reason, and a warning if there are new ones since the last report.
  void Report(const std::string& topic, diagnostic_updater::DiagnosticStatusWrapper* status);

 private:
  std::array<std::uint64_t, kReasons> counts_{};
  std::uint64_t reported_ = 0;
};

/// Lets a message through at most once per period and counts the messages that it keeps back. The
/// period is wall time, because simulated time may run a hundred times faster or stand still.
class Throttle {
 public:
  explicit Throttle(double period_s = 2.0) : period_s_(period_s) {}
  /// True: log the message now, with more() at its end.
  bool Due();
  /// " (and 41 more)" for the messages that were kept back before the last Due(); empty if there
  /// are none.
  const std::string& more() const { return more_; }

 private:
  double period_s_;
  ros::WallTime last_;
  std::uint64_t kept_back_ = 0;
  std::string more_;
};

/// Publishes the status of a node. Wall time sets the pace, because simulated time may run a
/// hundred times faster or stand still.
class Health {
 public:
  using Report = std::function<void(diagnostic_updater::DiagnosticStatusWrapper&)>;
  Health(const std::string& name, const std::string& hardware, Report report);

  /// Publishes if a second has passed. Call it often.
  void Tick();
  /// The same for a node whose answers others wait for. Publishes only if the node has been idle
  /// for 5 ms, or if the report is late by another second. Returns the time until the next call
  /// [s].
  /// @param busy when the node last did something
  double TickWhenQuiet(const ros::WallTime& busy);
  /// Wall time between the last two reports [s].
  double period_s() const { return period_s_; }

 private:
  diagnostic_updater::Updater updater_;
  ros::WallTime last_;
  double period_s_ = 1.0;
};

}  // namespace stg::nodes
