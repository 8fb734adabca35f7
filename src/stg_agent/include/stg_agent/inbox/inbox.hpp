#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "acoustic_channel/channel/channel.hpp"
#include "auv_dynamics/measurements.hpp"
#include "stg_agent/estimation/target_filter.hpp"
#include "stg_agent/graph/knowledge.hpp"
#include "stg_agent/graph/neighbour_table.hpp"
#include "stg_agent/graph/target_view.hpp"
#include "stg_agent/inbox/agent_constants.hpp"
#include "stg_agent/localization/localizer.hpp"

namespace stg::agent {

/// What comes in to one AUV in one environment: the cue, its own detections, its neighbours'
/// packets; and what goes out to them. What happens at different times in different environments is
/// here; the arithmetic that all of them share is in Mind, and the neighbours' states are in
/// Neighbourhood.
///
/// The result does not depend on the order in which things come in between two Advances.
/// Deterministic; allocates nothing after construction.
class Inbox {
 public:
  Inbox(SharedConstants constants, int id);

  /// Starts an episode: forgets everything. The cue was true at time 0.
  void Reset(std::uint32_t episode, const dynamics::Cue& cue);

  /// Own detection; of another target than this AUV's: ignored. The newest before the next
  /// Advance counts. A non-finite one throws std::invalid_argument: a bug of the caller.
  void Detect(const dynamics::Detection& detection);

  /// A packet that the modem gave: the state that it holds. One that does not decode is counted,
  /// and holds none.
  std::optional<NeighbourState> Receive(const acoustics::Reception& reception);

  /// Brings the target track to time `now`, with all that came in.
  /// @param neighbours whose unread target estimates are taken
  void Advance(TimeNs now, const NeighbourTable& neighbours, const OwnReckoning& own = {});

  /// The target as of the last Advance.
  /// @param freshness_s information older than this is not current
  TargetView<double> Target(double freshness_s) const;

  /// What to tell the neighbours.
  /// @param knowledge of the same time as the last Advance
  Packet MakePacket(const Knowledge<double>& knowledge) const;

  int id() const { return id_; }
  /// Target this AUV is tasked with.
  int target() const { return target_; }
  std::uint32_t episode() const { return episode_; }
  /// Time of the last Advance.
  TimeNs now() const { return now_; }
  /// The target in the frame of the own navigation, as of the last Advance.
  TargetEstimate estimate() const { return filter_->estimate(); }
  /// The same in the true world frame, with what the own navigation adds to its deviation.
  TargetBelief belief() const { return filter_->belief(); }
  /// What it knows of the errors of reckoned positions; null: nothing.
  const Localizer* localizer() const { return localizer_.get(); }
  /// Packets of this episode that did not decode.
  std::uint64_t refused_packets() const { return refused_packets_; }

 private:
  void FuseNewest(const NeighbourTable& neighbours);
  /// Turns what another AUV reported from its frame into the own one.
  void ToOwnFrame(NeighbourState* state) const;

  SharedConstants constants_;
  int id_, target_;
  std::unique_ptr<TargetFilter> filter_;
  std::unique_ptr<Localizer> localizer_;  // null: none is chosen
  dynamics::Cue cue_;
  dynamics::Detection detection_;
  bool cue_pending_ = false, detection_pending_ = false;
  TimeNs now_ = 0;
  OwnReckoning own_;
  std::uint32_t episode_ = 0;
  std::uint64_t refused_packets_ = 0;
};

}  // namespace stg::agent
