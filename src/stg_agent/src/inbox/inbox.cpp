#include "stg_agent/inbox/inbox.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "auv_common/error.hpp"
#include "stg_agent/graph/features.hpp"

namespace stg::agent {

Inbox::Inbox(SharedConstants constants, int id)
    : constants_(std::move(constants)),
      id_(id),
      first_(constants_->model.task.free() ? 0 : constants_->model.target.of(id)),
      target_(constants_->model.target.of(id)),
      pending_(static_cast<std::size_t>(constants_->model.beliefs())),
      confirmations_(static_cast<std::size_t>(constants_->model.beliefs()),
                     Confirmation(constants_->model)),
      localizer_(MakeLocalizer(constants_->model, id_)) {
  if (!constants_->model.sensing.labelled) unlabelled_.emplace(constants_->model, id_);
  if (constants_->model.surfaces()) surfacing_.emplace(constants_->model, id_);
  for (int k = 0; k < constants_->model.beliefs(); ++k) {
    filters_.push_back(MakeFilter(constants_->model, id_));
  }
  if (id < 0 || id >= constants_->model.run.agents) {
    throw std::invalid_argument("agent index outside the swarm");
  }
}

void Inbox::Reset(std::uint32_t episode, const dynamics::Cue& cue) {
  for (auto& filter : filters_) filter->Clear();
  if (localizer_ != nullptr) localizer_->Reset();
  if (surfacing_) surfacing_->Reset();
  if (unlabelled_) unlabelled_->Clear();
  for (Pending& pending : pending_) pending = Pending();
  for (Confirmation& confirmation : confirmations_) confirmation.Clear();
  target_ = constants_->model.target.of(id_);
  changed_ = false;
  wanted_ = -1;
  AddCue(cue);
  now_ = 0;
  episode_ = episode;
  refused_packets_ = 0;
}

void Inbox::AddCue(const dynamics::Cue& cue) {
  if (!Believes(cue.target)) return;
  pending_[IndexOf(cue.target)].cue = cue;
  pending_[IndexOf(cue.target)].has_cue = true;
}

void Inbox::Follow(int target) {
  if (Believes(target)) wanted_ = target;
}

void Inbox::Detect(const dynamics::Detection& detection) {
  if (!unlabelled_ && !Believes(detection.target)) return;
  if (!Finite(detection.p_WT) || !Finite(detection.p_WO) ||
      !std::isfinite(detection.std_m + detection.p_WO_std_m + detection.heading_std_rad +
                     detection.range_m + detection.range_std_m + detection.azimuth_rad +
                     detection.elevation_rad + detection.bearing_std_rad +
                     detection.mirror_azimuth_rad)) {
    throw std::invalid_argument("non-finite target detection");
  }
  if (unlabelled_) {
    unlabelled_->Detect(detection);
    return;
  }
  Pending& pending = pending_[IndexOf(detection.target)];
  if (pending.has_detection && detection.stamp <= pending.detection.stamp) return;
  pending.detection = detection;
  pending.has_detection = true;
}

NeighbourState Inbox::Receive(const acoustics::Reception& reception) {
  NeighbourState state = Decode(reception);
  if (state.source < 0) return state;
  if (localizer_ != nullptr) {
    localizer_->Hear(state, reception);
    if (state.source >= constants_->model.run.agents) return state;  // a station
    if (surfacing_) surfacing_->Hear(state);
    ToOwnFrame(&state);
  }
  if (state.has_target) Hear(state);
  return state;
}

NeighbourState Inbox::Decode(const acoustics::Reception& reception) {
  const acoustics::ByteView& bytes = reception.payload;
  Vec3<double> near;
  if (localizer_ != nullptr) {
    const int source = PacketCodec::SourceOf(bytes.data, bytes.size);
    if (source >= 0 && source < constants_->model.members()) near = localizer_->NearTo(source);
  }
  try {
    return constants_->codec.Decode(bytes.data, bytes.size, reception.arrival, near);
  } catch (const UserError&) {
    ++refused_packets_;  // a packet may be damaged on its way
  }
  NeighbourState none;
  none.source = -1;
  return none;
}

void Inbox::ToOwnFrame(NeighbourState* state) const {
  const PlaneError now = localizer_->relative(state->source, state->generation);
  state->p_W = state->p_W - Vec3<double>{now.x, now.y, 0.0};
  state->position_std_m = now.std_m();
  for (dynamics::Detection& d : state->sightings) {
    const PlaneError then = localizer_->relative(state->source, d.stamp);
    const Vec3<double> shift{then.x, then.y, 0.0};
    d.p_WO = d.p_WO - shift;
    d.p_WT = d.p_WT - shift;
    d.p_WO_std_m = then.std_m();
  }
}

void Inbox::Hear(const NeighbourState& state) {
  if (unlabelled_) {
    unlabelled_->Hear(state);
    return;
  }
  if (!constants_->model.task.free()) {
    if (state.target == target_) filters_.front()->Hear(state);
    return;
  }
  NeighbourState part = state;
  for (int k = 0; k < beliefs(); ++k) {
    part.sightings.clear();
    for (const dynamics::Detection& d : state.sightings) {
      if (d.target == k) part.sightings.push_back(d);
    }
    if (!part.sightings.empty()) filters_[static_cast<std::size_t>(k)]->Hear(part);
  }
}

void Inbox::Advance(TimeNs now, const NeighbourTable& neighbours, const OwnReckoning& own) {
  now_ = now;
  own_ = own;
  OwnFrame frame{own.position_std_m};
  if (localizer_ != nullptr) {
    localizer_->Advance(now, own);
    frame.error = localizer_->own();
    if (surfacing_) surfacing_->Advance(now, own.p_WB, *localizer_);
  }
  changed_ = wanted_ >= 0 && wanted_ != target_;
  if (changed_) target_ = wanted_;
  wanted_ = -1;
  for (std::size_t k = 0; k < filters_.size(); ++k) {
    if (pending_[k].has_cue) filters_[k]->Start(pending_[k].cue.p_WT, pending_[k].cue.std_m, 0);
    pending_[k].has_cue = false;
    filters_[k]->Predict(now_);
  }
  // The order is fixed, for any order of the messages: shared estimates by index, then the own
  // detection.
  if (neighbours.unread()) FuseNewest(neighbours);
  if (unlabelled_) unlabelled_->Give(now_, &filters_);
  for (std::size_t k = 0; k < filters_.size(); ++k) {
    Pending& pending = pending_[k];
    if (pending.has_detection && pending.detection.stamp <= now_) {
      if (confirmations_[k].Take(pending.detection)) filters_[k]->Detect(pending.detection);
      pending.has_detection = false;
    }
    filters_[k]->Settle(now_, frame);
  }
}

void Inbox::FuseNewest(const NeighbourTable& neighbours) {
  for (const int id : neighbours.known()) {
    const NeighbourState& s = neighbours.state(id);
    if (neighbours.unread(id) && Believes(s.target)) filters_[IndexOf(s.target)]->Fuse(s);
  }
}

/// Writes the newest measurements of each target's own filter, newest first. At the same time,
/// those of the followed target come first.
void Inbox::TellFreely(bool lost, NeighbourState* state) const {
  state->followed = target_;
  Of(target_).Tell(lost, state);
  const auto before = [this](const dynamics::Detection& a, const dynamics::Detection& b) {
    if (a.stamp != b.stamp) return a.stamp > b.stamp;
    if ((a.target == target_) != (b.target == target_)) return a.target == target_;
    return a.target < b.target;
  };
  for (int k = 0; k < beliefs(); ++k) {
    if (k == target_) continue;
    NeighbourState part;
    part.generation = state->generation;
    filters_[static_cast<std::size_t>(k)]->Tell(false, &part);
    for (const dynamics::Detection& d : part.sightings) {
      int rank = state->sightings.size();
      while (rank > 0 && before(d, state->sightings[rank - 1])) --rank;
      if (rank < kFreeSightings) state->sightings.insert(rank, d);
    }
  }
  state->has_target = state->has_target || !state->sightings.empty();
}

TargetView<double> Inbox::Target(double freshness_s) const {
  const TargetEstimate e = estimate();
  const TargetBelief b = belief();
  const bool current = b.observed && Seconds(now_ - b.information) <= freshness_s;
  return {e.p_WT, e.v_WT, e.pp, b.started ? 1.0 : 0.0, current ? 1.0 : 0.0, changed_ ? 1.0 : 0.0};
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
  if (constants_->model.task.free()) {
    TellFreely(k.lost > 0.5, &state);
  } else {
    filters_.front()->Tell(k.lost > 0.5, &state);
  }
  if (localizer_ != nullptr) localizer_->Tell(&state);
  if (surfacing_) state.surfacing = surfacing_->announces();
  return constants_->codec.Encode(state);
}

}  // namespace stg::agent
