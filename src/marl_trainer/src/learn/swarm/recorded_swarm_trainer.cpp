#include "marl_trainer/learn/swarm/recorded_swarm_trainer.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>

#include "auv_common/config/loader.hpp"
#include "auv_common/config/value.hpp"
#include "auv_common/error.hpp"
#include "marl_trainer/learn/nn/blas.hpp"
#include "marl_trainer/learn/options.hpp"
#include "marl_trainer/learn/run/train_log.hpp"
#include "marl_trainer/learn/stopwatch.hpp"
#include "stg_agent/entities/entity_pilot.hpp"

namespace stg::learn {
namespace {

Scenario WithTrainingReward(Scenario scenario) {
  config::Override(&scenario, SwarmRewardKeys());
  return scenario;
}

std::string TextOf(const SwarmConfig& config) {
  SwarmConfig copy(config);  // a table refers to values that it may change
  config::Table table;
  copy.Describe(&table);
  nlohmann::ordered_json json;
  DumpOptions(table, &json);
  return json.dump();
}

/// Identifies the numbers of a policy and its exploration.
std::string NumbersHash(const agent::EntityPolicy& policy) {
  const agent::EntityPolicy::Parameters& p = policy.parameters();
  std::string bytes;
  for (const std::vector<float>* numbers : {&p.numbers, &p.log_std}) {
    const std::size_t begin = bytes.size();
    bytes.resize(begin + numbers->size() * sizeof(float));
    std::memcpy(bytes.data() + begin, numbers->data(), numbers->size() * sizeof(float));
  }
  if (p.noise_time_s > 0.0) bytes += config::FormatNumber(p.noise_time_s);
  return config::HashOf(bytes).substr(0, 8);
}

/// The numbers of an update for the progress line.
std::string LineOf(const SwarmLearner::Report& report) {
  std::vector<ReportColumn> columns;
  std::vector<double> values;
  for (const auto& [name, value] : report) {
    const bool shown =
        name == "reward" || name == "kl" || name == "explained_variance" || name == "sigma";
    columns.push_back({name, shown ? (name == "explained_variance" ? "explained" : name) : "", 3});
    values.push_back(value);
  }
  return ReportText(columns, values);
}

}  // namespace

bool HoldsSwarmCheckpoint(const std::string& folder) {
  std::error_code error;
  return std::filesystem::exists(folder + "/checkpoint.ckpt", error);
}

SwarmStart ReadSwarmStart(const std::string& path, SwarmConfig* config) {
  SwarmStart start;
  start.path = path;
  if (path.empty()) return start;
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    if (!HoldsSwarmCheckpoint(path)) {
      throw UserError(path + ": holds no checkpoint of train_swarm (checkpoint.ckpt)");
    }
    const std::string file = path + "/checkpoint.ckpt";
    const Archive archive = ReadArchive(file);
    const auto json = nlohmann::ordered_json::parse(archive.Text("config"), nullptr, false);
    if (!json.is_object() || !json.contains("network") || !json["network"].is_string() ||
        !json.contains("action") || !json["action"].is_string()) {
      throw UserError(file + ": not a checkpoint of train_swarm");
    }
    config->network = agent::EntityNetworkNamed(json["network"].get<std::string>());
    config->action = agent::EntityActionNamed(json["action"].get<std::string>());
    start.learner = archive.Part("learner");
    return start;
  }
  if (std::filesystem::exists(path, error) && !agent::EntityPolicy::IsOne(path)) {
    throw UserError(path + ": has another observation layout, but a network over entities needs '" +
                    agent::kEntityLayout + "'");
  }
  start.policy = std::make_shared<const agent::EntityPolicy>(agent::EntityPolicy::LoadOnnx(path));
  config->network = start.policy->parameters().network;
  config->action = start.policy->action();
  return start;
}

SwarmConfig RecordedSwarmConfig() {
  SwarmConfig config;
  config.minibatch = 1500;
  config.epochs = 4;
  config.last_learning_rate = config.learning_rate;
  return config;
}

