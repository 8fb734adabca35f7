#include "marl_trainer/env/evaluation.hpp"

#include <atomic>
#include <exception>
#include <mutex>
#include <thread>

#include "acoustic_channel/models/range.hpp"
#include "auv_common/error.hpp"
#include "stg_agent/agent/agent_view.hpp"

namespace stg::env {
namespace {

void DecideTruth(const Controller& c, const EnvGroup& env, double* actions) {
  const Scenario& s = env.scenario();
  const int n = env.agents(), size = env.action_size();
  std::vector<agent::NeighbourSight<Pack>> neighbours(static_cast<size_t>(n));
  for (int i = 0; i < n; ++i) {
    int count = 0;
    for (int j = 0; j < n; ++j) {
      if (j == i) continue;
      agent::NeighbourSight<Pack>& seen = neighbours[static_cast<size_t>(count++)];
      seen.known = Pack(1.0);
      seen.p_W = seen.p_WN = env.world().vehicle(j).p_WB;
      seen.v_W = env.world().vehicle(j).v_WB;
      seen.tracking_error = env.truth(j).error;
      seen.r_BN_W = seen.p_WN - env.world().vehicle(i).p_WB;
      seen.distance_m = env.world().distance(i, j);
      seen.link_quality = acoustics::RangeQuality(seen.distance_m, s.channel.range_m);
    }
    Pack a[dynamics::kMaxActionSize];
    c.builtin->Act({s, i, env.truth(i), neighbours.data(), count}, a);
    for (int lane = 0; lane < kLanes; ++lane) {
      for (int k = 0; k < size; ++k) actions[(lane * n + i) * size + k] = Lane(a[k], lane);
    }
  }
}

}  // namespace

Controller MakeController(const std::string& name, const Scenario& scenario) {
  Controller c;
  c.name = name;
  c.builtin = agent::MakeController(name);
  if (c.builtin) return c;
  auto policy = std::make_shared<agent::Policy>(agent::Policy::LoadOnnx(name));
  policy->RequireFits(scenario);
  c.policy = policy;
  return c;
}

void Decide(const Controller& c, const EnvGroup& env, double* actions) {
  const int n = env.agents(), size = env.action_size();
  const int rows = kLanes * n;
  const bool truth = c.privileged || env.scenario().mode == InformationMode::kTruth;
  if (c.policy == nullptr && truth) {
    DecideTruth(c, env, actions);
    return;
  }
  float a[dynamics::kMaxActionSize];
  for (int row = 0; row < rows; ++row) {
    if (c.policy != nullptr) {
      c.policy->Mean(env.observations() + static_cast<std::ptrdiff_t>(row) * env.observation_size(),
                     a);
    } else {
      c.builtin->Act(env.agent(row / n, row % n), a);
    }
    for (int k = 0; k < size; ++k) actions[row * size + k] = static_cast<double>(a[k]);
  }
}

std::vector<task::EpisodeMetrics> Evaluate(const Scenario& scenario, const Controller& controller,
                                           int episodes, std::uint64_t seed, int workers,
                                           const std::function<void(int)>& progress) {
  const int groups = (episodes + kLanes - 1) / kLanes;
  std::vector<task::EpisodeMetrics> metrics(static_cast<size_t>(groups * kLanes));
  std::atomic<int> next{0};
  std::mutex mutex;
  std::exception_ptr failure;
  int finished = 0;
  const auto work = [&] {
    try {
      for (int g = next++; g < groups; g = next++) {
        EnvOptions options;
        options.seed = seed;
        options.first_env = g * kLanes;
        options.total_envs = groups * kLanes;
        EnvGroup env(scenario, options);
        env.Reset();
        std::vector<double> actions(static_cast<size_t>(kLanes * env.agents() * env.action_size()));
        do {
          Decide(controller, env, actions.data());
          env.Step(actions.data());
        } while (!env.truncated());
        for (int lane = 0; lane < kLanes; ++lane) {
          metrics[static_cast<size_t>(g * kLanes + lane)] = env.metrics(lane);
        }
        const std::lock_guard<std::mutex> lock(mutex);
        finished = std::min(episodes, finished + kLanes);
        if (progress) progress(finished);
      }
    } catch (...) {
      const std::lock_guard<std::mutex> lock(mutex);
      if (!failure) failure = std::current_exception();
      next = groups;
    }
  };
  std::vector<std::thread> threads;
  for (int w = 1; w < std::min(workers, groups); ++w) threads.emplace_back(work);
  work();
  for (auto& t : threads) t.join();
  if (failure) std::rethrow_exception(failure);
  metrics.resize(static_cast<size_t>(episodes));
  return metrics;
}

}  // namespace stg::env
