#include "marl_trainer/learn/swarm/swarm_shard.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "auv_common/error.hpp"
#include "auv_common/numbers/random.hpp"
#include "marl_trainer/learn/swarm/swarm_truth.hpp"
#include "marl_trainer/learn/train_config.hpp"
#include "stg_agent/entities/entity_pilot.hpp"
#include "stg_agent/policy/gaussian.hpp"

namespace stg::learn {
namespace {

constexpr std::uint32_t kMostAgents = 64;
constexpr double kEnough = 2.0;  ///< enough AUVs in the band of a target: two ranges locate it

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

/// Number of decisions during a command.
int DecisionsOf(const RunConfig& run) {
  return static_cast<int>(std::lround(agent::kCommandPeriod_s / run.decision_dt_s()));
}

}  // namespace

double ShareOfBand(bool chosen, int inside) {
  return chosen ? std::min(1.0, kEnough / inside) : 1.0;
}

double ShareCovered(const std::vector<int>& inside) {
  double sum = 0.0;
  for (const int count : inside) sum += std::min(1.0, count / kEnough);
  return sum / static_cast<double>(inside.size());
}

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
  const int blocks = std::max(1, total_envs / env::kMixBlock);
  if (config.episode_steps % (blocks * DecisionsOf(scenario.run)) != 0) {
    throw UserError("episode_steps: " + std::to_string(config.episode_steps) +
                    " decisions are not a whole number of commands for " + std::to_string(blocks) +
                    " blocks of environments");
  }
  const auto rows = entities_.size();
  actions_.resize(rows * static_cast<std::size_t>(env_.action_size()));
  sums_.resize(rows);
  potential_.resize(rows);
  next_potential_.resize(rows);
  RestartAt(0);
}

void SwarmShard::RestartAt(std::uint64_t k) { env_.RestartAt(k, memory_.arrays()); }

double SwarmShard::Potential(int e, int i) const {
  const task::Tracking<double> t = env_.tracking(e, i);
  return -config_.shaping * t.error / 100.0;
}

void SwarmShard::Observe(const SwarmActor& actor, std::uint32_t collection, int step,
                         SwarmRollout* out) {
  const int n = env_.agents(), size = actor.network.outputs();
  now_.Clear();
  for (int e = 0; e < env_.envs(); ++e) {
    for (int i = 0; i < n; ++i) {
      agent::Entities& entities = entities_[static_cast<std::size_t>(e * n + i)];
      agent::BuildEntities(env_.agent(e, i), &entities);
      now_.Add(agent::EntityGraphRows(entities));
      AddCriticRow(env_, e, i, entities, &out->critic);
    }
  }
  actor.network.Forward(actor.parameters, now_, &workspace_);
  for (int row = 0; row < now_.rows(); ++row) {
    out->actor.Add(now_, row);
    const auto key = static_cast<std::uint32_t>(first_env_ + row / n) * kMostAgents +
                     static_cast<std::uint32_t>(row % n);
    Random random(TrainingSeed(config_.seed), Stream::kPolicy, collection,
                  static_cast<std::uint32_t>(step), key);
    const agent::AgentView view = env_.agent(row / n, row % n);
    int choice = 0;
    float log_prob = 0.0F;
    if (actor.network.chooses()) {
      const int count = LogShares(workspace_, row, &log_shares_);
      double left = random.Uniform();
      while (choice + 1 < count && (left -= std::exp(static_cast<double>(
                                        log_shares_[static_cast<std::size_t>(choice)]))) >= 0.0) {
        ++choice;
      }
      log_prob = log_shares_[static_cast<std::size_t>(choice)];
    }
    const float* mean =
        workspace_.means.data() +
        static_cast<std::ptrdiff_t>(workspace_.first[static_cast<std::size_t>(row)] + choice) *
            size;
    float command[agent::kCommandNumbers];
    std::copy(mean, mean + size, command);
    out->log_prob.push_back(log_prob +
                            agent::SampleGaussian(actor.log_std, size, &random, command));
    out->commands.insert(out->commands.end(), command, command + size);
    out->choices.push_back(choice);
    agent::TakeCommand(view, config_.action, command);
    if (actor.network.chooses()) {
      agent::TakeChoice(view, entities_[static_cast<std::size_t>(row)], choice);
    }
  }
}

