#pragma once

#include <cstddef>
#include <vector>

#include "auv_common/numbers/vector.hpp"
#include "auv_common/time.hpp"

namespace stg::dynamics {

/// Commands of velocity that wait for the odometry which they answer: the two come over connections
/// of their own, so either may be ahead of the other, by several steps.
///
/// A command waits while its stamp is at most kMost periods ahead of the newest odometry. Any other
/// one waits for the next odometry alone: a clock that leaps (another run begins) may let the
/// command come first. Whatever cannot be the answer any more is dropped and counted by the caller.
/// Nothing is allocated after construction. Not thread-safe.
class WaitingCommands {
 public:
  struct Command {
    TimeNs stamp = 0;
    Vec3<double> v_des_W;  ///< desired velocity, world axes [m/s]
  };

  /// As many commands wait, and as many periods ahead.
  static constexpr std::size_t kMost = 20;

  /// @param period of decisions [ns], > 0
  /// @param late a command acts on all odometry that is at most this much newer [ns]; 0: on one
  ///        message of its own stamp
  WaitingCommands(TimeNs period, TimeNs late);

  /// Takes a command; one of the same stamp replaces the one before. Returns how many commands are
  /// dropped unused: when too many wait, the one that came first is.
  int Add(const Command& command);

  /// The newest odometry is of `stamp` now. Returns how many commands are dropped unused.
  int Advance(TimeNs stamp);

  /// The command for the newest odometry, the newest of those that may act; null: none is here, or
  /// no odometry. Valid until the next call of another function.
  const Command* Current() const;

  /// Current() has acted: it is not counted when it is dropped.
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
