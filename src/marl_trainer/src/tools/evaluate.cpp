#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <thread>

#include "auv_common/command_line.hpp"
#include "auv_common/config/files.hpp"
#include "auv_common/durable_file.hpp"
#include "auv_common/error.hpp"
#include "auv_common/program.hpp"
#include "stg_agent/controllers/controller.hpp"
#include "stg_env/env/evaluation.hpp"
#include "stg_env/env/seed_blocks.hpp"
#include "stg_env/env/unread_keys.hpp"
#include "stg_env/env/variants.hpp"
#include "stg_env/record/recorder.hpp"
#include "stg_env/record/scene.hpp"
#include "stg_env/scenario/scenario.hpp"

namespace {

/// One row per episode; there is at least one.
/// @param training_returns of the same episodes
std::string Table(const std::vector<stg::task::EpisodeMetrics>& episodes,
                  const std::vector<double>& training_returns, std::uint64_t seed) {
  std::ostringstream out;
  out << "episode,seed";
  for (const auto& item : episodes.front().Items()) out << ',' << item.first;
  out << ",training_return\n";
  for (size_t e = 0; e < episodes.size(); ++e) {
    out << e << ',' << seed + e;
    for (const auto& item : episodes[e].Items()) out << ',' << item.second;
    out << ',' << training_returns[e] << '\n';
  }
  return out.str();
}

/// The output of --csv. A file is replaced by the complete new one; a pipe or a device is written
/// directly.
class CsvOutput {
 public:
  /// Throws UserError at once if the path cannot be written. "" means no output.
  explicit CsvOutput(const std::string& path) : path_(path) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    streams_ = std::filesystem::is_fifo(status) || std::filesystem::is_character_file(status);
    if (path.empty() || streams_) return;
    file_.emplace(path, "the table");
    // For --csv /dev/stdout > FILE: the summary would be lost in the replaced file.
    if (std::filesystem::equivalent(path, "/dev/stdout", error)) {
      file_->Fail("standard output goes there");
    }
  }
  void Write(const std::string& table) {
    if (file_) file_->Write(table);
    if (!streams_) return;
    std::ofstream out(path_);
    if (!(out << table).flush()) throw stg::UserError(path_ + ": cannot write the table");
  }

 private:
  std::string path_;
  bool streams_ = false;
  std::optional<stg::DurableFile> file_;
};

/// The constants of all controllers as options of the command line: --gain 2 means pursuit:gain=2.
class Constants {
 public:
  explicit Constants(stg::CommandLine* app) {
    for (const std::string& name : stg::agent::Controllers().Names()) {
      stg::config::OptionsByName options;
      stg::config::Table table;
      stg::agent::Controllers().DescribeOne(name, &options, &table);
      for (const stg::config::Field& field : table.fields()) {
        Constant& constant = constants_[field.path];
        constant.owners.push_back(name);
        if (constant.owners.size() > 1) continue;
        const std::string unit = field.unit == "-" ? "" : " [" + field.unit + "]";
        app->Add("--" + field.path, &constant.value, field.meaning + unit)
            .Group("Constants of controllers");
      }
    }
  }
  /// The policy with the given constants. Throws UserError for a constant that it does not have, or
  /// that its text states, too.
  std::string AddTo(const std::string& policy) const {
    std::string text = policy;
    const std::string name = policy.substr(0, policy.find(':'));
    for (const auto& [key, constant] : constants_) {
      if (constant.value.empty()) continue;
      const auto& owners = constant.owners;
      if (std::find(owners.begin(), owners.end(), name) == owners.end()) {
        throw stg::UserError("--" + key + ": belongs to " + stg::JoinNames(owners) +
                             ", but this evaluation flies '" + policy + "'");
      }
      for (const char* before : {":", ","}) {
        if (policy.find(before + key + "=") == std::string::npos) continue;
        throw stg::UserError("--" + key + ": --policy '" + policy +
                             "' states this constant, too; leave out one of the two");
      }
      text += (text.find(':') == std::string::npos ? ":" : ",") + key + "=" + constant.value;
    }
    return text;
  }

 private:
  struct Constant {
    std::string value;
    std::vector<std::string> owners;
  };
  std::map<std::string, Constant> constants_;
};

}  // namespace

