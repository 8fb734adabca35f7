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
#include "stg_agent/inbox/confirmation.hpp"
#include "stg_agent/inbox/unlabelled_input.hpp"
#include "stg_agent/localization/localizer.hpp"
#include "stg_agent/localization/surfacing.hpp"

namespace stg::agent {

/// Takes the cue, own detections and received packets of one AUV in one environment, and writes its
/// packet. It contains everything that happens at different times in different environments. The
/// arithmetic that all environments share is in Mind, and the neighbours' states are in
/// Neighbourhood.
///
/// It estimates the target that is assigned to the AUV. With task.assignment free, it estimates
/// every target, and `target` is the one that the AUV follows.
///
/// The result does not depend on the order of input between two calls of Advance. It is
/// deterministic and allocates nothing after construction.
class Inbox {
 public:
  Inbox(SharedConstants constants, int id);

  /// Starts an episode and forgets everything. The cue was true at time 0.
  void Reset(std::uint32_t episode, const dynamics::Cue& cue);
  /// Adds a cue of another target. A cue of a target that it does not estimate is ignored.
  void AddCue(const dynamics::Cue& cue);

  /// Takes an own detection. Advance uses the newest one of each target. A detection of a target
  /// that it does not estimate is ignored. If detections are not labelled, Advance uses all of them
  /// and finds out the targets (UnlabelledInput). One that is not finite is a bug of the caller and
  /// throws std::invalid_argument.
  void Detect(const dynamics::Detection& detection);

  /// Takes a packet that the modem received, and returns the state in it. A packet that cannot be
  /// decoded is counted, and its state has the source -1. A station's packet has a source after the
  /// last AUV.
  NeighbourState Receive(const acoustics::Reception& reception);

  /// Takes the answer to an own ping of another member of the network.
  void HearAnswer(const acoustics::Reception& answer) {
    if (localizer_ != nullptr) localizer_->HearAnswer(answer);
  }

  /// Follows another target from the next Advance on. A target that it does not estimate is
  /// ignored.
  void Follow(int target);

  /// Brings the estimates to time `now`, with all input.
  /// @param neighbours whose unread target estimates are taken
  void Advance(TimeNs now, const NeighbourTable& neighbours, const OwnReckoning& own = {});

  /// The target at the last Advance.
  /// @param freshness_s information older than this is not current
  TargetView<double> Target(double freshness_s) const;

  /// The packet for the neighbours.
  /// @param knowledge at the time of the last Advance
  Packet MakePacket(const Knowledge<double>& knowledge) const;

  int id() const { return id_; }
  /// Target that this AUV follows.
  int target() const { return target_; }
  /// Number of estimated targets, and index of the first one.
  int beliefs() const { return static_cast<int>(filters_.size()); }
  int first_target() const { return first_; }
  std::uint32_t episode() const { return episode_; }
  /// Time of the last Advance.
  TimeNs now() const { return now_; }
  /// The target at the last Advance, in the frame of the own navigation.
  TargetEstimate estimate() const { return Of(target_).estimate(); }
  /// The same in the true world frame, with the uncertainty of the own navigation added.
  TargetBelief belief() const { return Of(target_).belief(); }
  /// The same for any estimated target.
  TargetEstimate estimate(int target) const { return Of(target).estimate(); }
  TargetBelief belief(int target) const { return Of(target).belief(); }
  /// Time of the newest own detection that a target got from unlabelled ones; -1: none.
  TimeNs own_detection(int target) const {
    return unlabelled_ ? unlabelled_->own_detection(target) : -1;
  }
  /// Estimates the errors of reckoned positions; null: none is chosen.
  const Localizer* localizer() const { return localizer_.get(); }
  /// Decides when the AUV surfaces for a fix; null: it never does.
  const Surfacing* surfacing() const { return surfacing_ ? &*surfacing_ : nullptr; }
  /// Number of packets of this episode that could not be decoded.
  std::uint64_t refused_packets() const { return refused_packets_; }

 private:
  /// Input about a target that is not in its estimate yet.
  struct Pending {
    dynamics::Cue cue;
    dynamics::Detection detection;
    bool has_cue = false, has_detection = false;
  };
  bool Believes(int target) const { return target >= first_ && target < first_ + beliefs(); }
  std::size_t IndexOf(int target) const { return static_cast<std::size_t>(target - first_); }
  const TargetFilter& Of(int target) const { return *filters_[IndexOf(target)]; }
  NeighbourState Decode(const acoustics::Reception& reception);
  void Hear(const NeighbourState& state);
  void FuseNewest(const NeighbourTable& neighbours);
  /// Transforms another AUV's report from its frame to the own frame.
  void ToOwnFrame(NeighbourState* state) const;
  void TellFreely(bool lost, NeighbourState* state) const;

  SharedConstants constants_;
  int id_, first_, target_;
  bool changed_ = false;  // the target is another one than at the previous Advance
  int wanted_ = -1;       // target to follow from the next Advance on; -1: no change
  std::vector<std::unique_ptr<TargetFilter>> filters_;  // of targets first_, first_ + 1, ...
  std::vector<Pending> pending_;                        // likewise
  std::vector<Confirmation> confirmations_;             // likewise, of labelled detections
  std::unique_ptr<Localizer> localizer_;                // null: none is chosen
  std::optional<Surfacing> surfacing_;
  std::optional<UnlabelledInput> unlabelled_;  // not with labelled detections
  TimeNs now_ = 0;
  OwnReckoning own_;
  std::uint32_t episode_ = 0;
  std::uint64_t refused_packets_ = 0;
};

}  // namespace stg::agent
