#include "stg_env/nodes/episode_judge.hpp"

#include <algorithm>
#include <utility>

#include "auv_dynamics/nodes/conversions.hpp"
#include "auv_dynamics/nodes/topics.hpp"

namespace stg::nodes {

EpisodeJudge::EpisodeJudge(const task::JudgeConfig& scenario)
    : scenario_(scenario),
      task_(scenario),
      vehicles_(static_cast<std::size_t>(scenario.run.agents)),
      targets_(static_cast<std::size_t>(scenario.world.target.count)),
      separations_(scenario.run.agents, 2.0 * scenario.world.vehicle.radius_m),
      tau_(vehicles_.size()),
      action_(vehicles_.size()),
      policy_ids_(vehicles_.size()) {
  if (scenario.agent.task.free()) {
    following_ =
        std::make_unique<task::Following<double>>(scenario.run.agents, scenario.world.target.count);
  }
  if (!scenario.world.sea.open) return;
  scape_ = std::make_unique<const dynamics::Seascape>(scenario.world.sea,
                                                      scenario.world.workspace.half_extent_m);
  field_.resize(vehicles_.size());
}

task::SwarmState<double> EpisodeJudge::Swarm() const {
  return {vehicles_,
          targets_,
          separations_,
          tau_,
          action_,
          link_quality_,
          field_.empty() ? nullptr : &field_,
          following_.get()};
}

std::vector<float> EpisodeJudge::CriticState() const {
  std::vector<float> state;
  task_.WriteCriticState(Swarm(), [&state](const double* numbers, int count) {
    for (int k = 0; k < count; ++k) state.push_back(static_cast<float>(numbers[k]));
  });
  return state;
}

EpisodeJudge::Verdict EpisodeJudge::Judge(const SwarmFrame& frame) {
  Verdict verdict;
  const bool truth = frame.truth != nullptr;
  const bool follows = truth && started_ && frame.truth->run == run_ &&
                       frame.truth->episode == episode_ && frame.truth->step > step_;
  if (started_ && !follows && truth) {
    // A reset has cut the episode short. Its steps still count as an incomplete episode.
    complete_ = false;
    started_ = false;
    if (task_.steps(0) > 0) FillSummary(frame.truth->header.stamp, task_.Metrics(0), &verdict);
  }
  if (!truth) {
    complete_ = false;
    return verdict;
  }
  SetTruth(frame);
  if (!follows) {
    if (frame.truth->step >= static_cast<std::uint32_t>(scenario_.run.time.episode_steps)) {
      return verdict;  // the end of an episode that was not observed
    }
    for (auto* v : {&tau_, &action_}) std::fill(v->begin(), v->end(), std::array<double, 6>{});
    for (auto& f : field_) f.received = f.missed = f.modem_energy_j = 0.0;
    deadline_misses_ = channel_misses_ = 0;
    started_ = true;
    complete_ = frame.truth->step == 0;
    task_.Start(true, Swarm(), scenario_.run.time.episode_steps);
    state_ = CriticState();
  } else {
    complete_ = complete_ && frame.truth->step == step_ + 1;
    TakeWrenches(*frame.truth);
    task_.Step(Swarm());
    std::vector<float> before = std::exchange(state_, CriticState());
    FillReport(frame, std::move(before), &verdict);
    const bool last =
        frame.truth->step >= static_cast<std::uint32_t>(scenario_.run.time.episode_steps);
    if (last) {
      started_ = false;
      complete_ = complete_ && Truncated();
      FillSummary(frame.truth->header.stamp, task_.Metrics(0), &verdict);
    }
  }
  run_ = frame.truth->run;
  episode_ = frame.truth->episode;
  step_ = frame.truth->step;
  seed_ = frame.truth->seed;
  if (started_) TakeActions(frame);
  return verdict;
}

void EpisodeJudge::SetTruth(const SwarmFrame& frame) {
  const auv_msgs::SwarmState& truth = *frame.truth;
  for (std::size_t i = 0; i < vehicles_.size(); ++i) {
    const dynamics::NavState nav = NavOf(truth.poses[i], truth.twists[i], NsOf(truth.header.stamp));
    dynamics::VehicleState<double>& v = vehicles_[i];
    v.p_WB = nav.p_WB;
    std::copy(nav.q_WB, nav.q_WB + 4, v.q_WB);
    v.v_WB_B = nav.v_WB_B;
    v.w_WB_B = nav.w_WB_B;
    dynamics::FollowQuaternion(&v);
    v.v_WB = VectorOf(truth.velocities[i]);  // a wall may have reversed it
  }
  for (std::size_t k = 0; k < targets_.size(); ++k) {
    targets_[k].p_WT = VectorOf(truth.target_positions[k]);
    targets_[k].v_WT = VectorOf(truth.target_velocities[k]);
  }
  separations_.Measure(vehicles_);
  double sum = 0.0;
  for (const auto& task : frame.tasks) {
    if (task) sum += task->graph_summary[1];
  }
  link_quality_ = sum / static_cast<double>(frame.tasks.size());
  if (!field_.empty()) SetField(frame);
  if (following_ != nullptr) SetFollowing(frame);
}

void EpisodeJudge::SetFollowing(const SwarmFrame& frame) {
  task::Following<double>& f = *following_;
  const std::size_t n = targets_.size();
  for (std::size_t i = 0; i < vehicles_.size(); ++i) {
    const auto& task = frame.tasks[i];
    if (task && task->target < n) f.target[i] = task->target;
    const bool complete = task && task->beliefs.size() == n && task->beliefs_known.size() == n;
    for (std::size_t k = 0; complete && k < n; ++k) {
      f.known[i * n + k] = task->beliefs_known[k] ? 1.0 : 0.0;
      f.p_WT[i * n + k] = VectorOf(task->beliefs[k]);
    }
    if (complete && !scenario_.world.sensing.labelled) f.Match(i, targets_);
    f.state[i] = targets_[static_cast<std::size_t>(f.target[i])];
  }
}

void EpisodeJudge::SetField(const SwarmFrame& frame) {
  const auv_msgs::SwarmState& truth = *frame.truth;
  for (std::size_t i = 0; i < field_.size(); ++i) {
    task::FieldState<double>& f = field_[i];
    f.altitude_m = scape_->Altitude(vehicles_[i].p_WB);
    f.clearance_m = scape_->Clearance(vehicles_[i].p_WB);
    if (i < truth.groundings.size()) f.groundings = truth.groundings[i];
    if (i < truth.collisions.size()) f.collisions = truth.collisions[i];
    const auto& task = frame.tasks[i];
    if (!task) continue;
    f.present = task->absent ? 0.0 : 1.0;
    f.known = task->target_known ? 1.0 : 0.0;
    f.p_WT = VectorOf(task->target_position);
    f.r_BT_W = VectorOf(task->target_offset);
    std::copy(task->target_covariance.begin(), task->target_covariance.end(), f.covariance);
    f.age_s = task->target_age;
  }
  if (frame.links) SetLinks(*frame.links);
}

void EpisodeJudge::SetLinks(const auv_msgs::LinkStates& links) {
  double delivered = 0.0, dropped = 0.0;
  for (const auv_msgs::LinkState& link : links.links) {
    delivered += link.delivered;
    dropped += link.dropped;
  }
  for (std::size_t i = 0; i < field_.size(); ++i) {
    field_[i].received = delivered / scenario_.run.agents;
    field_[i].missed = dropped / scenario_.run.agents;
    if (i < links.energy.size()) field_[i].modem_energy_j = links.energy[i];
  }
}

/// Stores the efforts of the AUVs in the step before this frame.
void EpisodeJudge::TakeWrenches(const auv_msgs::SwarmState& truth) {
  const bool efforts = truth.efforts.size() == vehicles_.size() * dynamics::kWrenchSize;
  for (std::size_t i = 0; i < vehicles_.size(); ++i) {
    if (efforts) {
      std::copy_n(truth.efforts.begin() + static_cast<std::ptrdiff_t>(i * dynamics::kWrenchSize),
                  dynamics::kWrenchSize, tau_[i].begin());
      continue;
    }
    const auto& w = truth.wrenches[i];
    const double tau[6] = {w.force.x, w.force.y, w.force.z, w.torque.x, w.torque.y, w.torque.z};
    for (std::size_t k = 0; k < 6; ++k) {
      tau_[i][k] = tau[k] / scenario_.world.vehicle.max_tau[k];
    }
  }
  const bool missed =
      std::any_of(truth.fresh.begin(), truth.fresh.end(), [](const auto fresh) { return !fresh; });
  if (missed) ++deadline_misses_;
  if (!truth.channel_fresh) ++channel_misses_;
}

/// Stores the decision at this frame. It is judged with the next frame.
void EpisodeJudge::TakeActions(const SwarmFrame& frame) {
  for (std::size_t i = 0; i < vehicles_.size(); ++i) {
    const auto& task = frame.tasks[i];
    if (!task) continue;
    std::copy_n(task->action.begin(), std::min<std::size_t>(6, task->action.size()),
                action_[i].begin());
    policy_ids_[i] = task->policy_id;
  }
}

std::string EpisodeJudge::policy_id() const {
  std::string ids;
  for (std::size_t i = 0; i < policy_ids_.size(); ++i) {
    const auto own = policy_ids_.begin() + static_cast<std::ptrdiff_t>(i);
    if (own->empty() || std::find(policy_ids_.begin(), own, *own) != own) continue;
    ids += (ids.empty() ? "" : "+") + *own;
  }
  return ids;
}

void EpisodeJudge::FillReport(const SwarmFrame& frame, std::vector<float> state,
                              Verdict* verdict) const {
  verdict->has_report = true;
  auv_msgs::StepReport& m = verdict->report;
  m.header.stamp = frame.truth->header.stamp;
  m.header.frame_id = frames::kWorld;
  m.episode = episode_;
  m.step = frame.truth->step - 1;
  m.global_state = std::move(state);
  m.truncated = Truncated();
  if (m.truncated) m.final_state = state_;
  for (int i = 0; i < scenario_.run.agents; ++i) {
    const task::RewardTerms<double>& r = task_.terms(i);
    m.agent_rewards.push_back(r.total);
    m.r_track.push_back(r.track);
    m.r_obs.push_back(r.observation);
    m.r_coord.push_back(r.coordination);
    m.r_comm.push_back(r.communication);
    m.r_sem.push_back(r.semantic);
    m.r_sep.push_back(r.separation);
    m.cost.push_back(r.cost);
    m.distances.push_back(task_.tracking(i).distance);
    m.reward += m.agent_rewards.back() / scenario_.run.agents;
  }
  // Mean over the AUVs that are present.
  if (scenario_.agent.fleet.changes()) m.reward = task_.team_reward();
  for (std::size_t i = 0; i < field_.size(); ++i) {
    const task::FieldState<double>& f = field_[i];
    const double error = Norm(f.p_WT - Swarm().target_of(i).p_WT);
    m.estimate_errors.push_back(f.known > 0.5 ? error : -1.0);
    m.altitudes.push_back(f.altitude_m);
    m.clearances.push_back(f.clearance_m);
  }
  m.colliding_pairs = static_cast<std::uint32_t>(separations_.colliding_pairs());
  m.smallest_separation = scenario_.run.agents > 1 ? separations_.smallest() : 0.0;
}

void EpisodeJudge::FillSummary(const ros::Time& stamp, const task::EpisodeMetrics& e,
                               Verdict* verdict) const {
  verdict->has_summary = true;
  verdict->metrics = e;
  auv_msgs::EpisodeSummary& m = verdict->summary;
  m.header.stamp = stamp;
  m.header.frame_id = frames::kWorld;
  m.episode = episode_;
  m.seed = seed_;
  m.scenario = scenario_.run.name;
  m.policy_id = policy_id();
  m.steps = static_cast<std::uint32_t>(e.steps);
  m.complete = complete_;
  m.episode_return = e.episode_return;
  m.tail_distance = e.tail_distance;
  m.tracking_error = e.tracking_error;
  m.lost_rate = e.lost_rate;
  m.action_norm = e.action_norm;
  m.saturation_rate = e.saturation_rate;
  m.control_cost = e.control_cost;
  m.communication_quality = e.communication_quality;
  m.band_rate = e.band_rate;
  m.colliding_pairs = e.colliding_pairs;
  m.tail_colliding_pairs = e.tail_colliding_pairs;
  m.min_separation = e.min_separation;
  m.time_to_band = e.time_to_band;
  for (const auto& [name, value] : e.Items()) {
    m.metric_names.push_back(name);
    m.metrics.push_back(value);
  }
  m.field = e.field.has_value();
  if (e.field) {
    const task::FieldMetrics& f = *e.field;
    m.estimate_rmse = f.estimate_rmse;
    m.nees = f.nees;
    m.estimate_known = f.estimate_known;
    m.information_age = f.information_age;
    m.band_share = f.band_share;
    m.time_lost = f.time_lost;
    m.time_to_reacquire = f.time_to_reacquire;
    m.losses = f.losses;
    m.spread = f.spread;
    m.near_pairs = f.near_pairs;
    m.min_altitude = f.min_altitude;
    m.min_clearance = f.min_clearance;
    m.groundings = f.groundings;
    m.collisions = f.collisions;
    m.packets = f.packets;
    m.packet_loss = f.packet_loss;
    m.modem_energy = f.modem_energy;
  }
  m.deadline_misses = deadline_misses_;
  m.channel_misses = channel_misses_;
}

}  // namespace stg::nodes
