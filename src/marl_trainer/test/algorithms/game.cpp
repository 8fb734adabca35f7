#include "algorithms/game.hpp"

#include <algorithm>

#include "auv_common/numbers/random.hpp"
#include "marl_trainer/learn/nn/blas.hpp"

namespace stg::learn {

Problem Game::problem() const {
  Problem p;
  p.agents = agents;
  p.action_scale = scale;
  return p;
}

int Third(float action, double scale) {
  const double limit = scale / 3.0;
  return static_cast<double>(action) < -limit ? 0 : static_cast<double>(action) > limit ? 2 : 1;
}

TrainSetup GameSetup(const std::string& algorithm, const nlohmann::json& options) {
  TrainSetup setup(algorithm, "fast");
  nlohmann::ordered_json json;
  const config::Table table = setup.Options();
  DumpOptions(table, &json);
  json["envs"] = 24;  // one full shard and one part of a shard
  json["horizon"] = 8;
  nlohmann::json small = {{"actor-hidden", {16, 16}},
                          {"critic-hidden", {32, 32}},
                          {"minibatch", 96},
                          {"lr", 3e-3},
                          {"critic-lr", 3e-3},
                          {"lr-final", 1.0},
                          {"batch", 64},
                          {"replayed", 2.0},
                          {"warmup", 960},
                          {"replay", 9600}};
  for (const auto& [key, value] : small.items()) {
    if (json.contains(key)) json[key] = value;
  }
  for (const auto& [key, value] : options.items()) {
    if (!json.contains(key)) throw std::logic_error(algorithm + " has no option " + key);
    json[key] = value;
  }
  ReadOptions(table, json);
  setup.ValidateOrThrow();
  return setup;
}

Training::Training(const Game& game, const TrainSetup& setup, int workers)
    : game_(game),
      setup_(setup),
      pool_(workers),
      algorithm_(setup_.own->Make(setup_.common, game.problem(), &pool_)) {
  UseOneBlasThread();
}

float Training::Context(int env, std::int64_t time, std::int64_t step) const {
  if (game_.path) return static_cast<float>(game_.path(static_cast<int>(step)));
  Random random(setup_.common.seed, Stream::kReset, 0, static_cast<std::uint32_t>(time),
                static_cast<std::uint32_t>(env));
  return static_cast<float>(random.Uniform(-1.0, 1.0));
}

void Training::PlayShard(const Collection& collection, int index, int worker, double* reward) {
  const Shard& shard = collection.shards[static_cast<std::size_t>(index)];
  const auto envs = static_cast<std::size_t>(shard.envs);
  const auto rows = envs * static_cast<std::size_t>(game_.agents);
  std::vector<float> states(envs), next_states(envs), final_states(envs);
  std::vector<float> seen(rows), next_seen(rows), final_seen(rows), actions(rows), log_prob(rows);
  std::vector<float> rewards(rows), team(envs), taught(game_.teacher ? rows : 0);
  std::vector<std::uint8_t> truncated(envs);
  const auto show = [&](const std::vector<float>& from, std::vector<float>* to) {
    for (std::size_t r = 0; r < rows; ++r) {
      (*to)[r] = from[r / static_cast<std::size_t>(game_.agents)];
    }
  };
  for (int t = 0; t < collection.steps; ++t) {
    const std::int64_t now = std::int64_t{collection.number} * collection.steps + t;
    const std::int64_t step = now % game_.episode;
    for (int e = 0; e < shard.envs; ++e) {
      const auto i = static_cast<std::size_t>(e);
      // The next state differs from the final one, so an algorithm that takes the wrong one fails.
      truncated[i] = step + 1 == game_.episode ? 1 : 0;
      states[i] = Context(shard.first_env + e, 2 * now, step);
      next_states[i] = Context(shard.first_env + e, 2 * now + 2, (step + 1) % game_.episode);
      final_states[i] = Context(shard.first_env + e, 2 * now + 1, step + 1);
    }
    show(states, &seen);
    show(next_states, &next_seen);
    show(final_states, &final_seen);
    const DrawKeys keys{setup_.common.seed, collection.number, static_cast<std::uint32_t>(t),
                        shard.first_env};
    Decision decision;
    decision.envs = shard.envs;
    decision.observations = seen.data();
    decision.explore = &keys;
    decision.worker = worker;
    algorithm_->Act(decision, {actions.data(), log_prob.data()});
    for (std::size_t e = 0; e < envs; ++e) {
      std::vector<float> clipped(
          actions.begin() + static_cast<std::ptrdiff_t>(e) * game_.agents,
          actions.begin() + static_cast<std::ptrdiff_t>(e + 1) * game_.agents);
      for (float& a : clipped) a = std::min(std::max(a, -1.0F), 1.0F);
      team[e] = static_cast<float>(game_.reward(static_cast<double>(states[e]), clipped.data()));
      *reward += static_cast<double>(team[e]);
      for (int i = 0; i < game_.agents; ++i) {
        rewards[e * static_cast<std::size_t>(game_.agents) + static_cast<std::size_t>(i)] =
            game_.own_reward ? static_cast<float>(game_.own_reward(static_cast<double>(states[e]),
                                                                   clipped.data(), i))
                             : team[e];
      }
    }
    for (std::size_t r = 0; r < taught.size(); ++r) {
      const auto agents = static_cast<std::size_t>(game_.agents);
      taught[r] = static_cast<float>(
          game_.teacher(static_cast<double>(states[r / agents]), static_cast<int>(r % agents)));
    }
    Transition transition;
    transition.shard = index;
    transition.step = t;
    transition.envs = shard.envs;
    transition.observations = seen.data();
    transition.states = states.data();
    transition.actions = actions.data();
    transition.log_prob = log_prob.data();
    transition.teacher = game_.teacher ? taught.data() : nullptr;
    transition.rewards = rewards.data();
    transition.team_rewards = team.data();
    transition.truncated = truncated.data();
    transition.next_observations = next_seen.data();
    transition.next_states = next_states.data();
    transition.final_observations = final_seen.data();
    transition.final_states = final_states.data();
    algorithm_->Observe(transition);
  }
}

double Training::Run(int collections, double progress) {
  double last = 0.0;
  for (int c = 0; c < collections; ++c) {
    Collection collection;
    collection.number = collection_++;
    collection.steps = setup_.common.horizon;
    collection.taught = game_.teacher != nullptr;
    collection.shards = ShardsOf(GroupShare(), 0, kGroups, setup_.common.envs);
    algorithm_->Begin(collection);
    std::vector<double> rewards(collection.shards.size(), 0.0);
    pool_.Run(static_cast<int>(rewards.size()), [&](int shard, int worker) {
      PlayShard(collection, shard, worker, &rewards[static_cast<std::size_t>(shard)]);
    });
    UpdateContext context;
    context.progress = progress;
    context.imitation = game_.teacher ? 1.0 : 0.0;
    report_ = algorithm_->Update(context);
    last = 0.0;
    for (const double reward : rewards) last += reward;
    last /= setup_.common.envs * setup_.common.horizon;
  }
  return last;
}

std::vector<float> Training::Act(double x) {
  const std::vector<float> seen(static_cast<std::size_t>(game_.agents), static_cast<float>(x));
  std::vector<float> actions(seen.size());
  Decision decision;
  decision.envs = 1;
  decision.observations = seen.data();
  algorithm_->Act(decision, {actions.data(), nullptr});
  return actions;
}

double Training::Reported(const std::string& column) const {
  const std::vector<ReportColumn> columns = algorithm_->Columns();
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i].name == column) return report_.values.at(i);
  }
  throw std::logic_error("no column " + column);
}

Archive Training::Save() const {
  Archive archive;
  algorithm_->Save(&archive);
  return archive;
}

}  // namespace stg::learn
