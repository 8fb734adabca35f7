#include "stg_agent/inbox/inbox.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "auv_common/error.hpp"
#include "stg_agent/graph/features.hpp"

namespace stg::agent {

Inbox::Inbox(SharedConstants constants, int id)
    : constants_(std::move(constants)),
      id_(id),
      target_(constants_->model.target.of(id)),
      filter_(TargetFilters().Make(constants_->model.track.filter, constants_->model, id_)),
      localizer_(MakeLocalizer(constants_->model, id_)) {
  if (id < 0 || id >= constants_->model.run.agents) {
    throw std::invalid_argument("agent index outside the swarm");
  }
}

void Inbox::Reset(std::uint32_t episode, const dynamics::Cue& cue) {
  filter_->Clear();
  if (localizer_ != nullptr) localizer_->Reset();
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
  if (!Finite(detection.p_WT) || !Finite(detection.p_WO) ||
      !std::isfinite(detection.std_m + detection.p_WO_std_m + detection.heading_std_rad +
                     detection.range_m + detection.range_std_m + detection.azimuth_rad +
                     detection.elevation_rad + detection.bearing_std_rad +
                     detection.mirror_azimuth_rad)) {
    throw std::invalid_argument("non-finite target detection");
  }
  if (detection_pending_ && detection.stamp <= detection_.stamp) return;
  detection_ = detection;
  detection_pending_ = true;
}

std::optional<NeighbourState> Inbox::Receive(const acoustics::Reception& reception) {
  try {
    const acoustics::ByteView& bytes = reception.payload;
    Vec3<double> near;
    if (localizer_ != nullptr) {
      const int source = PacketCodec::SourceOf(bytes.data, bytes.size);
      if (source >= 0 && source < constants_->model.members()) near = localizer_->NearTo(source);
    }
    NeighbourState state =
        constants_->codec.Decode(bytes.data, bytes.size, reception.arrival, near);
    if (localizer_ != nullptr) {
      localizer_->Hear(state, reception);
      if (state.source >= constants_->model.run.agents) return {};  // a station
      ToOwnFrame(&state);
    }
    if (state.has_target && state.target == target_) filter_->Hear(state);
    return state;
  } catch (const UserError&) {
    ++refused_packets_;  // what comes from the water may be damaged
    return {};
  }
}

void Inbox::ToOwnFrame(NeighbourState* state) const {
  const PlaneError now = localizer_->relative(state->source, state->generation);
  state->p_W = state->p_W - Vec3<double>{now.x, now.y, 0.0};
  state->position_std_m = now.std_m();
  for (int k = 0; k < state->sightings; ++k) {
    dynamics::Detection& d = state->sighting[static_cast<std::size_t>(k)];
    const PlaneError then = localizer_->relative(state->source, d.stamp);
    const Vec3<double> shift{then.x, then.y, 0.0};
    d.p_WO = d.p_WO - shift;
    d.p_WT = d.p_WT - shift;
    d.p_WO_std_m = then.std_m();
  }
}

void Inbox::Advance(TimeNs now, const NeighbourTable& neighbours, const OwnReckoning& own) {
  now_ = now;
  own_ = own;
  OwnFrame frame{own.position_std_m};
  if (localizer_ != nullptr) {
    localizer_->Advance(now, own);
    frame.error = localizer_->own();
  }
  if (cue_pending_) {
    filter_->Start(cue_.p_WT, cue_.std_m, 0);
    cue_pending_ = false;
  }
  filter_->Predict(now_);
  // A fixed order, whatever order the messages came in: shared estimates by index, then the
  // own detection.
  if (neighbours.unread()) FuseNewest(neighbours);
  if (detection_pending_ && detection_.stamp <= now_) {
    filter_->Detect(detection_);
    detection_pending_ = false;
  }
  filter_->Settle(now_, frame);
}

void Inbox::FuseNewest(const NeighbourTable& neighbours) {
  for (const int id : neighbours.known()) {
    const NeighbourState& s = neighbours.state(id);
    if (neighbours.unread(id) && s.target == target_) filter_->Fuse(s);
  }
}

TargetView<double> Inbox::Target(double freshness_s) const {
  const TargetEstimate e = filter_->estimate();
  const TargetBelief b = filter_->belief();
  const bool current = b.observed && Seconds(now_ - b.information) <= freshness_s;
  return {e.p_WT, e.v_WT, e.pp, b.started ? 1.0 : 0.0, current ? 1.0 : 0.0};
}

Packet Inbox::MakePacket(const Knowledge<double>& k) const {
  NeighbourState state;
  state.source = id_;
  state.generation = now_;
  state.p_W = k.p_WB;
  state.v_W = k.v_WB;
  state.confidence = k.confidence;
  state.tracking_error = k.error;
  state.phase = PhaseOf(constants_->model.observation, k);
  state.link_quality = k.mean_quality;
  state.position_std_m = own_.position_std_m;
  state.target = target_;
  filter_->Tell(k.lost > 0.5, &state);
  if (localizer_ != nullptr) localizer_->Tell(&state);
  return constants_->codec.Encode(state);
}

}  // namespace stg::agent
