#include "marl_trainer/learn/swarm/swarm_trainer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "auv_common/durable_file.hpp"
#include "auv_common/error.hpp"
#include "marl_trainer/learn/nn/blas.hpp"
#include "marl_trainer/learn/options.hpp"
#include "marl_trainer/learn/stopwatch.hpp"
#include "stg_agent/entities/entity_pilot.hpp"
#include "stg_env/env/evaluation.hpp"

namespace stg::learn {
namespace {

constexpr int kShardEnvs = 8;

std::string Number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", x);
  return text;
}

}  // namespace

SwarmTrainer::SwarmTrainer(std::vector<SwarmTask> mixture, std::vector<SwarmTask> validation,
                           const SwarmConfig& config, const Options& options)
    : config_(config),
      options_(options),
      mixture_(std::move(mixture)),
      validation_(std::move(validation)),
      pool_(options.workers),
      learner_(config) {
  UseOneBlasThread();
  const int count = static_cast<int>(mixture_.size());
  if (count * kShardEnvs != config.envs) {
    throw UserError("envs: " + std::to_string(config.envs) + " environments are not " +
                    std::to_string(kShardEnvs) + " for each of " + std::to_string(count) +
                    " kinds of waters");
  }
  std::filesystem::create_directories(options.out);
  lock_.emplace(options.out);
  const bool there = std::filesystem::exists(options.out + "/checkpoint.ckpt");
  if (there && !options.resume) {
    throw UserError(options.out + ": holds a training; --resume continues it");
  }
  if (options.resume && !options.start_from.empty()) {
    throw UserError("--start-from: has no effect with --resume, which continues " + options.out);
  }
  if (!there && options.resume) throw UserError(options.out + ": holds no training to resume");
  for (int k = 0; k < count; ++k) {
    shards_.push_back(std::make_unique<SwarmShard>(
        env::EnvFactory(mixture_[static_cast<std::size_t>(k)].scenario), config, k * kShardEnvs,
        kShardEnvs, config.envs));
  }
  rollouts_.resize(shards_.size());
  if (there) {
    LoadAll();
  } else {
    WriteDurably(ConfigText(), options.out + "/config.json", "the configuration");
    if (!options.start_from.empty()) {
      learner_.Load(ReadArchive(options.start_from + "/checkpoint.ckpt").Part("learner"));
      learner_.RequireBlind(options.start_from);
      learner_.SetDeviation(config.log_std);
    }
  }
}

std::int64_t SwarmTrainer::StepsOfCollection() const {
  std::int64_t decisions = 0;
  for (const SwarmTask& task : mixture_) {
    decisions += agent::DecisionsPerCommand(task.scenario.run, config_.action) * kShardEnvs;
  }
  return config_.horizon * decisions;
}

std::string SwarmTrainer::ConfigText() const {
  nlohmann::ordered_json waters = nlohmann::ordered_json::array();
  for (const SwarmTask& task : mixture_) {
    waters.push_back({{"name", task.name}, {"scenario_hash", ScenarioHash(task.scenario)}});
  }
  SwarmConfig copy(config_);  // a table refers to values that it may change
  config::Table table;
  copy.Describe(&table);
  nlohmann::ordered_json json;
  DumpOptions(table, &json);
  json["set"] = options_.overrides;
  json["scenarios"] = waters;
  return json.dump(2) + "\n";
}

agent::PolicyMetadata SwarmTrainer::Metadata() const {
  agent::PolicyMetadata m;
  m.id = "swarm-" + std::to_string(config_.seed) + "-" + std::to_string(steps_);
  m.scenario_hash = ScenarioHash(validation_.front().scenario);
  m.training_step = steps_;
  m.seed = config_.seed;
  m.metrics["validation_" + std::string(Score())] = Number(last_);
  m.metrics["training_seconds"] = Number(seconds_);
  return m;
}

const char* SwarmTrainer::Score() const {
  return config_.action == agent::EntityAction::kVelocity3 ? "return" : "band_share";
}

void SwarmTrainer::Segment() {
  for (auto& shard : shards_) shard->RestartAt(static_cast<std::uint64_t>(segment_) * 1000);
  for (int c = 0; c < config_.segment && steps_ < config_.steps; ++c) {
    Stopwatch watch;
    const SwarmActor actor = learner_.actor();
    const double imitation = config_.imitation.Weight(steps_);
    pool_.Run(static_cast<int>(shards_.size()), [&](int k, int) {
      const auto i = static_cast<std::size_t>(k);
      shards_[i]->Collect(collection_, actor, &rollouts_[i], imitation > 0.0);
    });
    const double flown = watch.Lap();
    const double progress = static_cast<double>(steps_) / static_cast<double>(config_.steps);
    const SwarmLearner::Report report = learner_.Update(&rollouts_, collection_, progress, &pool_,
                                                        SwarmLearner::Learns::kBoth, imitation);
    const double learnt = watch.Lap();
    seconds_ += flown + learnt;
    steps_ += StepsOfCollection();
    ++collection_;
    if (progress_.empty()) {
      progress_ = "steps,seconds,collect_seconds,update_seconds";
      for (const auto& item : report) progress_ += "," + item.first;
      progress_ += "\n";
    }
    std::string line = std::to_string(steps_) + "," + Number(seconds_) + "," + Number(flown) + "," +
                       Number(learnt);
    for (const auto& item : report) line += "," + Number(item.second);
    progress_ += line + "\n";
    if (options_.log != nullptr) {
      *options_.log << steps_ << " steps " << static_cast<int>(seconds_) << " s";
      for (const auto& item : report)
        *options_.log << "  " << item.first << " " << Number(item.second);
      *options_.log << std::endl;
    }
  }
  ++segment_;
}

