#include "marl_trainer/learn/swarm/swarm_recording.hpp"

#include <algorithm>
#include <cmath>

#include "auv_common/error.hpp"
#include "stg_agent/entities/entity_pilot.hpp"

namespace stg::learn {
namespace {

bool AllFinite(const float* numbers, int count) {
  return std::all_of(numbers, numbers + count, [](float x) { return std::isfinite(x); });
}

bool FiniteRows(const agent::Entities& e) {
  bool edges = true;
  for (int t = 0; t < e.targets; ++t) {
    edges = edges && AllFinite(e.edge[t][0], e.neighbours * agent::kEdgeNumbers);
  }
  return edges && AllFinite(e.self, agent::kSelfNumbers) &&
         AllFinite(e.search, agent::kSearchNumbers) &&
         AllFinite(e.target[0], e.targets * agent::kTargetNumbers) &&
         AllFinite(e.neighbour[0], e.neighbours * agent::kNeighbourNumbers) &&
         AllFinite(e.obstacle[0], e.obstacles * agent::kObstacleNumbers);
}

Finding CheckCommand(const SwarmCommand& c, const agent::EntityPolicy& policy) {
  const int size = agent::CommandSize(policy.action());
  const agent::EntityDecision& d = c.decision;
  if (!c.recorded) return {Flaw::kGap, "no command"};
  if (c.command_size != size) {
    return {Flaw::kAction, "command has " + std::to_string(c.command_size) + " numbers, not " +
                               std::to_string(size)};
  }
  if (!FiniteRows(d.entities) || !AllFinite(d.command, size) || !std::isfinite(d.log_probability)) {
    return {Flaw::kNotFinite, "observation, command or log probability"};
  }
  if (c.policy_id != policy.metadata().id) {
    return {Flaw::kForeignPolicy,
            "'" + c.policy_id.substr(0, 80) + "', not '" + policy.metadata().id + "'"};
  }
  const bool chooses = policy.chooses();
  const int choices = chooses ? d.entities.targets + 1 : 1;
  if (d.choice < 0 || d.choice >= choices) {
    return {Flaw::kAction, "choice " + std::to_string(d.choice) + " of " + std::to_string(choices)};
  }
  const double expected = agent::LogDensity(policy, d.entities, d.choice, d.command);
  const double recorded = static_cast<double>(d.log_probability);
  if (!(std::abs(expected - recorded) <= EpisodeChecker::kLogProbabilityTolerance)) {
    return {Flaw::kLogProbability, std::to_string(recorded) + ", not " + std::to_string(expected)};
  }
  return {};
}

bool Finite(const SwarmMoment& m) {
  const auto finite = [](const Vec3<double>& v) { return std::isfinite(v.x + v.y + v.z); };
  const SwarmTruth& t = m.truth;
  return std::all_of(t.p_WB.begin(), t.p_WB.end(), finite) &&
         std::all_of(t.v_WB.begin(), t.v_WB.end(), finite) &&
         std::all_of(t.r_BT_W.begin(), t.r_BT_W.end(), finite) &&
         std::all_of(t.targets.begin(), t.targets.end(),
                     [&](const auto& x) { return finite(x.p_WT) && finite(x.v_WT); }) &&
         std::all_of(m.outcomes.begin(), m.outcomes.end(),
                     [](const Outcome& o) { return std::isfinite(o.reward); });
}

}  // namespace

void RequireRecordable(const task::JudgeConfig& s) {
  const std::string what = "scenario '" + s.run.name + "': ";
  if (!s.world.sea.open) {
    throw UserError(what +
                    "networks over entities learn in open water only (sea.open); "
                    "network:=layers learns here");
  }
  if (s.agent.fleet.changes()) {
    throw UserError(what +
                    "AUVs join or leave (fleet), and this learning needs all of them in "
                    "each step");
  }
  const int decisions = agent::DecisionsPerCommand(s.run);
  if (s.run.time.episode_steps % decisions != 0) {
    throw UserError(what + "time.episode_steps: " + std::to_string(s.run.time.episode_steps) +
                    " decisions are not a whole number of commands of 5 s");
  }
}

Finding CheckSwarmEpisode(const RunConfig& run, const SwarmEpisode& episode,
                          const agent::EntityPolicy& policy) {
  if (episode.finding.flaw != Flaw::kNone) return episode.finding;
  for (std::size_t k = 0; k < episode.moments.size(); ++k) {
    if (!Finite(episode.moments[k])) {
      return {Flaw::kNotFinite, "step " + std::to_string(k) + ": reward or state"};
    }
  }
  const int decisions = agent::DecisionsPerCommand(run);
  for (std::size_t k = 0; k < episode.commands.size(); ++k) {
    const Finding finding = CheckCommand(episode.commands[k], policy);
    if (finding.flaw == Flaw::kNone) continue;
    const int i = static_cast<int>(k) % run.agents, t = static_cast<int>(k) / run.agents;
    return {finding.flaw, "AUV " + std::to_string(i) + ", step " + std::to_string(t * decisions) +
                              ": " + finding.where};
  }
  return {};
}

SwarmRollout RolloutOf(const SwarmConfig& config, const task::JudgeConfig& scenario,
                       const SwarmEpisode& episode) {
  const SwarmReward reward(config, scenario);
  const int n = scenario.run.agents, period = agent::DecisionsPerCommand(scenario.run);
  const auto agents = static_cast<std::size_t>(n);
  const auto potentials = [&](const SwarmMoment& m) {
    std::vector<float> p;
    for (const Outcome& o : m.outcomes) p.push_back(static_cast<float>(reward.Potential(o)));
    return p;
  };
  SwarmRollout out;
  out.steps = scenario.run.time.episode_steps / period;
  out.envs = 1;
  out.agents = n;
  for (int t = 0; t < out.steps; ++t) {
    const auto first = static_cast<std::size_t>(t * period);
    const bool last = t + 1 == out.steps;
    const SwarmCommand* commands = &episode.commands[static_cast<std::size_t>(t) * agents];
    std::vector<float> sums(agents, 0.0F);
    for (std::size_t d = 0; d < static_cast<std::size_t>(period); ++d) {
      reward.Add(episode.moments[first + d + 1].outcomes.data(), sums.data());
    }
    // As SwarmShard, it takes the final state one decision before the end.
    const SwarmMoment& end =
        episode.moments[first + static_cast<std::size_t>(last ? period - 1 : period)];
    for (int i = 0; i < n; ++i) {
      const agent::EntityDecision& d = commands[i].decision;
      out.actor.Add(agent::EntityGraphRows(d.entities));
      AddCriticRow(episode.moments[first].truth, i, d.entities, &out.critic);
      out.commands.insert(out.commands.end(), d.command, d.command + commands[i].command_size);
      out.choices.push_back(d.choice);
      out.log_prob.push_back(d.log_probability);
      out.absent.push_back(0);
      out.done.push_back(last ? 1 : 0);
      out.final_of.push_back(last ? i : -1);
      out.own.push_back(sums[static_cast<std::size_t>(i)] / static_cast<float>(period));
      if (!last) continue;
      AddCriticRow(end.truth, i, d.entities, &out.finals);
      AddCriticRow(end.truth, i, d.entities, &out.next);
    }
    out.rewards.resize(out.rewards.size() + agents);
    reward.Share(out.own.data() + out.own.size() - agents,
                 out.absent.data() + out.absent.size() - agents,
                 potentials(episode.moments[first]).data(), potentials(end).data(),
                 out.rewards.data() + out.rewards.size() - agents);
  }
  return out;
}

}  // namespace stg::learn
