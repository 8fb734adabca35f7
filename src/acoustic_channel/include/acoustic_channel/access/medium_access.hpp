#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "auv_common/config/field.hpp"
#include "auv_common/config/run_config.hpp"
#include "auv_common/registry.hpp"

/// Medium access: when a modem lets go of the packet that waits in it.
namespace stg::acoustics {

struct ChannelConfig;

inline constexpr TimeNs kNever = std::numeric_limits<TimeNs>::max();

/// What a modem knows when it asks its rule.
struct Attempt {
  std::uint32_t sequence = 0;  ///< of the packet that waits, as it will leave
  std::uint32_t tries = 0;     ///< times that this packet found the medium busy
  TimeNs last_end = kNever;    ///< its last transmission ended; kNever: there was none
};

/// What a modem needs for the longest packet of the network; nothing on ideal channels.
struct PacketTime {
  TimeNs airtime = 0, turnaround = 0;
};

/// The rule by which the modems of a network share the water, in continuous time. Times count from
/// the start of the episode. What a rule draws must depend on seed, episode and its arguments only,
/// so that calls in any order give the same answer. Nothing is allocated.
class MediumAccess {
 public:
  virtual ~MediumAccess() = default;

  /// Starts an episode.
  virtual void Reset(std::uint64_t /*seed*/, std::uint32_t /*episode*/) {}

  /// Earliest time, not before `from`, at which a packet that waits in the modem of `node` may
  /// begin to leave. Asked again with a `from` up to that time, it answers the same.
  virtual TimeNs Next(int node, TimeNs from, const Attempt& attempt) const = 0;

  /// True: a modem that hears a carrier at that time does not begin, counts one more try and asks
  /// again from there. On ideal channels no modem hears any.
  virtual bool listens() const { return false; }

  /// True: the answer of Next depends on the attempt, so that only the modem can know it.
  virtual bool adapts() const { return listens(); }

  /// Why the rule cannot work with the section, the clock of the run and such packets; nothing: it
  /// can.
  virtual std::optional<config::Violation> FindConflict(const PacketTime& /*packet*/) const {
    return {};
  }
};

/// All rules, by the name that `channel.access` takes.
using MediumAccessRegistry = Registry<MediumAccess, const ChannelConfig&, const RunConfig&>;
MediumAccessRegistry& MediumAccesses();

/// The rule that the section names, for the nodes and the clock of the run. Throws UserError.
std::unique_ptr<MediumAccess> MakeMediumAccess(const ChannelConfig& config, const RunConfig& run);

/// When packets that are offered at decisions can leave, as anybody may know it: the modem, and an
/// agent that would not make a packet in vain.
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
  /// A packet offered at t may leave in this step. False: the next one replaces it, and it need not
  /// be made. Of a rule that adapts only the modem knows: always true.
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
