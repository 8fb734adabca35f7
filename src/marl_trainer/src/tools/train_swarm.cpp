#include <algorithm>
#include <iostream>
#include <thread>

#include "auv_common/command_line.hpp"
#include "auv_common/config/files.hpp"
#include "auv_common/error.hpp"
#include "auv_common/program.hpp"
#include "auv_common/stop_signals.hpp"
#include "marl_trainer/learn/swarm/swarm_trainer.hpp"
#include "seed_check.hpp"

/// Trains one policy for swarms of any size in open water.
int main(int argc, char** argv) {
  CLI::App app("Trains one policy for swarms of any size in open water and writes it as ONNX.");
  std::string scenario = "field", action = "law5", network = "pool";
  stg::learn::SwarmConfig config;
  stg::learn::SwarmTrainer::Options options;
  options.workers = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  app.add_option("--scenario", scenario, "shipped name or file, in open water")
      ->capture_default_str();
  app.add_option("--out", options.out, "folder for checkpoint, policies and logs")->required();
  app.add_flag("--resume", options.resume, "go on from the folder's checkpoint");
  app.add_option("--start-from", options.start_from,
                 "folder of another training whose networks and moments this one begins with");
  app.add_option("--episode-steps", config.episode_steps, "decisions of a training episode")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  app.add_option("--workers", options.workers, "threads; results do not depend on them")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  app.add_option("--action", action,
                 "law5: the policy guides the law that the situation asks for; guidance: always "
                 "encircle; course3: it steers by itself")
      ->capture_default_str();
  app.add_option("--network", network,
                 "pool: means and maxima over rows; graph: attention and messages over the task "
                 "graph, which also chooses which target to follow")
      ->capture_default_str();
  app.add_option("--without", config.without,
                 "what the policy cannot see: " + stg::learn::BlindNames());
  app.add_flag("--free-assignment", config.free_assignment,
               "a quarter of the waters has two targets, which the AUVs choose; --network graph");
  app.add_option("--seed", config.seed, "of networks, episodes and exploration")
      ->check(stg::learn::SeedCheck())
      ->capture_default_str();
  app.add_option("--steps", config.steps, "decisions of a swarm")
      ->check(CLI::Range(1LL, 1'000'000'000'000LL))
      ->capture_default_str();
  app.add_option("--envs", config.envs, "environments, eight for each kind of waters")
      ->check(CLI::Range(8, 4096))
      ->capture_default_str();
  app.add_option("--gamma", config.gamma, "discount for each command")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--learning-rate", config.learning_rate, "at first")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--log-std", config.log_std,
                 "log of the first deviation of exploration, also after --start-from")
      ->check(CLI::Range(-3.0, -0.5))
      ->capture_default_str();
  app.add_option("--segment", config.segment, "collections between two checkpoints")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app.add_option("--validation-episodes", config.validation_episodes, "for each validation task")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  stg::AddPluginOption(&app);
  return stg::RunProgram("train_swarm", &app, argc, argv, [&] {
    config.action = stg::agent::EntityActionNamed(action);
    config.network = stg::agent::EntityNetworkNamed(network);
    options.log = &std::cout;
    options.stop = &stg::HeedStopSignals();
    const std::string folder = stg::config::ScenarioFolder();
    stg::learn::SwarmTrainer trainer(
        stg::learn::FieldMixture(folder, scenario, config, config.envs / 8),
        stg::learn::FieldValidation(folder, scenario), config, options);
    if (trainer.Run()) return 0;
    std::cout << "stopped and saved; --resume goes on" << std::endl;
    return stg::kStopped;
  });
}
