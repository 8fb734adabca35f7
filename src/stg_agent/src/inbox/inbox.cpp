#include "stg_agent/inbox/inbox.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "auv_common/error.hpp"
#include "stg_agent/graph/features.hpp"

namespace stg::agent {
namespace {

/// Oldest target estimate worth sending: the packet's age field ends at 32.767 s.
constexpr TimeNs kOldestShared = 30'000'000'000;

}  // namespace

Inbox::Inbox(SharedConstants constants, int id)
    : constants_(std::move(constants)),
      id_(id),
      target_(constants_->scenario.target_of(id)),
      neighbours_(constants_->scenario, id),
      track_(constants_->scenario) {
  if (id < 0 || id >= constants_->scenario.agents) {
    throw std::invalid_argument("agent index outside the swarm");
  }
}

void Inbox::Reset(std::uint32_t episode, const dynamics::Cue& cue) {
  neighbours_.Clear();
  track_.Clear();
  cue_ = cue;
  cue_pending_ = cue.target == target_;
  detection_ = dynamics::Detection();
  detection_pending_ = false;
  now_ = 0;
  episode_ = episode;
  refused_packets_ = 0;
}

void Inbox::Detect(const dynamics::Detection& detection) {
  if (detection.target != target_) return;
  if (!Finite(detection.p_WT) || !std::isfinite(detection.std_m)) {
    throw std::invalid_argument("non-finite target detection");
  }
  if (detection_pending_ && detection.stamp <= detection_.stamp) return;
  detection_ = detection;
  detection_pending_ = true;
}

const NeighbourState* Inbox::Receive(const acoustics::Reception& reception) {
  try {
    const NeighbourState state =
        constants_->codec.Decode(reception.payload.data, reception.payload.size, reception.arrival);
    return neighbours_.Update(state) ? &neighbours_.state(state.source) : nullptr;
  } catch (const UserError&) {
    ++refused_packets_;  // what comes from the water may be damaged
    return nullptr;
  }
}

void Inbox::Advance(TimeNs now) {
  now_ = now;
  if (cue_pending_) {
    track_.Start(cue_.p_WT, cue_.std_m, 0);
    cue_pending_ = false;
  }
  track_.Predict(now_);
  // A fixed order, whatever order the messages came in: shared estimates by index, then the
  // own detection.
  if (neighbours_.unread()) TakeSharedEstimates();
  if (detection_pending_ && detection_.stamp <= now_) {
    track_.Detect(detection_);
    detection_pending_ = false;
  }
}

void Inbox::TakeSharedEstimates() {
  for (const int id : neighbours_.known()) {
    const NeighbourState& s = neighbours_.state(id);
    if (neighbours_.unread(id) && s.target == target_ && s.target_stamp <= now_) {
      track_.Fuse({s.target_stamp, s.p_WT, s.v_WT, s.target_std});
    }
  }
  neighbours_.MarkRead();
}

TargetView<double> Inbox::Target(double freshness_s) const {
  const TargetEstimate& e = track_.estimate();
  const bool current =
      track_.observed() && Seconds(now_ - track_.information_stamp()) <= freshness_s;
  return {e.p_WT, e.v_WT, e.pp, track_.started() ? 1.0 : 0.0, current ? 1.0 : 0.0};
}

Packet Inbox::MakePacket(const Knowledge<double>& k) const {
  NeighbourState state;
  state.source = id_;
  state.generation = now_;
  state.p_W = k.p_WB;
  state.v_W = k.v_WB;
  state.confidence = k.confidence;
  state.tracking_error = k.error;
  state.phase = PhaseOf(constants_->scenario.observation, k);
  state.link_quality = k.mean_quality;
  // Only what rests on an observation: everybody has the cue already.
  state.has_target =
      k.lost <= 0.5 && track_.observed() && now_ - track_.information_stamp() <= kOldestShared;
  if (state.has_target) {
    const SharedEstimate& shared = track_.shareable();
    state.target = target_;
    state.target_stamp = shared.stamp;
    state.p_WT = shared.p_WT;
    state.v_WT = shared.v_WT;
    state.target_std = shared.std_m;
  }
  return constants_->codec.Encode(state);
}

}  // namespace stg::agent
