#include "stg_agent/agent/agent.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "auv_common/error.hpp"
#include "auv_dynamics/control/control.hpp"

namespace stg::agent {
namespace {

/// Oldest target estimate worth sending: the packet's age field ends at 32.767 s.
constexpr TimeNs kOldestShared = 30'000'000'000;

bool Finite(const Vec3<double>& v) {
  // x - x is 0 for every finite x and NaN for the others: one comparison for three numbers.
  return (v.x - v.x) + (v.y - v.y) + (v.z - v.z) == 0.0;
}

int IndexOfOne(const double (&one_hot)[4]) {
  int index = 0;
  for (int k = 1; k < 4; ++k) {
    if (one_hot[k] > 0.5) index = k;
  }
  return index;
}

}  // namespace

Agent::Constants::Constants(const AgentConfig& s) : scenario(s), codec(s) {}

Agent::Agent(const AgentConfig& scenario, int id)
    : Agent(std::make_shared<const Constants>(scenario), id) {}

Agent::Agent(const Agent& other, int id) : Agent(other.constants_, id) {}

Agent::Agent(std::shared_ptr<const Constants> constants, int id)
    : constants_(std::move(constants)),
      id_(id),
      target_(constants_->scenario.target_of(id)),
      neighbours_(constants_->scenario, id),
      track_(constants_->scenario),
      mind_(constants_->scenario) {
  if (id < 0 || id >= constants_->scenario.agents) {
    throw std::invalid_argument("agent index outside the swarm");
  }
}

std::vector<Agent> MakeAgents(const AgentConfig& scenario) {
  std::vector<Agent> agents;
  agents.reserve(static_cast<std::size_t>(scenario.agents));
  for (int i = 0; i < scenario.agents; ++i) {
    if (i == 0) {
      agents.emplace_back(scenario, i);
    } else {
      agents.emplace_back(agents.front(), i);
    }
  }
  return agents;
}

void Agent::Reset(std::uint32_t episode, const dynamics::Cue& cue) {
  neighbours_.Clear();
  track_.Clear();
  mind_.Reset();
  cue_ = cue;
  cue_pending_ = cue.target == target_;
  detection_ = dynamics::Detection();
  detection_pending_ = false;
  now_ = 0;
  episode_ = episode;
  step_ = 0;
  decisions_ = 0;
  refused_packets_ = 0;
}

void Agent::Detect(const dynamics::Detection& detection) {
  if (detection.target != target_) return;
  if (!Finite(detection.p_WT) || !std::isfinite(detection.std_m)) {
    throw std::invalid_argument("non-finite target detection");
  }
  if (detection_pending_ && detection.stamp <= detection_.stamp) return;
  detection_ = detection;
  detection_pending_ = true;
}

const NeighbourState* Agent::Take(const acoustics::Reception& reception) {
  try {
    const NeighbourState state =
        constants_->codec.Decode(reception.payload.data, reception.payload.size, reception.arrival);
    return neighbours_.Update(state) ? &neighbours_.at(state.source).state : nullptr;
  } catch (const UserError&) {
    ++refused_packets_;  // what comes from the water may be damaged
    return nullptr;
  }
}

void Agent::Receive(const acoustics::Reception& reception) { Take(reception); }

void Agent::Observe(const dynamics::NavState& nav, float* observation) {
  const Vec3<double> q_xyz{nav.q_WB[1], nav.q_WB[2], nav.q_WB[3]};
  if (!Finite(nav.p_WB) || !Finite(nav.v_WB_B) || !Finite(nav.w_WB_B) || !Finite(q_xyz) ||
      !std::isfinite(nav.q_WB[0])) {
    throw std::invalid_argument("non-finite navigation state");
  }
  const AgentConfig& s = constants_->scenario;
  Begin(nav.stamp);
  neighbours_.Predict(nav.stamp, nav.p_WB);
  UpdateTrack();
  const TargetEstimate& target = track_.estimate();
  mind_.SetNavigation(nav);
  mind_.SetTracking(
      s, {target.p_WT, target.v_WT, target.pp, track_.started() ? 1.0 : 0.0, Current() ? 1.0 : 0.0},
      step_);
  mind_.SetNeighbours(s, SeeNeighbours());
  BuildObservation(s, mind_.knowledge, [observation](int k, double value) {
    observation[k] = static_cast<float>(value);
  });
}

void Agent::Begin(TimeNs now) {
  step_ = decisions_++;
  now_ = now;
}

void Agent::UpdateTrack() {
  if (cue_pending_) {
    track_.Start(cue_.p_WT, cue_.std_m, 0);
    cue_pending_ = false;
  }
  track_.Predict(now_);
  // A fixed order, whatever order the messages came in: shared estimates by index, then the
  // own detection.
  if (neighbours_.unread()) {
    for (const int id : neighbours_.known()) {
      const Neighbour& n = neighbours_.at(id);
      const NeighbourState& s = n.state;
      if (n.unread_target && s.target == target_ && s.target_stamp <= now_) {
        track_.Fuse({s.target_stamp, s.p_WT, s.v_WT, s.target_std});
      }
    }
    neighbours_.MarkRead();
  }
  if (detection_pending_ && detection_.stamp <= now_) {
    track_.Detect(detection_);
    detection_pending_ = false;
  }
}

bool Agent::Current() const {
  return track_.observed() &&
         Seconds(now_ - track_.information_stamp()) <= neighbours_.links().freshness_s();
}

NeighbourView<double> Agent::SeeNeighbours() const {
  const AgentConfig& s = constants_->scenario;
  NeighbourView<double> view;
  for (const int id : neighbours_.known()) {
    const Neighbour& n = neighbours_.at(id);
    view.Add(s.observation, true, n.p_WN, track_.estimate().p_WT, n.link_quality,
             n.state.tracking_error);
    if (s.observation.order == NeighbourOrder::kNearest) {
      view.nearest.Offer(n.r_BN_W, n.distance_m);
    }
  }
  if (s.observation.order == NeighbourOrder::kIndex) {
    for (int j = 0; j < kNeighbourSlots; ++j) {
      const int other = j < id_ ? j : j + 1;
      if (other < s.agents) view.nearest.offset[j] = neighbours_.at(other).r_BN_W;
    }
  }
  return view;
}

TaskView Agent::task() const {
  const ObservationConfig& c = constants_->scenario.observation;
  const Knowledge<double>& k = knowledge();
  TaskView view;
  double z[8], phase[4], quality[4], graph[6];
  TrackingVector(c, k, &z);
  PhaseOneHot(c, k.lost, k.distance, ShownProgress(c, k), &phase);
  QualityOneHot(c, k.confidence, &quality);
  GraphSummary(c, k, &graph);
  std::copy(z, z + 8, view.z_track.begin());
  std::copy(graph, graph + 6, view.graph.begin());
  view.phase = IndexOfOne(phase);
  view.quality = IndexOfOne(quality);
  view.role = graph[5] > 0.5;
  return view;
}

AgentOutput Agent::Act(const float* action) {
  const AgentConfig& s = constants_->scenario;
  double wanted[6];
  for (int k = 0; k < s.action_size(); ++k) {
    wanted[k] = static_cast<double>(action[k]);
    if (!std::isfinite(wanted[k])) throw std::invalid_argument("non-finite action");
  }
  AgentOutput out;
  out.cmd_vel_W = mind_.Act(s, wanted);
  std::copy(mind_.knowledge.tau, mind_.knowledge.tau + 6, out.fraction);
  std::copy(mind_.action.begin(), mind_.action.end(), out.action);
  return out;
}

Packet Agent::MakePacket() const {
  const Knowledge<double>& k = knowledge();
  double phase[4];
  const ObservationConfig& c = constants_->scenario.observation;
  PhaseOneHot(c, k.lost, k.distance, ShownProgress(c, k), &phase);
  NeighbourState state;
  state.source = id_;
  state.generation = now_;
  state.p_W = k.p_WB;
  state.v_W = k.v_WB;
  state.confidence = k.confidence;
  state.tracking_error = k.error;
  state.phase = IndexOfOne(phase);
  state.link_quality = k.mean_quality;
  // Only what rests on an observation: everybody has the cue already.
  state.has_target =
      !lost() && track_.observed() && now_ - track_.information_stamp() <= kOldestShared;
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
