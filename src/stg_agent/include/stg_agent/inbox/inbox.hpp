#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "acoustic_channel/channel/channel.hpp"
#include "auv_dynamics/measurements.hpp"
#include "stg_agent/estimation/target_filter.hpp"
#include "stg_agent/graph/knowledge.hpp"
#include "stg_agent/graph/neighbour_table.hpp"
#include "stg_agent/graph/target_view.hpp"
#include "stg_agent/inbox/agent_constants.hpp"
#include "stg_agent/localization/localizer.hpp"

namespace stg::agent {

/// Takes what reaches one AUV in one environment, which is the cue, its own detections and the
/// packets of neighbours, and writes the packet that goes out to them. It holds what happens at
/// different times in different environments. The arithmetic that all environments share is in
/// Mind, and the neighbours' states are in Neighbourhood.
///
/// It keeps one belief, of the target that the AUV is tasked with. Where targets are chosen freely
/// (task.assignment), it keeps a belief of every target, and `target` is the one that it follows.
///
/// The result does not depend on the order in which things come in between two calls of Advance. It
/// is deterministic and allocates nothing after construction.
class Inbox {
 public:
  Inbox(SharedConstants constants, int id);

  /// Starts an episode and forgets everything. The cue was true at time 0.
  void Reset(std::uint32_t episode, const dynamics::Cue& cue);
  /// Adds a cue of another target. A cue of a target without a belief is ignored.
  void AddCue(const dynamics::Cue& cue);

  /// Takes an own detection. The newest of each target before the next Advance counts. A detection
  /// of a target without a belief is ignored. One that is not finite is a bug of the caller and
  /// throws std::invalid_argument.
  void Detect(const dynamics::Detection& detection);

  /// Takes a packet that the modem received, and returns the state that it holds. One that does not
  /// decode is counted and holds none.
  std::optional<NeighbourState> Receive(const acoustics::Reception& reception);

  /// Takes the answer to an own ping of another member of the network.
  void HearAnswer(const acoustics::Reception& answer) {
    if (localizer_ != nullptr) localizer_->HearAnswer(answer);
  }

  /// Follows another target from the next Advance on. A target without a belief is ignored.
  void Follow(int target);

  /// Brings the beliefs to time `now`, with all that came in.
  /// @param neighbours whose unread target estimates are taken
  void Advance(TimeNs now, const NeighbourTable& neighbours, const OwnReckoning& own = {});

  /// The target as of the last Advance.
  /// @param freshness_s information older than this is not current
  TargetView<double> Target(double freshness_s) const;

  /// What to tell the neighbours.
  /// @param knowledge of the same time as the last Advance
  Packet MakePacket(const Knowledge<double>& knowledge) const;

  int id() const { return id_; }
  /// Target this AUV is tasked with, or follows.
  int target() const { return target_; }
  /// Beliefs that it keeps, and the target of the first one.
  int beliefs() const { return static_cast<int>(filters_.size()); }
  int first_target() const { return first_; }
  std::uint32_t episode() const { return episode_; }
  /// Time of the last Advance.
  TimeNs now() const { return now_; }
  /// The target in the frame of the own navigation, as of the last Advance.
  TargetEstimate estimate() const { return Of(target_).estimate(); }
  /// The same in the true world frame, with what the own navigation adds to its deviation.
  TargetBelief belief() const { return Of(target_).belief(); }
  /// The same of any target that it keeps a belief of.
  TargetEstimate estimate(int target) const { return Of(target).estimate(); }
  TargetBelief belief(int target) const { return Of(target).belief(); }
  /// What it knows of the errors of reckoned positions; null: nothing.
  const Localizer* localizer() const { return localizer_.get(); }
  /// Packets of this episode that did not decode.
  std::uint64_t refused_packets() const { return refused_packets_; }

 private:
  /// What came in of a target and is not in its belief yet.
  struct Pending {
    dynamics::Cue cue;
    dynamics::Detection detection;
    bool has_cue = false, has_detection = false;
  };
  bool Believes(int target) const { return target >= first_ && target < first_ + beliefs(); }
  std::size_t IndexOf(int target) const { return static_cast<std::size_t>(target - first_); }
  const TargetFilter& Of(int target) const { return *filters_[IndexOf(target)]; }
  void Hear(const NeighbourState& state);
  void FuseNewest(const NeighbourTable& neighbours);
  /// Turns what another AUV reported from its frame into the own one.
  void ToOwnFrame(NeighbourState* state) const;
  void TellFreely(bool lost, NeighbourState* state) const;

  SharedConstants constants_;
  int id_, first_, target_;
  bool changed_ = false;  // it follows another target than at the Advance before
  int wanted_ = -1;       // to follow from the next Advance on; -1: the same
  std::vector<std::unique_ptr<TargetFilter>> filters_;  // of targets first_, first_ + 1, ...
  std::vector<Pending> pending_;                        // likewise
  std::unique_ptr<Localizer> localizer_;                // null: none is chosen
  TimeNs now_ = 0;
  OwnReckoning own_;
  std::uint32_t episode_ = 0;
  std::uint64_t refused_packets_ = 0;
};

}  // namespace stg::agent
