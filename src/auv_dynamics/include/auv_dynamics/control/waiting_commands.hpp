#pragma once

#include <cstddef>
#include <vector>

#include "auv_common/numbers/vector.hpp"
#include "auv_common/time.hpp"

namespace stg::dynamics {

/// Velocity commands that wait for their odometry. Commands and odometry come over separate
/// connections, so each of them may be ahead of the other by several steps.
///
/// A command waits while its stamp is at most kMost periods ahead of the newest odometry. Any other
/// command waits only for the next odometry, because a command may come first when the clock jumps
/// at the start of another run. Commands that cannot match any more are dropped, and the caller
/// counts them. Nothing is allocated after construction. Not thread-safe.
class WaitingCommands {
 public:
  struct Command {
    TimeNs stamp = 0;
    Vec3<double> v_des_W;  ///< desired velocity, world axes [m/s]
  };

  /// Largest number of waiting commands, and of periods ahead.
  static constexpr std::size_t kMost = 20;

  /// @param period of decisions [ns], > 0
  /// @param late a command matches odometry that is at most this much newer [ns]; 0: only
  ///        odometry with its own stamp
  WaitingCommands(TimeNs period, TimeNs late);

  /// Takes a command; it replaces an earlier one with the same stamp. Returns the number of
  /// commands that are dropped unused: if too many wait, the first one is dropped.
  int Add(const Command& command);

  /// Takes the stamp of the newest odometry. Returns the number of commands that are dropped
  /// unused.
  int Advance(TimeNs stamp);

  /// The newest command that matches the newest odometry; null: no command, or no odometry. Valid
  /// until the next call of another function.
  const Command* Current() const;

  /// Marks Current() as used: it is not counted when it is dropped.
  void Take();

 private:
  struct Waiting {
    Command command;
    bool acted = false;
  };

  const Waiting* Find() const;

  TimeNs period_, late_;
  bool has_odometry_ = false;
  TimeNs odometry_ = 0;            ///< stamp of the newest
  std::vector<Waiting> commands_;  ///< in the order in which they came
};

}  // namespace stg::dynamics