RecordedSwarmTrainer::RecordedSwarmTrainer(const Scenario& scenario, const SwarmConfig& config,
                                           const SwarmStart& start, const Options& options)
    : scenario_(WithTrainingReward(scenario)),
      config_(config),
      options_(options),
      pool_(options.workers),
      learner_(config),
      folder_(options.out, options.log) {
  config_.ValidateOrThrow();
  RequireRecordable(scenario_.judge());
  agent::RequireFits(config_.action, scenario_.model());
  folder_.Lock();
  UseOneBlasThread();
  state_.config = TextOf(config_);
  state_.scenario = ToYaml(scenario_);
  if (const auto loaded = folder_.Newest()) {
    Restore(*loaded, start);
  } else {
    if (start.policy) learner_.StartFrom(*start.policy);
    if (start.learner) {
      try {
        learner_.Load(*start.learner);
      } catch (const UserError& error) {
        throw UserError(start.path + ": does not fit: " + error.what());
      }
      learner_.RequireBlind(start.path);
    }
    if (options.log_std) learner_.SetDeviation(*options.log_std);
  }
  WritePolicies();
}

void RecordedSwarmTrainer::Restore(const TrainState& state, const SwarmStart& start) {
  if (!start.path.empty()) {
    throw UserError(options_.out +
                    ": holds a training already; to continue it, give no start policy");
  }
  GoOnFrom(
      state, options_.out, [this](const Archive& a) { learner_.Load(a); }, &state_);
}

Finding RecordedSwarmTrainer::Check(const SwarmEpisode& episode) const {
  return CheckSwarmEpisode(scenario_.run, episode, *policy_);
}

RecordedTrainer::Progress RecordedSwarmTrainer::Update(const std::vector<SwarmEpisode>& episodes) {
  assert(!episodes.empty());
  const Stopwatch watch;
  const task::JudgeConfig judge = scenario_.judge();
  std::vector<SwarmRollout> rollouts(episodes.size());
  pool_.Run(static_cast<int>(episodes.size()), [&](int e, int) {
    const auto i = static_cast<std::size_t>(e);
    rollouts[i] = RolloutOf(config_, judge, episodes[i]);
  });
  const bool acts = state_.collections >= options_.critic_updates;
  const SwarmLearner::Report report =
      learner_.Update(&rollouts, static_cast<std::uint32_t>(state_.collections), 0.0, &pool_,
                      acts ? SwarmLearner::Learns::kBoth : SwarmLearner::Learns::kCritic);
  ++state_.collections;
  state_.env_steps += static_cast<std::int64_t>(episodes.size()) * scenario_.run.time.episode_steps;
  WritePolicies();

  RecordedTrainer::Progress p;
  p.seconds = watch.seconds();
  state_.wall_seconds += p.seconds;
  TrainState saved = state_;
  learner_.Save(&saved.algorithm);
  folder_.Save(saved, options_.keep_checkpoints);
  p.updates = state_.collections;
  p.env_steps = state_.env_steps;
  p.episodes = static_cast<int>(episodes.size());
  const int period = agent::DecisionsPerCommand(scenario_.run);
  for (const SwarmRollout& r : rollouts) {
    const double sum = std::accumulate(r.own.begin(), r.own.end(), 0.0);
    p.episode_return += sum * period / static_cast<double>(rollouts.size());
  }
  p.own_reward = true;
  p.report = LineOf(report);
  return p;
}

void RecordedSwarmTrainer::WritePolicies() {
  agent::PolicyMetadata m;
  m.scenario_hash = ScenarioHash(scenario_);
  m.training_step = state_.env_steps;
  m.seed = config_.seed;
  const std::string id = scenario_.run.name + "-recorded-" + std::to_string(state_.env_steps);
  m.id = id + "-" + NumbersHash(learner_.Policy(m));
  policy_ = std::make_shared<const agent::EntityPolicy>(learner_.Policy(m));
  policy_->SaveOnnx(policy_path());
  m.id = id + "-average-" + NumbersHash(learner_.AveragePolicy(m));
  learner_.AveragePolicy(m).SaveOnnx(average_path());
}

}  // namespace stg::learn
