#include "episode_judge.hpp"

#include <algorithm>

#include "auv_dynamics/nodes/conversions.hpp"
#include "auv_dynamics/nodes/topics.hpp"

namespace stg::nodes {
namespace {

/// The environment in the mode without agents: they run elsewhere.
Scenario WithoutAgents(Scenario scenario) {
  scenario.mode = InformationMode::kTruth;
  return scenario;
}

}  // namespace

EpisodeJudge::EpisodeJudge(const Scenario& scenario)
    : scenario_(WithoutAgents(scenario)), env_(scenario_, env::EnvOptions()) {
  const auto n = static_cast<std::size_t>(scenario_.agents);
  swarm_.vehicles.resize(n);
  swarm_.targets.resize(static_cast<std::size_t>(scenario_.target.count));
  swarm_.fractions.assign(n, {});
  swarm_.actions.assign(n, {});
}

EpisodeJudge::Verdict EpisodeJudge::Judge(const SwarmFrame& frame) {
  Verdict verdict;
  const bool truth = frame.truth != nullptr;
  const bool follows =
      truth && started_ && frame.truth->episode == episode_ && frame.truth->step > step_;
  if (started_ && !follows && truth) {
    // Cut short by a reset: what there is still counts as an incomplete episode.
    complete_ = false;
    started_ = false;
    if (env_.step() > 0) FillSummary(frame.truth->header.stamp, env_.MetricsSoFar(0), &verdict);
  }
  if (!truth) {
    complete_ = false;
    return verdict;
  }
  SetTruth(frame);
  if (!follows) {
    if (frame.truth->step >= static_cast<std::uint32_t>(scenario_.time.episode_steps)) {
      return verdict;  // the end of an episode that was not watched
    }
    for (auto* v : {&swarm_.fractions, &swarm_.actions})
      std::fill(v->begin(), v->end(), std::array<double, 6>{});
    deadline_misses_ = 0;
    started_ = true;
    complete_ = frame.truth->step == 0;
    env_.FollowStart(swarm_);
  } else {
    complete_ = complete_ && frame.truth->step == step_ + 1;
    const std::vector<float> state(env_.states(), env_.states() + env_.state_size());
    TakeWrenches(*frame.truth);
    env_.FollowStep(swarm_);
    FillReport(frame, state, &verdict);
    const bool last = frame.truth->step >= static_cast<std::uint32_t>(scenario_.time.episode_steps);
    if (last) {
      started_ = false;
      complete_ = complete_ && env_.truncated();
      FillSummary(frame.truth->header.stamp, env_.MetricsSoFar(0), &verdict);
    }
  }
  episode_ = frame.truth->episode;
  step_ = frame.truth->step;
  seed_ = frame.truth->seed;
  if (started_) TakeActions(frame);
  return verdict;
}

void EpisodeJudge::SetTruth(const SwarmFrame& frame) {
  const auv_msgs::SwarmState& truth = *frame.truth;
  for (std::size_t i = 0; i < swarm_.vehicles.size(); ++i) {
    swarm_.vehicles[i] = NavOf(truth.poses[i], truth.twists[i], NsOf(truth.header.stamp));
  }
  for (std::size_t k = 0; k < swarm_.targets.size(); ++k) {
    swarm_.targets[k].p_WT = VectorOf(truth.target_positions[k]);
    swarm_.targets[k].v_WT = VectorOf(truth.target_velocities[k]);
  }
  double sum = 0.0;
  for (const auto& task : frame.tasks) {
    if (task) sum += task->graph_summary[1];
  }
  swarm_.link_quality = sum / static_cast<double>(frame.tasks.size());
}

/// What acted on the AUVs until this frame.
void EpisodeJudge::TakeWrenches(const auv_msgs::SwarmState& truth) {
  for (std::size_t i = 0; i < swarm_.vehicles.size(); ++i) {
    const auto& w = truth.wrenches[i];
    const double tau[6] = {w.force.x, w.force.y, w.force.z, w.torque.x, w.torque.y, w.torque.z};
    for (std::size_t k = 0; k < 6; ++k) {
      swarm_.fractions[i][k] = tau[k] / scenario_.vehicle.max_tau[k];
    }
  }
  const bool missed =
      std::any_of(truth.fresh.begin(), truth.fresh.end(), [](const auto fresh) { return !fresh; });
  if (missed) ++deadline_misses_;
}

/// What the decision at this frame wants; it is judged with the next frame.
void EpisodeJudge::TakeActions(const SwarmFrame& frame) {
  for (std::size_t i = 0; i < swarm_.vehicles.size(); ++i) {
    const auto& task = frame.tasks[i];
    if (!task) continue;
    std::copy_n(task->action.begin(), std::min<std::size_t>(6, task->action.size()),
                swarm_.actions[i].begin());
    policy_id_ = task->policy_id;
  }
}

void EpisodeJudge::FillReport(const SwarmFrame& frame, const std::vector<float>& state,
                              Verdict* verdict) const {
  verdict->has_report = true;
  auv_msgs::StepReport& m = verdict->report;
  m.header.stamp = frame.truth->header.stamp;
  m.header.frame_id = frames::kWorld;
  m.episode = episode_;
  m.step = frame.truth->step - 1;
  m.global_state = state;
  m.truncated = env_.truncated();
  if (m.truncated) m.final_state.assign(env_.states(), env_.states() + env_.state_size());
  for (int i = 0; i < scenario_.agents; ++i) {
    const task::RewardTerms<Pack>& r = env_.terms(i);
    m.agent_rewards.push_back(Lane(r.total, 0));
    m.r_track.push_back(Lane(r.track, 0));
    m.r_obs.push_back(Lane(r.observation, 0));
    m.r_coord.push_back(Lane(r.coordination, 0));
    m.r_comm.push_back(Lane(r.communication, 0));
    m.r_sem.push_back(Lane(r.semantic, 0));
    m.r_sep.push_back(Lane(r.separation, 0));
    m.cost.push_back(Lane(r.cost, 0));
    m.distances.push_back(Lane(env_.truth(i).distance, 0));
    m.reward += m.agent_rewards.back() / scenario_.agents;
  }
  m.colliding_pairs = static_cast<std::uint32_t>(Lane(env_.world().colliding_pairs(), 0));
  m.smallest_separation = scenario_.agents > 1 ? Lane(env_.world().smallest_separation(), 0) : 0.0;
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
  m.scenario = scenario_.name;
  m.policy_id = policy_id_;
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
  m.deadline_misses = deadline_misses_;
}

}  // namespace stg::nodes