void SwarmShard::FlyOn(int step, SwarmRollout* out) {
  const int n = env_.agents(), size = env_.action_size(), period = DecisionsOf(env_.scenario().run);
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
        for (int i = 0; i < n; ++i) {
          const auto row = static_cast<std::size_t>(e * n + i);
          AddCriticRow(env_, e, i, entities_[row], &last_);
          next_potential_[row] = static_cast<float>(Potential(e, i));
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
      out->done.push_back(ended ? 1 : 0);
      out->final_of.push_back(ended ? out->finals.rows() : -1);
      if (ended) out->finals.Add(last_, static_cast<int>(row));
      if (!ended) next_potential_[row] = static_cast<float>(Potential(e, i));
      out->own.push_back(sums_[row] / static_cast<float>(period));
    }
  }
  Reward(step, out);
}

void SwarmShard::Pay() {
  const int n = env_.agents();
  const config::Interval& band = env_.scenario().reward.band_m;
  const bool free = env_.scenario().agent.task.free();
  std::vector<int> inside(static_cast<std::size_t>(env_.scenario().world.target.count));
  const auto is_inside = [&](int e, int i) {
    const double distance = env_.tracking(e, i).distance;
    return distance >= band.lo && distance <= band.hi;
  };
  for (int e = 0; e < env_.envs(); ++e) {
    std::fill(inside.begin(), inside.end(), 0);
    for (int i = 0; i < n; ++i) {
      if (is_inside(e, i)) ++inside[static_cast<std::size_t>(env_.followed(e, i))];
    }
    const double covered = free ? ShareCovered(inside) : 0.0;
    for (int i = 0; i < n; ++i) {
      const auto row = static_cast<std::size_t>(e * n + i);
      sums_[row] += memory_.rewards[row] + static_cast<float>(config_.band * covered);
      if (!is_inside(e, i)) continue;
      const int count = inside[static_cast<std::size_t>(env_.followed(e, i))];
      sums_[row] += static_cast<float>(config_.band * ShareOfBand(free, count));
    }
  }
}

void SwarmShard::Reward(int step, SwarmRollout* out) const {
  const int n = env_.agents();
  const auto own_share = static_cast<float>(config_.own_reward);
  const auto gamma = static_cast<float>(config_.gamma);
  const float* own = out->own.data() + static_cast<std::ptrdiff_t>(step) * env_.envs() * n;
  const dynamics::TargetConfig& targets = env_.scenario().world.target;
  // AUVs that choose their targets share all of them.
  const bool free = env_.scenario().agent.task.free();
  for (int e = 0; e < env_.envs(); ++e) {
    for (int i = 0; i < n; ++i) {
      float sum = 0.0F;
      int mates = 0;
      for (int j = 0; j < n; ++j) {
        if (!free && targets.of(j) != targets.of(i)) continue;
        sum += own[e * n + j];
        ++mates;
      }
      const auto row = static_cast<std::size_t>(e * n + i);
      out->rewards.push_back(own_share * own[row] +
                             (1.0F - own_share) * sum / static_cast<float>(mates) +
                             gamma * next_potential_[row] - potential_[row]);
    }
  }
}

void SwarmShard::Collect(std::uint32_t collection, const SwarmActor& actor, SwarmRollout* out) {
  *out = SwarmRollout();
  out->steps = config_.horizon;
  out->envs = env_.envs();
  out->agents = env_.agents();
  const int n = env_.agents();
  for (int t = 0; t < config_.horizon; ++t) {
    for (int e = 0; e < env_.envs(); ++e) {
      for (int i = 0; i < n; ++i) {
        potential_[static_cast<std::size_t>(e * n + i)] = static_cast<float>(Potential(e, i));
      }
    }
    Observe(actor, collection, t, out);
    FlyOn(t, out);
  }
  for (int e = 0; e < env_.envs(); ++e) {
    for (int i = 0; i < n; ++i) {
      agent::Entities& entities = entities_[static_cast<std::size_t>(e * n + i)];
      agent::BuildEntities(env_.agent(e, i), &entities);
      AddCriticRow(env_, e, i, entities, &out->next);
    }
  }
}

}  // namespace stg::learn
