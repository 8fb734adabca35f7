#include "marl_trainer/learn/validation.hpp"

#include <algorithm>

#include "marl_trainer/learn/train_config.hpp"

namespace stg::learn {

/// Environments that one worker flies through whole episodes.
struct Validation::Unit {
  static constexpr int kEnvs = 16;

  Unit(const Scenario& scenario, const ActorCritic& networks, int first_env, int envs,
       int total_envs)
      : workspace(networks.actor, envs * scenario.agents),
        observations(static_cast<std::size_t>(envs * scenario.agents * networks.actor.inputs())) {
    env::EnvOptions options;
    options.seed = kValidationSeed;
    options.total_envs = total_envs;
    for (int env = 0; env < envs; env += kLanes) {
      options.first_env = first_env + env;
      groups.emplace_back(scenario, options);
    }
  }

  void Fly(const ActorCritic& networks, const float* parameters, const Normaliser& normaliser,
           int steps, task::EpisodeMetrics* metrics) {
    const int rows_per_group = kLanes * groups.front().agents();
    const int rows = rows_per_group * static_cast<int>(groups.size());
    const int size = networks.action_size();
    for (env::EnvGroup& group : groups) group.RestartAt(0, 0);
    for (int t = 0; t < steps; ++t) {
      float* x = observations.data();
      for (env::EnvGroup& group : groups) {
        normaliser.Apply(group.observations(), rows_per_group, x);
        x += rows_per_group * networks.actor.inputs();
      }
      networks.actor.Forward(parameters, observations.data(), rows, &workspace);
      float* action = workspace.output();
      SquashMean(networks.action_scale, rows * size, action);
      for (env::EnvGroup& group : groups) {
        group.Step(action);
        action += rows_per_group * size;
      }
    }
    for (env::EnvGroup& group : groups) {
      for (int lane = 0; lane < kLanes; ++lane) *metrics++ = group.metrics(lane);
    }
  }

  std::vector<env::EnvGroup> groups;
  Mlp::Workspace workspace;
  std::vector<float> observations;
};

Validation::Validation(const Scenario& scenario, const ActorCritic& networks, int episodes,
                       WorkerPool* pool)
    : networks_(networks),
      episode_steps_(scenario.time.episode_steps),
      episodes_(episodes),
      pool_(pool) {
  const int total = (episodes + kLanes - 1) / kLanes * kLanes;
  for (int first = 0; first < total; first += Unit::kEnvs) {
    units_.push_back(std::make_unique<Unit>(scenario, networks, first,
                                            std::min(Unit::kEnvs, total - first), total));
  }
}

Validation::~Validation() = default;

std::vector<task::EpisodeMetrics> Validation::Run(const float* parameters,
                                                  const Normaliser& observations) {
  std::vector<task::EpisodeMetrics> metrics(units_.size() * static_cast<std::size_t>(Unit::kEnvs));
  pool_->Run(static_cast<int>(units_.size()), [&](int u, int) {
    units_[static_cast<std::size_t>(u)]->Fly(
        networks_, parameters, observations, episode_steps_,
        metrics.data() + static_cast<std::ptrdiff_t>(u) * Unit::kEnvs);
  });
  metrics.resize(static_cast<std::size_t>(episodes_));
  return metrics;
}

}  // namespace stg::learn
