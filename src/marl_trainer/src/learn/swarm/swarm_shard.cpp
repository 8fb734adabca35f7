#include "marl_trainer/learn/swarm/swarm_shard.hpp"

#include <algorithm>
#include <cassert>

#include "auv_common/error.hpp"
#include "auv_common/numbers/random.hpp"
#include "marl_trainer/learn/train_config.hpp"
#include "stg_agent/entities/entity_draw.hpp"
#include "stg_agent/entities/entity_pilot.hpp"
#include "stg_env/env/decide.hpp"

namespace stg::learn {
namespace {

constexpr std::uint32_t kMostAgents = 64;

env::VectorEnvOptions ShardOptions(const SwarmConfig& config, int first_env, int envs,
                                   int total_envs) {
  env::VectorEnvOptions o;
  o.seed = TrainingSeed(config.seed);
  o.envs = envs;
  o.first_env = first_env;
  o.total_envs = total_envs;
  o.stagger = true;
  return o;
}

}  // namespace

SwarmRollout::SwarmRollout()
    : actor(RowSizes(agent::EntityGraphSpec(1))),
      critic(RowSizes(SwarmCriticSpec())),
      finals(RowSizes(SwarmCriticSpec())),
      next(RowSizes(SwarmCriticSpec())) {}

SwarmShard::SwarmShard(const env::EnvFactory& make_env, const SwarmConfig& config, int first_env,
                       int envs, int total_envs)
    : config_(config),
      first_env_(first_env),
      env_(make_env.Make(ShardOptions(config, first_env, envs, total_envs))),
      reward_(config, env_.scenario().judge()),
      memory_(env_.MakeMemory()),
      entities_(static_cast<std::size_t>(envs * env_.agents())),
      now_(RowSizes(agent::EntityGraphSpec(1))),
      last_(RowSizes(SwarmCriticSpec())) {
  const Scenario& scenario = env_.scenario();
  if (scenario.mode != InformationMode::kAcoustic) {
    throw UserError(
        "scenario '" + scenario.run.name +
        "': an entity policy uses only an AUV's own knowledge, so mode must be acoustic");
  }
  agent::RequireFits(config.action, scenario.model());
  const int blocks = std::max(1, total_envs / env::kMixBlock);
  if (config.episode_steps % (blocks * agent::DecisionsPerCommand(scenario.run, config.action)) !=
      0) {
    throw UserError("episode_steps: " + std::to_string(config.episode_steps) +
                    " decisions are not a whole number of commands for " + std::to_string(blocks) +
                    " blocks of environments");
  }
  const auto rows = entities_.size();
  actions_.resize(rows * static_cast<std::size_t>(env_.action_size()));
  sums_.resize(rows);
  potential_.resize(rows);
  next_potential_.resize(rows);
  outcomes_.resize(static_cast<std::size_t>(env_.agents()));
  noise_.resize(rows);
  if (!config.imitation.controller.empty()) {
    teacher_ = agent::MakeDecider(config.imitation.controller, scenario.model());
    if (config.imitation.privileged) env::ReadTruth(&*teacher_, scenario.mode);
    teacher_actions_.resize(actions_.size());
  }
  RestartAt(0);
}

void SwarmShard::RestartAt(std::uint64_t k) {
  env_.RestartAt(k, memory_.arrays());
  std::fill(noise_.begin(), noise_.end(), agent::CommandNoise());
}

Outcome SwarmShard::OutcomeOf(int e, int i) const {
  const task::Tracking<double> t = env_.tracking(e, i);
  return {memory_.rewards[static_cast<std::size_t>(e * env_.agents() + i)], t.distance, t.error,
          env_.followed(e, i), env_.present(e, i)};
}

float SwarmShard::Potential(int e, int i) const {
  return static_cast<float>(reward_.Potential(OutcomeOf(e, i)));
}

void SwarmShard::Observe(const SwarmActor& actor, std::uint32_t collection, int step,
                         SwarmRollout* out) {
  const int n = env_.agents(), size = actor.network.outputs();
  now_.Clear();
  for (int e = 0; e < env_.envs(); ++e) {
    ReadTruth(env_, e, &truth_);
    for (int i = 0; i < n; ++i) {
      agent::Entities& entities = entities_[static_cast<std::size_t>(e * n + i)];
      agent::BuildEntities(env_.agent(e, i), &entities);
      now_.Add(agent::EntityGraphRows(entities));
      out->absent.push_back(env_.present(e, i) ? 0 : 1);
      AddCriticRow(truth_, i, entities, &out->critic);
    }
  }
  actor.network.Forward(actor.parameters, now_, &workspace_);
  for (int row = 0; row < now_.rows(); ++row) {
    out->actor.Add(now_, row);
    const auto key = static_cast<std::uint32_t>(first_env_ + row / n) * kMostAgents +
                     static_cast<std::uint32_t>(row % n);
    Random random(TrainingSeed(config_.seed), Stream::kPolicy, collection,
                  static_cast<std::uint32_t>(step), key);
    const int first = workspace_.first[static_cast<std::size_t>(row)];
    agent::CommandDistribution of;
    of.chooses = actor.network.chooses();
    of.choices = workspace_.first[static_cast<std::size_t>(row) + 1] - first;
    of.logits = workspace_.logits.data() + first;
    of.means = workspace_.means.data() + static_cast<std::ptrdiff_t>(first) * size;
    of.log_std = actor.log_std;
    of.size = size;
    of.keep = agent::NoiseKept(env_.scenario().run, config_.action, config_.noise_time_s);
    of.noise = &noise_[static_cast<std::size_t>(row)];
    int choice = 0;
    float command[agent::kCommandNumbers];
    out->log_prob.push_back(agent::DrawCommand(of, &random, &choice, command));
    out->commands.insert(out->commands.end(), command, command + size);
    out->choices.push_back(choice);
    agent::TakeDecision(env_.agent(row / n, row % n), entities_[static_cast<std::size_t>(row)],
                        config_.action, of.chooses, choice, command);
  }
}

void SwarmShard::AskTeacher(SwarmRollout* out) {
  env::Decide(*teacher_, env_, memory_.observations.data(), teacher_actions_.data());
  const int n = env_.agents(), size = env_.action_size();
  for (int row = 0; row < env_.envs() * n; ++row) {
    float taught[agent::kCommandNumbers];
    agent::VelocityCommandOf(env_.agent(row / n, row % n),
                             teacher_actions_.data() + static_cast<std::ptrdiff_t>(row) * size,
                             taught);
    out->taught.insert(out->taught.end(), taught, taught + agent::CommandSize(config_.action));
  }
}

void SwarmShard::FlyOn(int step, SwarmRollout* out) {
  const int n = env_.agents(), size = env_.action_size(),
            period = agent::DecisionsPerCommand(env_.scenario().run, config_.action);
  std::fill(sums_.begin(), sums_.end(), 0.0F);
  for (int d = 0; d < period; ++d) {
    for (int e = 0; e < env_.envs(); ++e) {
      for (int i = 0; i < n; ++i) {
        agent::FollowCommand(env_.agent(e, i), config_.action,
                             actions_.data() + static_cast<std::ptrdiff_t>(e * n + i) * size);
      }
    }
    const bool last = d + 1 == period;
    if (last) {
      // The environment starts a new episode at once, so the final state is read one decision
      // earlier.
      last_.Clear();
      for (int e = 0; e < env_.envs(); ++e) {
        ReadTruth(env_, e, &truth_);
        for (int i = 0; i < n; ++i) {
          const auto row = static_cast<std::size_t>(e * n + i);
          AddCriticRow(truth_, i, entities_[row], &last_);
          next_potential_[row] = Potential(e, i);
        }
      }
    }
    env_.Step(actions_.data(), memory_.arrays());
    Pay();
    if (!last) {
      assert(std::none_of(memory_.truncated.begin(), memory_.truncated.end(),
                          [](std::uint8_t t) { return t != 0; }));
    }
  }
  for (int e = 0; e < env_.envs(); ++e) {
    const bool ended = memory_.truncated[static_cast<std::size_t>(e)] != 0;
    if (ended) out->finished.push_back(env_.metrics(e));
    for (int i = 0; i < n; ++i) {
      const auto row = static_cast<std::size_t>(e * n + i);
      const bool was_here = out->absent[out->done.size()] == 0;
      const bool ends = ended || (was_here && !env_.present(e, i));
      out->done.push_back(ends ? 1 : 0);
      out->final_of.push_back(ends ? out->finals.rows() : -1);
      if (ends) out->finals.Add(last_, static_cast<int>(row));
      if (!ends) next_potential_[row] = Potential(e, i);
      out->own.push_back(sums_[row] / static_cast<float>(period));
    }
  }
  Reward(step, out);
}

void SwarmShard::Pay() {
  const int n = env_.agents();
  for (int e = 0; e < env_.envs(); ++e) {
    for (int i = 0; i < n; ++i) outcomes_[static_cast<std::size_t>(i)] = OutcomeOf(e, i);
    reward_.Add(outcomes_.data(), sums_.data() + static_cast<std::ptrdiff_t>(e * n));
  }
}

void SwarmShard::Reward(int step, SwarmRollout* out) const {
  const int n = env_.agents();
  const std::ptrdiff_t begin = static_cast<std::ptrdiff_t>(step) * env_.envs() * n;
  const float* own = out->own.data() + begin;
  const std::uint8_t* absent = out->absent.data() + begin;
  for (int e = 0; e < env_.envs(); ++e) {
    const std::ptrdiff_t first = e * n;
    out->rewards.resize(out->rewards.size() + static_cast<std::size_t>(n));
    reward_.Share(own + first, absent + first, potential_.data() + first,
                  next_potential_.data() + first, out->rewards.data() + out->rewards.size() - n);
  }
}

void SwarmShard::Collect(std::uint32_t collection, const SwarmActor& actor, SwarmRollout* out,
                         bool teach) {
  *out = SwarmRollout();
  out->steps = config_.horizon;
  out->envs = env_.envs();
  out->agents = env_.agents();
  const int n = env_.agents();
  for (int t = 0; t < config_.horizon; ++t) {
    for (int e = 0; e < env_.envs(); ++e) {
      for (int i = 0; i < n; ++i) {
        potential_[static_cast<std::size_t>(e * n + i)] = Potential(e, i);
      }
    }
    Observe(actor, collection, t, out);
    if (teach) AskTeacher(out);
    FlyOn(t, out);
  }
  for (int e = 0; e < env_.envs(); ++e) {
    ReadTruth(env_, e, &truth_);
    for (int i = 0; i < n; ++i) {
      agent::Entities& entities = entities_[static_cast<std::size_t>(e * n + i)];
      agent::BuildEntities(env_.agent(e, i), &entities);
      AddCriticRow(truth_, i, entities, &out->next);
    }
  }
}

}  // namespace stg::learn
