#include "marl_trainer/env/evaluation.hpp"

#include <atomic>
#include <exception>
#include <mutex>
#include <thread>

#include "auv_common/error.hpp"
#include "auv_dynamics/control/control.hpp"
#include "stg_agent/agent/agent.hpp"

namespace stg::env {
namespace {

void DecideTruth(const Controller& c, const EnvGroup& env, double* actions) {
  const Scenario& s = env.scenario();
  const int n = env.agents(), size = env.action_size();
  std::vector<Vec3<Pack>> neighbours(static_cast<size_t>(n));
  for (int i = 0; i < n; ++i) {
    int count = 0;
    for (int j = 0; j < n; ++j) {
      if (j != i) {
        neighbours[static_cast<size_t>(count++)] =
            env.world().vehicle(j).p_WB - env.world().vehicle(i).p_WB;
      }
    }
    Pack a[6];
    const agent::Knowledge<Pack>& k = env.truth(i);
    agent::PursuitAction(c.options, s, k, neighbours.data(), count, a);
    if (s.control.interface == dynamics::ActionInterface::kTau6) {
      const dynamics::VehicleState<Pack>& v = env.world().vehicle(i);
      Pack fraction[6];
      dynamics::VelocityController(s.control, s.vehicle, dynamics::DesiredVelocity(s.vehicle, a),
                                   v.R_WB, v.v_WB, RpyOf(v.trig), v.w_WB_B, fraction);
      std::copy(fraction, fraction + 6, a);
    }
    for (int lane = 0; lane < kLanes; ++lane) {
      for (int k2 = 0; k2 < size; ++k2) actions[(lane * n + i) * size + k2] = Lane(a[k2], lane);
    }
  }
}

}  // namespace

Controller MakeController(const std::string& name, const Scenario& scenario) {
  Controller c;
  c.name = name;
  if (agent::ParseBuiltin(name, &c.builtin, &c.options)) return c;
  auto policy = std::make_shared<agent::Policy>(agent::Policy::LoadOnnx(name));
  policy->RequireFits(scenario);
  c.policy = policy;
  return c;
}

void Decide(const Controller& c, const EnvGroup& env, double* actions) {
  const int n = env.agents(), size = env.action_size();
  const int rows = kLanes * n;
  if (c.policy == nullptr && c.builtin == agent::BuiltinKind::kIdle) {
    std::fill(actions, actions + rows * size, 0.0);
    return;
  }
  const bool truth = c.privileged || env.scenario().mode == InformationMode::kTruth;
  if (c.policy == nullptr && truth) {
    DecideTruth(c, env, actions);
    return;
  }
  float a[6];
  for (int row = 0; row < rows; ++row) {
    if (c.policy != nullptr) {
      c.policy->Mean(env.observations() + static_cast<std::ptrdiff_t>(row) * env.observation_size(),
                     a);
    } else {
      agent::BuiltinAction(c.builtin, c.options, env.agent(row / n, row % n), a);
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
