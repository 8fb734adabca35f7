#include <chrono>
#include <iostream>
#include <nlohmann/json.hpp>

#include "auv_common/command_line.hpp"
#include "auv_common/config/files.hpp"
#include "auv_common/error.hpp"
#include "auv_common/numbers/random.hpp"
#include "auv_common/parallel/worker_pool.hpp"
#include "auv_common/program.hpp"
#include "stg_env/env/vector_env.hpp"
#include "stg_env/scenario/scenario.hpp"

namespace {

using Clock = std::chrono::steady_clock;

/// Environment steps per second of `env` on one thread for about `seconds`.
double Run(stg::env::VectorEnv* env, double seconds) {
  const auto size = static_cast<size_t>(env->envs() * env->agents() * env->action_size());
  // Random actions are drawn in advance, so that only the environment is measured.
  std::vector<std::vector<float>> actions(64, std::vector<float>(size));
  stg::Random random(1, stg::Stream::kPolicy, 0, 0, 0);
  for (auto& a : actions) {
    for (float& v : a) v = static_cast<float>(random.Uniform(-1.0, 1.0));
  }
  stg::env::EnvMemory memory = env->MakeMemory();
  env->Reset(memory.arrays());
  const auto start = Clock::now();
  double elapsed = 0.0;
  long steps = 0;
  for (size_t k = 0; elapsed < seconds; ++k) {
    env->Step(actions[k % actions.size()].data(), memory.arrays());
    steps += env->envs();
    if (k % 16 == 15) elapsed = std::chrono::duration<double>(Clock::now() - start).count();
  }
  return static_cast<double>(steps) / elapsed;
}

double Bench(const stg::Scenario& s, int envs, int workers, double seconds) {
  std::vector<double> rates(static_cast<size_t>(workers));
  stg::WorkerPool pool(workers);
  pool.Run(workers, [&](int w, int) {
    stg::env::VectorEnvOptions o;
    o.envs = envs / workers;
    o.first_env = w * o.envs;
    o.total_envs = workers * o.envs;
    stg::env::VectorEnv env(s, o);
    rates[static_cast<size_t>(w)] = Run(&env, seconds);
  });
  double total = 0.0;
  for (const double r : rates) total += r;
  return total;
}

/// Throws UserError for an override of a key that --scaling sets.
void RefuseKeysOfScaling(const std::vector<std::string>& overrides) {
  for (const std::string& text : overrides) {
    if (text.rfind("agents=", 0) != 0 && text.rfind("reset.min_separation_m=", 0) != 0) continue;
    throw stg::UserError("--set '" + text + "': --scaling sets this key; leave out one of the two");
  }
}

}  // namespace

/// Measures environment steps per second, including observations and rewards. The last line is one
/// JSON object.
int main(int argc, char** argv) {
  stg::CommandLine app("bench_env", "Measures how fast the vectorised environment steps");
  std::string scenario = "medium", condition = "nominal";
  std::vector<std::string> overrides;
  double seconds = 3.0;
  int workers = 1, envs = 64;
  bool scaling = false;
  app.Add("--scenario", &scenario, "name or file").ShowDefault();
  app.Add("--condition", &condition, "stress condition").ShowDefault();
  app.Add("--set", &overrides, "scenario override key.path=value, repeatable");
  app.Add("--seconds", &seconds, "time to measure for").ShowDefault();
  app.Add("--workers", &workers, "threads").From(1, 256).ShowDefault();
  app.Add("--envs", &envs, "parallel environments, rounded down to a multiple of --workers")
      .From(1, 100000)
      .ShowDefault();
  app.Add("--scaling", &scaling, "also measure 4, 8, 20, 50 and 100 AUVs");
  app.AddPlugins();
  return app.Run(argc, argv, [&] {
    stg::CheckOption("--seconds", seconds, 1e-6, 1e6);
    stg::RefuseKeysOfTraining(overrides, "bench_env");
    if (scaling) RefuseKeysOfScaling(overrides);
    const auto load = [&](std::vector<std::string> extra) {
      extra.insert(extra.begin(), overrides.begin(), overrides.end());
      return stg::LoadNamedScenario(stg::config::ScenarioFolder(), scenario, condition, extra);
    };
    const stg::Scenario s = load({});
    // Each worker has the same number of environments.
    envs = workers * std::max(1, envs / workers);
    const double rate = Bench(s, envs, workers, seconds);
    nlohmann::json json = {
        {"scenario", scenario},         {"agents", s.run.agents},
        {"workers", workers},           {"environments", envs},
        {"env_steps_per_second", rate}, {"agent_steps_per_second", rate * s.run.agents}};
    std::cout << scenario << ": " << static_cast<long>(rate) << " environment steps/s of "
              << s.run.agents << " AUVs on " << workers << " worker(s)\n";
    if (scaling) {
      nlohmann::json rows = nlohmann::json::array();
      for (const int n : {4, 8, 20, 50, 100}) {
        const stg::Scenario sn =
            load({"agents=" + std::to_string(n), "reset.min_separation_m=0.03"});
        const double r = Bench(sn, envs, workers, seconds);
        const double ns = 1e9 * workers / (r * n);
        std::cout << "  " << n << " AUVs: " << static_cast<long>(r) << " environment steps/s, "
                  << static_cast<long>(ns) << " ns per agent-step\n";
        rows.push_back({{"agents", n}, {"env_steps_per_second", r}, {"ns_per_agent_step", ns}});
      }
      json["scaling"] = rows;
    }
    stg::PrintResult(json);
    return 0;
  });
}
