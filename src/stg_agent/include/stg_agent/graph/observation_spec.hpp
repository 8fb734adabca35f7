#pragma once

#include <string>

#include "stg_agent/graph/observation_config.hpp"

/// The layout of the policy input: its numbers and their places. All code that writes, sizes, names
/// or reads observations uses it.
namespace stg::agent {

/// Number of neighbours in the observation.
inline constexpr int kNeighbourSlots = 3;

/// Phase of the task (Eq. 15) and quality of the observation (Eq. 16), both one-hot in the
/// observation.
enum Phase { kSearch, kApproach, kStable, kLost, kPhases };
enum Quality { kHigh, kMedium, kLow, kUnavailable, kQualities };

/// Numbers of z_track (Eq. 14), in their order.
enum TrackingNumber {
  kZDistance,
  kZError,
  kZProgress,
  kZClosing,
  kZMeanError,
  kZConfidence,
  kZLost,
  kZLostSteps,
  kTrackingNumbers
};

/// Numbers of the graph summary (Eqs. 18-19), in their order.
enum GraphNumber {
  kGraphEffective,
  kGraphMeanQuality,
  kGraphBestQuality,
  kGraphNeighbourError,
  kGraphAdvantage,
  kGraphRole,
  kGraphNumbers
};

/// The blocks of an observation, in their order.
enum class Block {
  kPosition,
  kAttitude,
  kVelocity,
  kRates,
  kTargetOffset,
  kNeighbours,
  kWallRoom,
  kTargetVelocity,
  kRelativeVelocity,
  kTargetOffsetBody,
  kRelativeVelocityBody,
  kLineOfSight,
  kForce,
  kTracking,
  kPhase,
  kQuality,
  kClosest,
  kGraph,
};

/// One block: its name, size and content.
struct BlockDescription {
  const char* name;
  int size;
  const char* content;
};
inline constexpr BlockDescription kBlocks[] = {
    {"position", 3, "own position / half extent of the workspace, clipped to 2"},
    {"attitude", 6, "sin and cos of roll, pitch, yaw"},
    {"velocity", 3, "own velocity, body axes / maximum speed"},
    {"rates", 3, "body rates / maximum rate"},
    {"target_offset", 3, "target minus own position / half extent, clipped to 2"},
    {"neighbours", 3 * kNeighbourSlots, "offsets of three neighbours / half extent; 0: none"},
    {"wall_room", 3, "distance to the nearer wall of each axis / half extent"},
    {"target_velocity", 3, "velocity of the target / maximum speed"},
    {"relative_velocity", 3, "target's minus own velocity / maximum speed (Eq. 11)"},
    {"target_offset_body", 3, "target_offset in body axes"},
    {"relative_velocity_body", 3, "relative_velocity in body axes"},
    {"line_of_sight", 3, "unit vector to the target, body axes"},
    {"force", 6, "tau / tau_max of the previous decision; zero where an autopilot steers"},
    {"tracking", kTrackingNumbers, "Eq. 14"},
    {"phase", kPhases, "Eq. 15, one-hot"},
    {"quality", kQualities, "Eq. 16, one-hot"},
    {"closest", 1, "1: no other AUV is closer to the target"},
    {"graph", kGraphNumbers, "Eqs. 18-19"},
};
inline constexpr int kBlockCount = static_cast<int>(sizeof(kBlocks) / sizeof(kBlocks[0]));

/// The blocks that a scenario's observation has.
class ObservationSpec {
 public:
  constexpr explicit ObservationSpec(const ObservationConfig& c)
      : tracking_(c.tracking),
        semantic_(c.semantic),
        graph_(c.graph),
        links_(c.links),
        roles_(c.roles),
        order_(c.order) {}

  /// Size of a block; 0 when the scenario leaves it out.
  constexpr int size(Block block) const {
    return has(block) ? kBlocks[static_cast<int>(block)].size : 0;
  }
  /// Index of a block's first number.
  constexpr int offset(Block block) const {
    int sum = 0;
    for (int b = 0; b < static_cast<int>(block); ++b) sum += size(static_cast<Block>(b));
    return sum;
  }
  /// Size of an observation.
  constexpr int size() const { return offset(static_cast<Block>(kBlockCount)); }

  /// Identifies the layout, e.g. "stg-1:raw+tracking+semantic+graph:nearest": observations with
  /// equal names have the same numbers in the same places. Policy files contain it.
  std::string name() const;

  bool operator==(const ObservationSpec& o) const { return name() == o.name(); }
  bool operator!=(const ObservationSpec& o) const { return !(*this == o); }

 private:
  constexpr bool has(Block block) const {
    switch (block) {
      case Block::kTracking:
        return tracking_;
      case Block::kPhase:
      case Block::kQuality:
      case Block::kClosest:
        return semantic_;
      case Block::kGraph:
        return graph_;
      default:
        return true;
    }
  }

  bool tracking_, semantic_, graph_, links_, roles_;
  NeighbourOrder order_;
};

/// Version of the layout at the beginning of name(), also in recorded steps.
inline constexpr int kLayoutVersion = 1;
/// Size of the largest observation.
inline constexpr int kMaxObservationSize = ObservationSpec(ObservationConfig()).size();

}  // namespace stg::agent