void SwarmTrainer::Validate() {
  const agent::EntityPolicy policy = learner_.AveragePolicy(Metadata());
  const env::ActFactory factory = [&policy](const env::VectorEnv&, int) -> env::ActFunction {
    return [&policy](const env::VectorEnv& env, const float*, double* actions) {
      float action[dynamics::kMaxActionSize];
      for (int e = 0; e < env.envs(); ++e) {
        for (int i = 0; i < env.agents(); ++i) {
          agent::Fly(policy, env.agent(e, i), action);
          for (int k = 0; k < env.action_size(); ++k) *actions++ = static_cast<double>(action[k]);
        }
      }
    };
  };
  env::EvaluationOptions o;
  o.episodes = config_.validation_episodes;
  o.seed = config_.validation_seed;
  double sum = 0.0;
  const std::vector<std::string> columns = {
      "band_share", "spread",       "whole_lost_rate", "near_pairs", "estimate_rmse",
      "return",     "time_to_band", "tracking_error",  "own_rmse",   "tail_colliding_pairs"};
  if (table_.empty()) {
    table_ = "steps,seconds,task";
    for (const std::string& c : columns) table_ += "," + c;
    table_ += "\n";
  }
  for (const SwarmTask& task : validation_) {
    const task::MetricSummary s =
        task::Summarise(env::Evaluate(env::EnvFactory(task.scenario), factory, o, &pool_));
    sum += s.Mean(Score()) / static_cast<double>(validation_.size());
    std::string line = std::to_string(steps_) + "," + Number(seconds_) + "," + task.name;
    for (const std::string& c : columns) line += "," + Number(s.Mean(c));
    table_ += line + "\n";
    if (options_.log != nullptr) *options_.log << "validation " << line << std::endl;
  }
  last_ = sum;
  learner_.AveragePolicy(Metadata()).SaveOnnx(options_.out + "/policy_last.onnx");
  if (sum > best_) {
    best_ = sum;
    learner_.AveragePolicy(Metadata()).SaveOnnx(options_.out + "/policy_best.onnx");
  }
}

void SwarmTrainer::SaveAll() {
  Archive archive, own;
  learner_.Save(&own);
  archive.PutPart("learner", own);
  archive.PutInteger("steps", steps_);
  archive.PutInteger("collection", collection_);
  archive.PutInteger("segment", segment_);
  archive.Put("numbers", std::vector<double>{seconds_, best_, last_});
  archive.Put("progress", progress_);
  archive.Put("validation", table_);
  archive.Put("config", ConfigText());
  WriteArchive(archive, options_.out + "/checkpoint.ckpt");
  WriteDurably(progress_, options_.out + "/progress.csv", "the progress");
  WriteDurably(table_, options_.out + "/validation.csv", "the validation");
}

void SwarmTrainer::LoadAll() {
  const std::string path = options_.out + "/checkpoint.ckpt";
  const Archive archive = ReadArchive(path);
  if (archive.Text("config") != ConfigText()) {
    throw UserError(path + ": belongs to a training with other options; see config.json beside it");
  }
  learner_.Load(archive.Part("learner"));
  steps_ = archive.Count("steps");
  collection_ = static_cast<std::uint32_t>(archive.Count("collection"));
  segment_ = static_cast<std::uint32_t>(archive.Count("segment"));
  const std::vector<double>& numbers = archive.Doubles("numbers", 3);
  seconds_ = numbers[0];
  best_ = numbers[1];
  last_ = numbers[2];
  progress_ = archive.Text("progress");
  table_ = archive.Text("validation");
}

bool SwarmTrainer::Run() {
  while (steps_ < config_.steps) {
    Segment();
    if (segment_ % static_cast<std::uint32_t>(config_.validation_interval) == 0 ||
        steps_ >= config_.steps) {
      Validate();
    }
    SaveAll();
    if (options_.stop != nullptr && *options_.stop != 0 && steps_ < config_.steps) return false;
  }
  return true;
}

}  // namespace stg::learn