/// Computes the paper's metrics for one policy or built-in controller: a table, and one JSON object
/// on the last line.
int main(int argc, char** argv) {
  stg::CommandLine app("evaluate",
                       "Evaluates a policy or built-in controller on held-out episodes");
  std::string policy, scenario = "medium", condition = "nominal", csv, record;
  auto variant = stg::env::Variant::kStg;
  std::vector<std::string> overrides;
  int record_episodes = 1;
  int episodes = 30, workers = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  std::uint64_t seed = 3000;
  bool privileged = false;
  app.Add("--policy", &policy,
          "ONNX file, or one of " + stg::JoinNames(stg::agent::Controllers().Names()) +
              ", with constants after a colon: pursuit:gain=2,cap=0.5")
      .Required();
  app.Add("--scenario", &scenario, "name or file").ShowDefault();
  app.Add("--condition", &condition,
          "a file, or one of " +
              stg::JoinNames(stg::config::ConditionNames(stg::config::ScenarioFolder())))
      .ShowDefault();
  app.Add("--variant", stg::config::Enum(&variant, stg::env::VariantNames()),
          "observation and action interface of the policy (Table S9); return uses the scenario's "
          "reward, training_return that of the variant");
  app.Add("--episodes", &episodes, "number of episodes").From(1, 1000000).ShowDefault();
  app.Add("--seed", &seed,
          "episode e is drawn from seed + e; from " +
              std::to_string(stg::env::kReportingSeeds.first) + " to " +
              std::to_string(stg::env::kReportingSeeds.last) +
              " are seeds that no training and no choice used")

      .ShowDefault();
  app.Add("--set", &overrides, "scenario override key.path=value, repeatable");
  app.Add("--workers", &workers, "threads").From(1, 256);
  app.Add("--csv", &csv, "write one row per episode to this file");
  app.Add("--record", &record,
          "folder for a recording of the first episodes, which ./stg report shows");
  app.Add("--record-episodes", &record_episodes, "number of recorded episodes")
      .From(1, 1000)
      .ShowDefault()
      .Needs("--record");
  app.Add("--privileged", &privileged,
          "a built-in controller reads true states, also in acoustic mode");
  Constants constants(&app);
  app.AddPlugins();
  return app.Run(argc, argv, [&] {
    policy = constants.AddTo(policy);
    const stg::Scenario given =
        stg::LoadNamedScenario(stg::config::ScenarioFolder(), scenario, condition, overrides);
    stg::RefuseKeysOfTraining(overrides, "evaluate");
    stg::env::RefuseKeysOf(variant, stg::env::VariantKeys::kWithoutReward, overrides);
    const stg::Scenario s = stg::env::EvaluationScenario(given, variant);
    stg::agent::Decider controller = stg::agent::MakeDecider(policy, s.model());
    stg::env::RefuseUnreadBy(variant, s, overrides);
    stg::env::RefuseUnread(controller, {s.model(), s.mode, s.reward.kind}, overrides);
    if (record_episodes > episodes) {
      throw stg::UserError("--record-episodes: there are only " + std::to_string(episodes) +
                           " episodes (--episodes)");
    }
    if (privileged) stg::env::ReadTruth(&controller, s.mode);
    CsvOutput table(csv);
    stg::WorkerPool pool(std::min(workers, episodes));
    stg::env::EvaluationOptions options;
    options.episodes = episodes;
    options.seed = seed;
    const auto fly = [&](const stg::Scenario& flown) {
      auto metrics = stg::env::Evaluate(
          stg::env::EnvFactory(flown), controller, options, &pool,
          [&](int done) { std::fprintf(stderr, "\r%d / %d episodes", done, episodes); });
      std::fprintf(stderr, "\n");
      return metrics;
    };
    const auto metrics = fly(s);
    // The flights are the same, because a reward has no effect on them.
    const auto own = variant == stg::env::Variant::kStg
                         ? metrics
                         : fly(stg::env::VariantScenario(given, variant));
    std::vector<double> training_returns;
    for (const auto& episode : own) training_returns.push_back(episode.episode_return);
    table.Write(Table(metrics, training_returns, seed));
    if (!record.empty()) {
      nlohmann::json scene = stg::env::SceneOf(s.judge(), s.channel);
      scene["condition"] = condition;
      stg::env::RecordEpisodes(stg::env::EnvFactory(s), scene, controller, seed, episodes,
                               record_episodes, record);
    }
    stg::task::MetricSummary summary = stg::task::Summarise(metrics);
    const stg::task::MetricSummary own_summary = stg::task::Summarise(own);
    summary.Append("training_return", own_summary.Mean("return"), own_summary.Std("return"));
    const std::string block = stg::env::SeedBlockOf(seed, static_cast<std::uint64_t>(episodes));
    nlohmann::json json = {{"policy", policy},       {"scenario", scenario},
                           {"condition", condition}, {"episodes", episodes},
                           {"seed", seed},           {"scenario_hash", stg::ScenarioHash(s)},
                           {"seed_block", block}};
    std::printf("%s on %s, %s: %d episodes from seed %llu, of %s block\n", policy.c_str(),
                scenario.c_str(), condition.c_str(), episodes,
                static_cast<unsigned long long>(seed),
                block == "no" ? "no" : ("the " + block).c_str());
    for (size_t k = 0; k < summary.names.size(); ++k) {
      if (summary.mean[k] >= 1e9) {  // there is nothing to measure, see Metrics
        std::printf("  %-24s %12s\n", summary.names[k].c_str(), "-");
      } else {
        std::printf("  %-24s %12.5f +- %.5f\n", summary.names[k].c_str(), summary.mean[k],
                    summary.std[k]);
      }
      json[summary.names[k]] = summary.mean[k];
      json[summary.names[k] + "_std"] = summary.std[k];
    }
    stg::PrintResult(json);
    return 0;
  });
}
