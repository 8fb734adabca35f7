#include "swarm_inlet.hpp"

#include <algorithm>

#include "auv_common/nodes/conversions.hpp"
#include "auv_dynamics/nodes/conversions.hpp"
#include "stg_agent/entities/entity_pilot.hpp"
#include "stg_agent/nodes/entity_messages.hpp"

namespace stg::nodes {

SwarmInlet::SwarmInlet(const task::JudgeConfig& scenario, const std::string& source)
    : scenario_(scenario),
      source_(source),
      period_(scenario.run.decision_period()),
      steps_(static_cast<std::uint32_t>(scenario.run.time.episode_steps)),
      decisions_(static_cast<std::uint32_t>(agent::DecisionsPerCommand(scenario.run))),
      judge_(scenario) {}

template <class Message>
SwarmInlet::Recording* SwarmInlet::At(const Message& m) {
  const TimeNs start = NsOf(m.header.stamp) - static_cast<TimeNs>(m.step) * period_;
  return open_.At(m.episode, start, [&] {
    Recording recording;
    recording.number = m.episode;
    recording.tasks.resize(static_cast<std::size_t>(scenario_.run.agents));
    recording.commands.resize(recording.tasks.size());
    return recording;
  });
}

bool SwarmInlet::Usable(const auv_msgs::SwarmState& m) const {
  const auto n = static_cast<std::size_t>(scenario_.run.agents);
  const auto targets = static_cast<std::size_t>(scenario_.world.target.count);
  return m.step <= steps_ && m.poses.size() == n && m.twists.size() == n &&
         m.velocities.size() == n && m.wrenches.size() == n && m.fresh.size() == n &&
         m.target_positions.size() == targets && m.target_velocities.size() == targets;
}

bool SwarmInlet::Usable(const auv_msgs::TaskState& m) const {
  return m.step <= steps_ && m.target < static_cast<std::uint32_t>(scenario_.world.target.count);
}

void SwarmInlet::Add(const auv_msgs::SwarmState::ConstPtr& m) {
  if (!Usable(*m)) {
    ++foreign_;
  } else if (Recording* r = At(*m)) {
    r->truth.emplace(m->step, m);
  }
}

void SwarmInlet::Add(int agent, const auv_msgs::TaskState::ConstPtr& m) {
  if (!Usable(*m)) {
    ++foreign_;
  } else if (Recording* r = At(*m)) {
    r->tasks[static_cast<std::size_t>(agent)].emplace(m->step, m);
  }
}

void SwarmInlet::Add(int agent, const auv_msgs::EntityStep::ConstPtr& m) {
  // The decision on the last observation of an episode has no effect, because the world restarts.
  if (m->step >= steps_) return;
  if (m->agent != static_cast<std::uint32_t>(agent)) {
    ++foreign_;
  } else if (Recording* r = At(*m)) {
    r->commands[static_cast<std::size_t>(agent)].emplace(m->step, m);
  }
}

bool SwarmInlet::Complete(const Recording& r) const {
  const auto all = [](const auto& lists, std::size_t size) {
    return std::all_of(lists.begin(), lists.end(),
                       [size](const auto& list) { return list.size() >= size; });
  };
  return r.truth.size() > steps_ && all(r.tasks, steps_ + 1U) &&
         all(r.commands, steps_ / decisions_);
}

std::vector<learn::SwarmEpisode> SwarmInlet::TakeDone() {
  std::vector<learn::SwarmEpisode> done;
  for (const Recording& r : open_.TakeDone([this](const Recording& x) { return Complete(x); })) {
    done.push_back(EpisodeOf(r));
  }
  return done;
}

learn::Finding SwarmInlet::FindGap(const Recording& r) const {
  if (r.truth.count(steps_) == 0) {
    return {learn::Flaw::kUnfinished, "the end of the episode is missing"};
  }
  for (std::uint32_t k = 0; k <= steps_; ++k) {
    const std::string step = "step " + std::to_string(k);
    if (r.truth.count(k) == 0) return {learn::Flaw::kNoReward, step};
    for (std::size_t i = 0; i < r.tasks.size(); ++i) {
      const bool commands = k < steps_ && k % decisions_ == 0;
      if (r.tasks[i].count(k) == 0 || (commands && r.commands[i].count(k) == 0)) {
        return {learn::Flaw::kGap, "AUV " + std::to_string(i) + ", " + step};
      }
    }
  }
  return {};
}

learn::SwarmEpisode SwarmInlet::EpisodeOf(const Recording& r) {
  learn::SwarmEpisode e;
  e.number = r.number;
  e.source = source_;
  e.finding = FindGap(r);
  if (e.finding.flaw != learn::Flaw::kNone) return e;
  for (std::uint32_t k = 0; k <= steps_; ++k) {
    SwarmFrame frame(scenario_.run.agents);
    frame.truth = r.truth.at(k);
    for (std::size_t i = 0; i < r.tasks.size(); ++i) frame.tasks[i] = r.tasks[i].at(k);
    e.moments.push_back(MomentOf(frame));
    if (k == steps_ || k % decisions_ != 0) continue;
    for (const auto& commands : r.commands) {
      const auv_msgs::EntityStep& m = *commands.at(k);
      e.commands.emplace_back();
      learn::SwarmCommand& c = e.commands.back();
      c.policy_id = m.policy_id;
      c.command_size = static_cast<int>(m.command.size());
      c.recorded = DecisionOf(m, &c.decision);
      if (!c.recorded) e.finding = {learn::Flaw::kObservation, "step " + std::to_string(k)};
    }
  }
  return e;
}

learn::SwarmMoment SwarmInlet::MomentOf(const SwarmFrame& frame) {
  const EpisodeJudge::Verdict verdict = judge_.Judge(frame);
  learn::SwarmMoment moment;
  learn::SwarmTruth& t = moment.truth;
  t.desired_m = scenario_.agent.task.desired_distance_m;
  for (std::size_t k = 0; k < frame.truth->target_positions.size(); ++k) {
    t.targets.emplace_back();
    t.targets.back().p_WT = VectorOf(frame.truth->target_positions[k]);
    t.targets.back().v_WT = VectorOf(frame.truth->target_velocities[k]);
  }
  for (std::size_t i = 0; i < frame.tasks.size(); ++i) {
    const auv_msgs::TaskState& task = *frame.tasks[i];
    t.p_WB.push_back(VectorOf(frame.truth->poses[i].position));
    t.v_WB.push_back(VectorOf(frame.truth->velocities[i]));
    t.present.push_back(1);  // RequireRecordable: all AUVs, all the time
    t.followed.push_back(static_cast<int>(task.target));
    t.r_BT_W.push_back(VectorOf(task.target_offset));
    const task::Tracking<double>& tracking = judge_.tracking(static_cast<int>(i));
    const float reward =
        verdict.has_report ? static_cast<float>(verdict.report.agent_rewards[i]) : 0.0F;
    moment.outcomes.push_back({reward, tracking.distance, tracking.error, t.followed.back()});
  }
  return moment;
}

}  // namespace stg::nodes
