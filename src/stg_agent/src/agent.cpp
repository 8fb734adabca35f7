#include "stg_agent/agent.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "auv_dynamics/control.hpp"
#include "auv_dynamics/error.hpp"

namespace stg {
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

Agent::Constants::Constants(const Scenario& s)
    : scenario(s),
      codec(s),
      slots(
          static_cast<int>(Max(1.0, std::round(s.channel.transmit_period_s / s.decision_dt_s())))),
      period(static_cast<TimeNs>(std::llround(s.time.dt_s * 1e9)) * s.time.decision_steps) {}

Agent::Agent(const Scenario& scenario, int id)
    : Agent(std::make_shared<const Constants>(scenario), id) {}

Agent::Agent(const Agent& other, int id) : Agent(other.constants_, id) {}

Agent::Agent(std::shared_ptr<const Constants> constants, int id)
    : constants_(std::move(constants)),
      id_(id),
      target_(constants_->scenario.target_of(id)),
      neighbours_(constants_->scenario, id),
      track_(constants_->scenario) {
  if (id < 0 || id >= constants_->scenario.agents) {
    throw std::invalid_argument("agent index outside the swarm");
  }
  error_window_.assign(
      static_cast<std::size_t>(std::max(1, constants_->scenario.observation.error_window)), 0.0);
}

std::vector<Agent> MakeAgents(const Scenario& scenario) {
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

void Agent::Reset(std::uint32_t episode, const Cue& cue) {
  neighbours_.Clear();
  track_.Clear();
  knowledge_ = Knowledge<double>();
  std::fill(error_window_.begin(), error_window_.end(), 0.0);
  action_ = {};
  cue_ = cue;
  cue_pending_ = cue.target == target_;
  detection_ = Detection();
  detection_pending_ = false;
  now_ = 0;
  episode_ = episode;
  step_ = 0;
  decisions_ = 0;
  refused_packets_ = 0;
}

void Agent::Detect(const Detection& detection) {
  if (detection.target != target_) return;
  if (!Finite(detection.p_WT) || !std::isfinite(detection.std_m)) {
    throw std::invalid_argument("non-finite target detection");
  }
  if (detection_pending_ && detection.stamp <= detection_.stamp) return;
  detection_ = detection;
  detection_pending_ = true;
}

void Agent::Receive(const Reception& reception) {
  try {
    neighbours_.Update(
        constants_->codec.Decode(reception.data.data(), reception.data.size(), reception.arrival));
  } catch (const UserError&) {
    ++refused_packets_;  // what comes from the water may be damaged
  }
}

void Agent::Observe(const NavState& nav, float* observation) {
  const Vec3<double> q_xyz{nav.q_WB[1], nav.q_WB[2], nav.q_WB[3]};
  if (!Finite(nav.p_WB) || !Finite(nav.v_WB_B) || !Finite(nav.w_WB_B) || !Finite(q_xyz) ||
      !std::isfinite(nav.q_WB[0])) {
    throw std::invalid_argument("non-finite navigation state");
  }
  step_ = decisions_++;
  now_ = nav.stamp;
  neighbours_.Predict(nav.stamp, nav.p_WB);
  UpdateTrack(nav.stamp);
  SetNavigation(nav);
  SetTracking(nav.stamp);
  SetNeighbours();
  SetGraph();
  BuildObservation(constants_->scenario, knowledge_, [observation](int k, double value) {
    observation[k] = static_cast<float>(value);
  });
}

void Agent::UpdateTrack(TimeNs now) {
  if (cue_pending_) {
    track_.Start(cue_.p_WT, cue_.std_m, 0);
    cue_pending_ = false;
  }
  track_.Predict(now);
  // A fixed order, whatever order the messages came in: shared estimates by index, then the
  // own detection.
  for (const int id : neighbours_.known()) {
    const Neighbour& n = neighbours_.at(id);
    if (!n.unread_target) continue;
    const NeighbourState& s = n.state;
    if (s.target == target_ && s.target_stamp <= now) {
      track_.Fuse({s.target_stamp, s.p_WT, s.v_WT, s.target_std});
    }
    neighbours_.MarkTargetRead(id);
  }
  if (detection_pending_ && detection_.stamp <= now) {
    track_.Detect(detection_);
    detection_pending_ = false;
  }
}

void Agent::SetNavigation(const NavState& nav) {
  Knowledge<double>& k = knowledge_;
  k.p_WB = nav.p_WB;
  k.v_WB_B = nav.v_WB_B;
  k.w_WB_B = nav.w_WB_B;
  k.R_WB = RotationOf(nav.q_WB);
  k.trig = TrigOf(k.R_WB);
  k.v_WB = k.R_WB * nav.v_WB_B;
}

void Agent::SetTracking(TimeNs now) {
  const Scenario& s = constants_->scenario;
  const TargetEstimate& target = track_.estimate();
  Knowledge<double>& k = knowledge_;
  k.r_BT_W = target.p_WT - k.p_WB;
  k.v_WT = target.v_WT;
  const double distance = Norm(k.r_BT_W);
  k.previous_distance = step_ == 0 ? distance : k.distance;
  k.distance = distance;
  k.closing = ClosingSpeed(k.r_BT_W, k.distance, k.v_WB, k.v_WT);
  k.error = Abs(k.distance - s.reward.desired_distance_m);
  const std::size_t window = error_window_.size();
  error_window_[step_ % window] = k.error;
  double sum = 0.0;
  for (const double e : error_window_) sum += e;  // zeros where there is no history yet
  k.mean_error = sum / static_cast<double>(std::min<std::size_t>(step_ + 1, window));
  const bool lost = !track_.started() || target.position_std_m() > s.track.lost_std_m ||
                    k.distance > s.reward.lost_distance_m;
  const bool current =
      track_.observed() && Seconds(now - track_.information_stamp()) <= s.channel.freshness_s;
  k.confidence = !lost && current ? Confidence(k.distance, s.sensing.range_m) : 0.0;
  k.lost = lost ? 1.0 : 0.0;
  k.lost_steps = lost ? k.lost_steps + 1.0 : 0.0;
}

void Agent::SetNeighbours() {
  const Scenario& s = constants_->scenario;
  for (auto& r : knowledge_.neighbour) r = Vec3<double>();
  if (s.observation.order == NeighbourOrder::kNearest) {
    int ids[kNeighbourSlots];
    const int found = neighbours_.Nearest(kNeighbourSlots, ids);
    for (int j = 0; j < found; ++j) knowledge_.neighbour[j] = neighbours_.at(ids[j]).r_BN_W;
    return;
  }
  for (int j = 0; j < kNeighbourSlots; ++j) {
    const int other = j < id_ ? j : j + 1;
    if (other < s.agents) knowledge_.neighbour[j] = neighbours_.at(other).r_BN_W;
  }
}

void Agent::SetGraph() {
  const Scenario& s = constants_->scenario;
  Knowledge<double>& k = knowledge_;
  const Vec3<double> p_WT = track_.estimate().p_WT;
  const auto& known = neighbours_.known();
  double effective = 0.0, quality_sum = 0.0, best = 0.0, error_sum = 0.0;
  double closest_sq = 1e300;
  for (const int id : known) {
    const Neighbour& n = neighbours_.at(id);
    const double q = n.link_quality;
    effective += q > s.observation.link_available ? 1.0 : 0.0;
    quality_sum += q;
    best = Max(best, q);
    error_sum += n.state.tracking_error;
    const Vec3<double> r = p_WT - n.p_WN;
    closest_sq = Min(closest_sq, Dot(r, r));
  }
  const double others = 1.0 / Max(1.0, static_cast<double>(s.agents - 1));
  k.effective_fraction = effective * others;
  k.mean_quality = quality_sum * others;
  k.best_quality = best;
  k.mean_neighbour_error = known.empty() ? k.error : error_sum / static_cast<double>(known.size());
  k.closest = Dot(k.r_BT_W, k.r_BT_W) <= closest_sq ? 1.0 : 0.0;
}

TaskView Agent::task() const {
  const ObservationConfig& c = constants_->scenario.observation;
  const Knowledge<double>& k = knowledge_;
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
  const Scenario& s = constants_->scenario;
  const int size = s.action_size();
  double wanted[6];
  for (int k = 0; k < size; ++k) {
    wanted[k] = static_cast<double>(action[k]);
    if (!std::isfinite(wanted[k])) throw std::invalid_argument("non-finite action");
  }
  AgentOutput out;
  Knowledge<double>& know = knowledge_;
  if (s.control.interface == ActionInterface::kVelocity3) {
    SmoothAction(s.control, size, wanted, action_.data());
    out.cmd_vel_W = DesiredVelocity(s.vehicle, action_.data());
    VelocityController(s.control, s.vehicle, out.cmd_vel_W, know.R_WB, know.v_WB, RpyOf(know.trig),
                       know.w_WB_B, out.fraction);
  } else {
    for (int k = 0; k < size; ++k)
      out.fraction[k] = action_[static_cast<std::size_t>(k)] = Clip(wanted[k], -1.0, 1.0);
  }
  std::copy(action_.begin(), action_.end(), out.action);
  const TimeNs decision = now_ / constants_->period;
  out.transmit = decision % constants_->slots == id_ % constants_->slots;
  if (out.transmit) {
    out.packet = MakePacket();
    out.generation = now_;
  }
  std::copy(out.fraction, out.fraction + 6, know.tau);
  return out;
}

Packet Agent::MakePacket() const {
  const Knowledge<double>& k = knowledge_;
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

}  // namespace stg
