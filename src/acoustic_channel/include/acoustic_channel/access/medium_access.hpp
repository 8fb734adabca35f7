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

/// The rule by which the modems of a network share the water. Times count from the start of the
/// episode. What a rule draws must depend on seed, episode, node and time only, so that whoever
/// asks, in whatever order, gets the same answer.
class MediumAccess {
 public:
  virtual ~MediumAccess() = default;

  /// Starts an episode.
  virtual void Reset(std::uint64_t /*seed*/, std::uint32_t /*episode*/) {}

  /// For every node the time in [from, until) at which a packet that waits in its modem begins to
  /// leave; kNever: it goes on waiting.
  /// @param start one entry per node, overwritten.
  virtual void Plan(TimeNs from, TimeNs until, std::vector<TimeNs>* start) const = 0;

  /// Why the rule cannot work with the section and the clock of the run; nothing: it can.
  virtual std::optional<config::Violation> FindConflict() const { return {}; }
};

/// All rules, by the name that `channel.access` takes.
using MediumAccessRegistry = Registry<MediumAccess, const ChannelConfig&, const RunConfig&>;
MediumAccessRegistry& MediumAccesses();

/// The rule that the section names, for the nodes and the clock of the run. Throws UserError.
std::unique_ptr<MediumAccess> MakeMediumAccess(const ChannelConfig& config, const RunConfig& run);

/// The plan of the present step, made when first asked for.
class Turns {
 public:
  /// Throws UserError for an unknown rule.
  Turns(const ChannelConfig& config, const RunConfig& run);

  void Reset(std::uint64_t seed, std::uint32_t episode);

  /// When `node` begins to send in the step from t to the next decision; kNever: not in it.
  TimeNs Start(int node, TimeNs t) {
    if (t != planned_) Plan(t);
    return start_[static_cast<std::size_t>(node)];
  }
  /// A packet offered at t leaves in this step. False: the next one replaces it, and it need not
  /// be made.
  bool Due(int node, TimeNs t) { return Start(node, t) != kNever; }

 private:
  void Plan(TimeNs t);

  std::unique_ptr<MediumAccess> access_;
  TimeNs period_, planned_ = kNever;
  std::vector<TimeNs> start_;
};

}  // namespace stg::acoustics
