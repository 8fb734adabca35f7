#include "stg_agent/agent/agent_lanes.hpp"

#include <algorithm>
#include <stdexcept>

namespace stg::agent {
namespace {

template <class T>
Mask<T> AllLanes() {
  return T(0.0) == T(0.0);
}

template <class T>
bool InMask(const Mask<T>& mask, int lane) {
  return Lane(Select(mask, T(1.0), T(0.0)), lane) != 0.0;
}

/// The clock of each lane [ns]. Whole nanoseconds below 2^53 are exact.
template <class T>
T Nanoseconds(const PerLane<T, TimeNs>& stamp) {
  T now;
  for (int lane = 0; lane < kLanesOf<T>; ++lane) {
    SetLane(&now, lane, static_cast<double>(OfLane(stamp, lane)));
  }
  return now;
}

}  // namespace

template <class T>
LanedAgent<T>::LanedAgent(const SharedConstants& constants, int id)
    : constants_(constants),
      links_(acoustics::MakeLinkEstimator(constants->model.channel, constants->model.run.agents)),
      neighbours_(constants->model, id),
      mind_(constants->model),
      memory_(static_cast<std::size_t>(kLanesOf<T>)),
      sights_before_(neighbours_.sights()),
      mind_before_(mind_) {
  if (constants->model.track.search_cell_m > 0.0) {
    search_.resize(static_cast<std::size_t>(kLanesOf<T>), SearchMemory(constants->model));
  }
  inboxes_.reserve(static_cast<std::size_t>(kLanesOf<T>));
  for (int lane = 0; lane < kLanesOf<T>; ++lane) inboxes_.emplace_back(constants, id);
  answers_.resize(inboxes_.size(), PingAnswers(constants->model));
}

template <class T>
void LanedAgent<T>::Reset(int lane, std::uint32_t episode, const dynamics::Cue& cue) {
  At(lane).Reset(episode, cue);
  answers_[static_cast<std::size_t>(lane)].Clear();
  SetLane(&present_, lane, 1.0);
  links_->Reset(lane);
  neighbours_.Clear(lane);
  mind_.Reset(lane);
  memory_[static_cast<std::size_t>(lane)] = EntityMemory();
  if (!search_.empty() && cue.target == inbox(lane).target()) {
    search_[static_cast<std::size_t>(lane)].Start(cue);
  }
}

template <class T>
void LanedAgent<T>::Detect(int lane, const dynamics::Detection& detection) {
  if (!present(lane)) return;
  const bool labelled = model().sensing.labelled;
  if (labelled && detection.target >= 0 && detection.target < model().target.count) {
    if (!search_.empty() && detection.target == inbox(lane).target()) {
      search_[static_cast<std::size_t>(lane)].Detect(detection);
    }
    TimeNs& newest = memory_[static_cast<std::size_t>(lane)]
                         .own_detection[static_cast<std::size_t>(detection.target)];
    newest = std::max(newest, detection.stamp);
  }
  At(lane).Detect(detection);
}

template <class T>
void LanedAgent<T>::Receive(int lane, const acoustics::Reception& reception) {
  if (!present(lane)) return;
  if (reception.payload.size == 0) {
    if (reception.source < model().members()) {
      At(lane).HearAnswer(reception);
    } else {
      answers_[static_cast<std::size_t>(lane)].Keep(reception);
    }
    return;
  }
  if (reception.source < model().run.agents) links_->Learn(lane, reception);
  neighbours_.Update(lane, At(lane).Receive(reception));
}

template <class T>
void LanedAgent<T>::Observe(const dynamics::Navigation<T>& nav) {
  Think(nav, AllLanes<T>());
}

template <class T>
void LanedAgent<T>::Observe(const dynamics::Navigation<T>& nav, const Mask<T>& lanes) {
  sights_before_ = neighbours_.sights();
  mind_before_ = mind_;
  Think(nav, lanes);
  neighbours_.KeepOthers(lanes, sights_before_);
  mind_.KeepOthers(lanes, mind_before_);
}

template <class T>
void LanedAgent<T>::Think(const dynamics::Navigation<T>& nav, const Mask<T>& lanes) {
  T finite = NonFiniteness(nav.p_WB) + NonFiniteness(nav.v_WB_B) + NonFiniteness(nav.w_WB_B);
  for (const T& q : nav.q_WB) finite += NonFiniteness(q);
  if (Any(!(finite == T(0.0)))) throw std::invalid_argument("non-finite navigation state");
  const Mask<T> past = neighbours_.Age(Nanoseconds<T>(nav.stamp)) && lanes;
  if (Any(past)) {
    for (int lane = 0; lane < kLanesOf<T>; ++lane) {
      if (InMask<T>(past, lane)) neighbours_.Forget(lane, OfLane(nav.stamp, lane));
    }
  }
  TargetView<T> target;
  const T taking_part = Select(lanes, T(1.0), T(0.0));
  for (int lane = 0; lane < kLanesOf<T>; ++lane) {
    if (Lane(taking_part, lane) == 0.0) continue;
    Follow(lane, OfLane(nav.stamp, lane));
    if (model().fleet.changes()) Attend(lane, OfLane(nav.stamp, lane));
    const OwnReckoning own{Lane(nav.p_WB, lane),
                           Lane(nav.position_std_m, lane),
                           OfLane(nav.fix_stamp, lane),
                           Lane(nav.p_WF, lane),
                           Lane(nav.fix_std_m, lane),
                           {Lane(nav.q_WB[0], lane), Lane(nav.q_WB[1], lane),
                            Lane(nav.q_WB[2], lane), Lane(nav.q_WB[3], lane)}};
    answers_[static_cast<std::size_t>(lane)].Give(
        OfLane(nav.stamp, lane), own, Lane(nav.heading_std_rad, lane),
        [this, lane](const dynamics::Detection& detection) { Detect(lane, detection); });
    At(lane).Advance(OfLane(nav.stamp, lane), neighbours(lane), own);
    neighbours_.MarkRead(lane);
    EntityMemory& memory = memory_[static_cast<std::size_t>(lane)];
    memory.now = OfLane(nav.stamp, lane);
    if (!model().sensing.labelled) {
      for (int k = 0; k < inbox(lane).beliefs(); ++k) {
        memory.own_detection[static_cast<std::size_t>(k)] = inbox(lane).own_detection(k);
      }
    }
    memory.position_std_m = Lane(nav.position_std_m, lane);
    if (!search_.empty()) {
      search_[static_cast<std::size_t>(lane)].Update(memory.now, Lane(nav.p_WB, lane),
                                                     neighbours(lane));
    }
    SetLaneOf(&target, lane, inbox(lane).Target(links_->freshness_s()));
  }
  mind_.SetNavigation(nav);
  mind_.SetTracking(model(), target);
  neighbours_.Predict(nav.p_WB, *links_);
  mind_.SetNeighbours(
      model(), SeeNeighbours<T>(model(), id(), neighbours_.sights(), target.p_WT, mind_.knowledge));
}

template <class T>
void LanedAgent<T>::Follow(int lane, TimeNs now) {
  EntityMemory& memory = memory_[static_cast<std::size_t>(lane)];
  if (memory.follow >= 0 && memory.follow != inbox(lane).target()) {
    At(lane).Follow(memory.follow);
    memory.followed_since = now;
  }
  memory.follow = -1;
}

template <class T>
void LanedAgent<T>::Attend(int lane, TimeNs now) {
  const bool there = model().fleet.present(id(), Seconds(now));
  if (there && !present(lane)) {
    dynamics::Cue none;
    none.target = -1;
    Reset(lane, inbox(lane).episode(), none);
  }
  SetLane(&present_, lane, there ? 1.0 : 0.0);
}

template <class T>
Vec3<T> LanedAgent<T>::Act(const T* action) {
  T finite(0.0);
  for (int k = 0; k < model().control.action_size(); ++k) finite += NonFiniteness(action[k]);
  if (Any(!(finite == T(0.0)))) throw std::invalid_argument("non-finite action");
  if (!model().fleet.changes() && !model().surfaces()) return mind_.Act(model(), action);
  T wanted[dynamics::kMaxActionSize];
  for (int k = 0; k < model().control.action_size(); ++k) wanted[k] = action[k];
  if (model().surfaces()) Surface(wanted);
  for (int k = 0; k < model().control.action_size(); ++k) {
    wanted[k] = Select(present_ > T(0.5), wanted[k], T(0.0));
  }
  return mind_.Act(model(), wanted);
}

/// Sets the vertical velocity of an AUV that is on its way to the surface for a fix, or back. The
/// policy does not control it then.
template <class T>
void LanedAgent<T>::Surface(T* action) const {
  for (int lane = 0; lane < kLanesOf<T>; ++lane) {
    const Surfacing& surfacing = *inbox(lane).surfacing();
    if (surfacing.under_way()) SetLane(&action[2], lane, surfacing.climb_share());
  }
}

template <class T>
Packet LanedAgent<T>::MakePacket(int lane) const {
  return inbox(lane).MakePacket(LaneOf(mind_.knowledge, lane));
}

template <class T>
AgentView LanedAgent<T>::view(int lane) const {
  return {model(),
          inbox(lane),
          neighbours(lane),
          mind_,
          neighbours_.sights(),
          lane,
          &memory_[static_cast<std::size_t>(lane)],
          search_.empty() ? nullptr : &search_[static_cast<std::size_t>(lane)]};
}

template class LanedAgent<double>;
template class LanedAgent<Pack>;

}  // namespace stg::agent
