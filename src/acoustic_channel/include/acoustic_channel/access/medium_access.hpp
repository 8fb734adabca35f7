#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "auv_common/config/field.hpp"
#include "auv_common/config/run_config.hpp"
#include "auv_common/registry.hpp"

/// Medium access: the time at which a waiting packet leaves its modem.
namespace stg::acoustics {

struct ChannelConfig;

inline constexpr TimeNs kNever = std::numeric_limits<TimeNs>::max();

/// Knowledge of a modem when it asks its rule.
struct Attempt {
  std::uint32_t sequence = 0;  ///< number that the waiting packet will have
  std::uint32_t tries = 0;     ///< how often this packet found the medium busy
  TimeNs last_end = kNever;    ///< end of its last transmission; kNever: there was none
};

/// Time that a modem needs for the longest packet of the network; zero on ideal channels.
struct PacketTime {
  TimeNs airtime = 0, turnaround = 0;
};

/// The rule by which the modems of a network share the water, in continuous time. Times count from
/// the start of the episode. The draws of a rule must depend only on seed, episode and its
/// arguments, so that calls in any order give the same answer. A rule allocates nothing.
class MediumAccess {
 public:
  virtual ~MediumAccess() = default;

  /// Starts an episode.
  virtual void Reset(std::uint64_t /*seed*/, std::uint32_t /*episode*/) {}

  /// Earliest time, not before `from`, at which a packet that waits in the modem of `node` may
  /// begin to leave. A second call with a `from` up to that time returns the same.
  virtual TimeNs Next(int node, TimeNs from, const Attempt& attempt) const = 0;

  /// True: a modem that detects a carrier at that time does not begin, counts one more try and
  /// calls Next again from that time on. On ideal channels there are no carriers.
  virtual bool listens() const { return false; }

  /// True: the answer of Next depends on the attempt, so only the modem can know it.
  virtual bool adapts() const { return listens(); }

  /// The reason why the rule cannot work with the section, the clock of the run and such packets;
  /// nothing: it can.
  virtual std::optional<config::Violation> FindConflict(const PacketTime& /*packet*/) const {
    return {};
  }
};

/// All rules, by their names for `channel.access`.
using MediumAccessRegistry = Registry<MediumAccess, const ChannelConfig&, const RunConfig&>;
MediumAccessRegistry& MediumAccesses();

/// The rule that the section names, for the nodes and the clock of the run. Throws UserError.
std::unique_ptr<MediumAccess> MakeMediumAccess(const ChannelConfig& config, const RunConfig& run);

/// Time between two turns of a node; 0 if it depends on what the node sent.
TimeNs RoundOf(const ChannelConfig& config, const RunConfig& run);
/// Time between two turns of a node [s], as the keys of the chosen medium access state it: a round
/// of slots, or the period of `periodic`; 0 for an access without turns.
double RoundOfKeys(const ChannelConfig& c, int nodes);
/// Length of a slot [s]; 0: the chosen medium access has no slots.
double SlotOfKeys(const ChannelConfig& c);

/// The times at which packets that are offered at decisions can leave. Modems and agents compute
/// the same times, so an agent need not make a packet that cannot leave.
class Turns {
 public:
  /// Throws UserError for an unknown rule.
  Turns(const ChannelConfig& config, const RunConfig& run);

  void Reset(std::uint64_t seed, std::uint32_t episode);

  /// When `node` begins to send in the step from t to the next decision; kNever: not in it.
  TimeNs Start(int node, TimeNs t) {
    Memo& m = memos_[static_cast<std::size_t>(node)];
    if (t < m.from || t > m.start) Ask(node, t);
    return m.start - t < period_ ? m.start : kNever;
  }
  /// True: a packet that is offered at t may leave in this step. False: the next packet would
  /// replace it, so it need not be made. Always true for rules that adapt: only the modem knows.
  bool Due(int node, TimeNs t) { return adapts_ || Start(node, t) != kNever; }

 private:
  /// Next(from') is `start` for every from' between the two.
  struct Memo {
    TimeNs from = kNever, start = kNever;
  };
  void Ask(int node, TimeNs t);

  std::unique_ptr<MediumAccess> access_;
  TimeNs period_;
  bool adapts_;
  std::vector<Memo> memos_;
};

}  // namespace stg::acoustics
