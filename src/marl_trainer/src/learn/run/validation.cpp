#include "marl_trainer/learn/run/validation.hpp"

#include <algorithm>

#include "marl_trainer/learn/train_config.hpp"
#include "stg_env/env/evaluation.hpp"

namespace stg::learn {
namespace {

constexpr int kBlock = 16;  // environments per pass through the network

}  // namespace

std::vector<task::EpisodeMetrics> Validate(const env::EnvFactory& make_env, int episodes,
                                           Algorithm* algorithm, const Team& team) {
  const env::ActFactory make_act = [algorithm](const env::VectorEnv& env,
                                               int worker) -> env::ActFunction {
    std::vector<float> chosen(
        static_cast<std::size_t>(env.envs() * env.agents() * env.action_size()));
    return [algorithm, worker, chosen](const env::VectorEnv& flown, const float* observations,
                                       double* actions) mutable {
      Decision decision;
      decision.envs = flown.envs();
      decision.observations = observations;
      decision.worker = worker;
      algorithm->Act(decision, {chosen.data(), nullptr});
      for (const float a : chosen) *actions++ = static_cast<double>(a);
    };
  };
  env::EvaluationOptions options;
  options.episodes = episodes;
  options.seed = kValidationSeed;
  options.block = kBlock;
  // Every rank gets whole blocks, so that the results of a block do not depend on the worker.
  const int blocks = (episodes + kBlock - 1) / kBlock;
  const auto first = [&](int rank) {
    return std::min(episodes, blocks * rank / team.ranks->size() * kBlock);
  };
  const int begin = first(team.ranks->rank());
  options.episodes = first(team.ranks->rank() + 1) - begin;
  options.seed += static_cast<std::uint64_t>(begin);
  std::vector<task::EpisodeMetrics> own;
  if (options.episodes > 0) own = env::Evaluate(make_env, make_act, options, team.pool);
  return team.ranks->Gather(own);
}

}  // namespace stg::learn
