#include <algorithm>
#include <chrono>
#include <cstring>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <thread>

#include "auv_common/command_line.hpp"
#include "auv_common/config/files.hpp"
#include "auv_common/error.hpp"
#include "auv_common/stop_signals.hpp"
#include "marl_trainer/learn/run/trainer.hpp"
#include "ranks/mpi.hpp"
#include "stg_env/env/unread_keys.hpp"
#include "stg_env/scenario/scenario.hpp"

namespace {

bool Leads(const stg::learn::Communicator& ranks) { return ranks.rank() == 0; }

/// Reports the error and ends all ranks.
int Fail(const stg::learn::Communicator& ranks, const std::exception& error, int status) {
  // If all ranks have the same error, rank 0 reports it and ends the others during this pause.
  if (!Leads(ranks)) std::this_thread::sleep_for(std::chrono::seconds(2));
  std::cerr << "train" << (Leads(ranks) ? "" : " (rank " + std::to_string(ranks.rank()) + ")")
            << ": " << error.what() << std::endl;
  stg::learn::AbortRanks(status);
  return status;
}

/// Reads the value of an option before the other options are declared, because their defaults
/// depend on it.
std::string Argument(int argc, char** argv, const std::string& option,
                     const std::string& fallback) {
  const std::string start = option + "=";
  for (int i = 1; i < argc; ++i) {
    if (option == argv[i] && i + 1 < argc) return argv[i + 1];
    if (std::strncmp(argv[i], start.c_str(), start.size()) == 0) return argv[i] + start.size();
  }
  return fallback;
}

bool HasFlag(int argc, char** argv, const std::string& flag) {
  return std::find(argv + 1, argv + argc, flag) != argv + argc;
}

/// Lets the command line refuse the options that only other algorithms have.
void RefuseOptionsOfOthers(const std::string& algorithm, const stg::config::Table& own,
                           stg::CommandLine* app) {
  std::map<std::string, std::vector<std::string>> owners;
  for (const std::string& name : stg::learn::Algorithms().Names()) {
    const std::unique_ptr<stg::learn::AlgorithmConfig> other = stg::learn::Algorithms().Make(name);
    stg::config::Table table;
    other->Describe(&table);
    for (const stg::config::Field& option : table.fields()) {
      if (own.Find(option.path) == nullptr) owners[option.path].push_back(name);
    }
  }
  for (const auto& [option, names] : owners) {
    app->Refuse("--" + option, "belongs to " + stg::JoinNames(names) + ", but this training uses " +
                                   algorithm + " (--algorithm)");
  }
}

/// Throws UserError for a key of the scenario that this training does not read.
void RefuseUnreadKeys(const stg::learn::TrainSetup& setup,
                      const std::vector<std::string>& overrides) {
  stg::env::RefuseKeysOf(setup.common.variant, stg::env::VariantKeys::kAll, overrides);
  for (const std::string& text : overrides) {
    if (setup.own->ReadsState() || text.rfind("critic.", 0) != 0) continue;
    throw stg::UserError("--set '" + text +
                         "': belongs to a critic that reads the state of the whole swarm, but this "
                         "training uses " +
                         setup.algorithm + ", which has none");
  }
}

int Train(int argc, char** argv, stg::learn::Communicator* ranks) {
  stg::LoadPluginArguments(argc, argv);
  // A resumed run has the setup of its folder. Options may repeat it.
  std::optional<stg::learn::RunSetup> earlier;
  const std::string folder = Argument(argc, argv, "--out", "");
  if (HasFlag(argc, argv, "--resume") && !folder.empty()) {
    earlier = stg::learn::ReadRunSetup(folder);
  }
  stg::learn::TrainSetup setup =
      earlier ? earlier->setup
              : stg::learn::TrainSetup(
                    Argument(argc, argv, "--algorithm", stg::learn::DefaultAlgorithm()),
                    Argument(argc, argv, "--preset", "fast"));
  std::string scenario_name = "medium", condition = "nominal", out;
  std::vector<std::string> overrides, mix;
  bool resume = false;
  int workers = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));

  stg::CommandLine app("train", "Trains a policy and writes it as ONNX.");
  app.Add("--scenario", &scenario_name, "shipped name or file").ShowDefault();
  app.Add("--condition", &condition, "stress condition of a shipped scenario").ShowDefault();
  app.Add("--train-on", &mix,
          "conditions that the training environments cycle through, e.g. "
          "nominal,combined_stress; default: --condition alone")
      .SplitAt(',');
  app.Add("--algorithm", &setup.algorithm,
          "one of " + stg::JoinNames(stg::learn::Algorithms().Names()))
      .ShowDefault();
  app.Add("--preset", &setup.common.preset,
          "defaults of the options below: fast (of this project) or paper (Table S2)")
      .ShowDefault();
  app.Add("--variant", stg::config::Enum(&setup.common.variant, stg::env::VariantNames()),
          "observation, action interface and reward of Table S9; stg: those of the scenario");
  app.Add("--out", &out, "folder for checkpoints, policies and logs").Required();
  app.Add("--resume", &resume,
          "continue from the folder's newest intact checkpoint, with the folder's scenario, "
          "options and seed");
  app.Add("--workers", &workers, "number of threads; results do not depend on it")
      .From(1, 1024)
      .ShowDefault();
  app.Add("--set", &overrides, "scenario override key.path=value, repeatable").OneValuePerUse();
  const stg::config::Table table = setup.Options();
  app.Add(table);
  RefuseOptionsOfOthers(setup.algorithm, table, &app);
  app.AddPlugins();
  if (const std::optional<int> status = app.Parse(argc, argv)) return *status;

  RefuseUnreadKeys(setup, overrides);
  const bool names_scenario = app.Count("--scenario") + app.Count("--condition") +
                                  app.Count("--train-on") + app.Count("--set") >
                              0;
  const bool kept = earlier && !names_scenario;
  const stg::Scenario scenario = kept ? earlier->scenario
                                      : stg::LoadNamedScenario(stg::config::ScenarioFolder(),
                                                               scenario_name, condition, overrides);
  const stg::Scenario trained = stg::env::VariantScenario(scenario, setup.common.variant);
  stg::env::RefuseUnreadBy(setup.common.variant, trained, overrides);
  const stg::learn::ImitationConfig* const imitation = setup.own->Imitation();
  stg::env::RefuseUnreadInTraining(imitation != nullptr ? imitation->controller : "",
                                   {trained.model(), trained.mode, trained.reward.kind}, overrides);
  stg::learn::Trainer::Options options;
  options.out = out;
  options.resume = resume;
  options.workers = workers;
  std::ostream nowhere(nullptr);
  std::ostream& lines = Leads(*ranks) ? std::cout : nowhere;
  options.log = &lines;
  options.ranks = ranks;
  if (kept) options.mix = earlier->mix;
  for (const std::string& name : mix) {
    options.mix.push_back(
        stg::LoadNamedScenario(stg::config::ScenarioFolder(), scenario_name, name, overrides));
  }
  options.stop = &stg::HeedStopSignals();
  stg::learn::Trainer trainer(scenario, setup, options);
  if (trainer.Run()) {
    if (Leads(*ranks) && !std::cout.flush()) {
      throw stg::UserError("the training is saved, but standard output cannot be written");
    }
    return 0;
  }
  lines << "stopped at " << trainer.state().env_steps << " steps and saved; --resume continues"
        << std::endl;
  return stg::kStopped;
}

}  // namespace

int main(int argc, char** argv) {
  std::unique_ptr<stg::learn::Communicator> ranks = std::make_unique<stg::learn::OneRank>();
  try {
    ranks = stg::learn::JoinRanks(&argc, &argv);
    return Train(argc, argv, ranks.get());
  } catch (const stg::UserError& error) {
    return Fail(*ranks, error, 2);
  } catch (const std::exception& error) {
    return Fail(*ranks, error, 1);
  }
}
