#include <algorithm>
#include <iostream>
#include <thread>

#include "auv_common/command_line.hpp"
#include "auv_common/config/files.hpp"
#include "auv_common/error.hpp"
#include "auv_common/program.hpp"
#include "auv_common/stop_signals.hpp"
#include "marl_trainer/learn/options.hpp"
#include "marl_trainer/learn/swarm/swarm_trainer.hpp"
#include "ranks/started_by_mpi.hpp"

int main(int argc, char** argv) {
  stg::CommandLine app("train_swarm",
                       "Trains one policy for swarms of any size and writes it as ONNX.");
  std::vector<std::string> scenarios = {"field"};
  stg::learn::SwarmConfig config;
  stg::learn::SwarmTrainer::Options options;
  options.workers = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  app.Add("--scenario", &scenarios,
          "shipped name or file, in open water; with --action velocity3: between walls, and "
          "several of them with commas between them")
      .SplitAt(',')
      .ShowDefault();
  app.Add("--out", &options.out, "folder for checkpoint, policies and logs").Required();
  app.Add("--resume", &options.resume, "continue from the folder's checkpoint");
  app.Add("--start-from", &options.start_from,
          "folder of another training, whose networks and moments are the start of this one");
  app.Add("--workers", &options.workers, "number of threads; results do not depend on it")
      .From(1, 256)
      .ShowDefault();
  stg::config::Table table;
  config.Describe(&table);
  app.Add(table);
  std::vector<std::string> overrides;
  app.Add("--set", &overrides,
          "scenario override key.path=value of every kind of waters, also of the reward of the "
          "training; repeatable")
      .OneValuePerUse();
  app.AddPlugins();
  return app.Run(argc, argv, [&] {
    if (stg::learn::StartedByMpi()) {
      throw stg::UserError("this training has no ranks: start it without mpirun, with --workers");
    }
    options.log = &std::cout;
    options.stop = &stg::HeedStopSignals();
    options.overrides = overrides;
    const std::string folder = stg::config::ScenarioFolder();
    const int kinds = config.envs / 8;
    std::vector<stg::learn::SwarmTask> mixture, validation;
    if (config.action == stg::agent::EntityAction::kVelocity3) {
      mixture = stg::learn::WallsMixture(folder, scenarios, config, kinds, overrides);
      validation = stg::learn::WallsValidation(folder, scenarios, overrides);
    } else {
      stg::learn::RequireOption(scenarios.size() == 1, "scenario", "must be one in open water");
      mixture = stg::learn::FieldMixture(folder, scenarios[0], config, kinds, overrides);
      validation = stg::learn::FieldValidation(folder, scenarios[0], config, overrides);
    }
    stg::learn::SwarmTrainer trainer(std::move(mixture), std::move(validation), config, options);
    if (trainer.Run()) return 0;
    std::cout << "stopped and saved; --resume continues" << std::endl;
    return stg::kStopped;
  });
}
