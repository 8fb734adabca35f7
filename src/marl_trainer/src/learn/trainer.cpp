#include "marl_trainer/learn/trainer.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "auv_common/config/files.hpp"
#include "auv_common/error.hpp"
#include "marl_trainer/learn/nn/blas.hpp"
#include "marl_trainer/scenario/scenario.hpp"

namespace stg::learn {
namespace {

namespace fs = std::filesystem;

double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Scenario Valid(const Scenario& scenario, const TrainConfig& config) {
  config.ValidateOrThrow();
  scenario.ValidateOrThrow();
  return scenario;
}

/// A run that was ended before its first checkpoint leaves nothing worth keeping.
bool HoldsRun(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".pt" || extension == ".onnx") return true;
  }
  return false;
}

/// The scenarios to train in, all with the observation and episode of the first.
std::vector<Scenario> Mix(const Scenario& scenario, const std::vector<Scenario>& mix,
                          const TrainConfig& config) {
  std::vector<Scenario> all;
  for (const Scenario& s : mix) all.push_back(VariantScenario(Valid(s, config), config.variant));
  if (all.empty()) all.push_back(VariantScenario(scenario, config.variant));
  const Scenario base = VariantScenario(scenario, config.variant);
  for (const Scenario& s : all) {
    if (s.agents != base.agents || s.target.count != base.target.count ||
        s.time.episode_steps != base.time.episode_steps ||
        s.control.interface != base.control.interface ||
        agent::ObservationLayout(s) != agent::ObservationLayout(base)) {
      throw UserError("the scenarios to train in differ in swarm, episode or observation");
    }
  }
  return all;
}

}  // namespace

Trainer::Trainer(const Scenario& scenario, const TrainConfig& config, const Options& options)
    : scenario_(Valid(scenario, config)),
      train_scenario_(VariantScenario(scenario, config.variant)),
      validation_scenario_(ValidationScenario(scenario, config.variant)),
      mix_(Mix(scenario, options.mix, config)),
      config_(config),
      options_(options),
      pool_(options.workers),
      learner_(train_scenario_, config, &pool_),
      validation_(validation_scenario_, networks(), config.validation_episodes, &pool_) {
  UseOneBlasThread();
  start_ = Now();
  for (int first = 0; first < config.envs; first += RolloutUnit::kEnvs) {
    units_.push_back(std::make_unique<RolloutUnit>(
        mix_, networks(), config_, first, std::min(RolloutUnit::kEnvs, config.envs - first)));
  }
  learner_.Initialise(&state_);
  if (!config_.start_from.empty() && !options_.resume) StartFrom(config_.start_from);
  state_.config = ToJson(config_).dump();
  for (const Scenario& s : mix_) state_.scenario += ToYaml(s);
  OpenFolder();
}

Trainer::~Trainer() = default;

double Trainer::Elapsed() const { return state_.wall_seconds + (Now() - start_); }

void Trainer::OpenFolder() {
  std::error_code error;
  fs::create_directories(options_.out, error);
  if (!fs::is_directory(options_.out)) throw UserError(options_.out + ": cannot create the folder");
  if (options_.resume) {
    Restore();
  } else if (HoldsRun(options_.out)) {
    throw UserError(options_.out + ": holds another run; use --resume or another folder");
  }
  std::ofstream(fs::path(options_.out) / "config.json") << ToJson(config_).dump(2) << "\n";
  std::ofstream(fs::path(options_.out) / "scenario.yaml") << ToYaml(scenario_);
  log_ = std::make_unique<TrainLog>(options_.out, options_.resume ? state_.env_steps : -1,
                                    config_.steps, options_.log);
  if (options_.resume && !state_.log.empty()) log_->Load(state_.log);
}

void Trainer::StartFrom(const std::string& folder) {
  const std::optional<TrainState> theirs = LoadNewestCheckpoint(folder, options_.log);
  if (!theirs) throw UserError("--start-from: no checkpoint in " + folder);
  const std::size_t first = networks().log_std_offset();
  const std::vector<float> untrained = state_.parameters;
  if (!learner_.Restore(*theirs)) {
    throw UserError("--start-from: the networks in " + folder + " have other sizes");
  }
  state_.parameters = theirs->parameters;
  std::copy_n(untrained.begin() + static_cast<std::ptrdiff_t>(first), networks().action_size(),
              state_.parameters.begin() + static_cast<std::ptrdiff_t>(first));
  if (config_.wall_units > 0.0) {
    networks().PlaceWallUnits(config_.wall_units, train_scenario_.workspace.half_extent_m,
                              learner_.scales().observations, state_.parameters.data());
  }
}

void Trainer::Restore() {
  const std::optional<TrainState> loaded = LoadNewestCheckpoint(options_.out, options_.log);
  if (!loaded) throw UserError(options_.out + ": no checkpoint to resume from");
  auto theirs = nlohmann::ordered_json::parse(loaded->config, nullptr, false);
  auto ours = ToJson(config_);
  for (const auto& [key, value] : ours.items()) {
    // More steps than planned are welcome; nothing else may change on the way.
    if (key != "steps" && (!theirs.is_object() || !theirs.contains(key) || theirs[key] != value)) {
      throw UserError(options_.out + ": cannot resume: --" + key + " is " + value.dump() +
                      ", the checkpoint was made with " +
                      (theirs.contains(key) ? theirs[key].dump() : "no such option"));
    }
  }
  if (loaded->scenario != state_.scenario) {
    throw UserError(options_.out + ": cannot resume: the scenario is not the checkpoint's");
  }
  if (!learner_.Restore(*loaded)) {
    throw UserError(options_.out + ": cannot resume: the checkpoint has other network sizes");
  }
  state_ = *loaded;
  state_.config = ours.dump();
  for (auto& unit : units_) unit->RestartAt(state_.round);
  next_validation_ =
      (state_.env_steps / config_.validation_interval + 1) * config_.validation_interval;
  next_checkpoint_ =
      (state_.env_steps / config_.checkpoint_interval + 1) * config_.checkpoint_interval;
}

bool Trainer::Run() {
  if (next_validation_ == 0) next_validation_ = config_.validation_interval;
  if (next_checkpoint_ == 0) next_checkpoint_ = config_.checkpoint_interval;
  bool finished = state_.env_steps >= config_.steps;
  bool stopped = false;
  while (!finished && !stopped) {
    TrainRecord record;
    Iterate(&record);
    finished = state_.env_steps >= config_.steps;
    if (finished || state_.env_steps >= next_validation_) Validate(&record);
    record.wall_seconds = Elapsed();
    log_->Add(record);
    if (!AtBoundary(finished)) continue;
    stopped = (options_.stop != nullptr && *options_.stop != 0) ||
              (options_.halt_after > 0 && state_.env_steps >= options_.halt_after);
    if (stopped || finished || state_.env_steps >= next_checkpoint_) Save();
  }
  double peak = 0.0;
  std::vector<double> rates(static_cast<std::size_t>(pool_.workers()));
  pool_.Run(pool_.workers(),
            [&](int w, int) { rates[static_cast<std::size_t>(w)] = MeasurePeakFlops(); });
  for (const double rate : rates) peak += rate;
  log_->WriteSummary(pool_.workers(), peak, finished ? "finished" : "signal");
  return finished;
}

void Trainer::Iterate(TrainRecord* record) {
  const double begin = Now();
  const auto collection = static_cast<std::uint32_t>(state_.collections);
  // In full for the first half of the imitation steps, then ever less.
  const double left =
      1.0 - static_cast<double>(state_.env_steps) /
                static_cast<double>(std::max<std::int64_t>(1, config_.imitation_steps));
  const double imitation = config_.imitate.empty()
                               ? 0.0
                               : config_.imitation_share * std::min(std::max(2.0 * left, 0.0), 1.0);
  pool_.Run(static_cast<int>(units_.size()), [&](int u, int) {
    units_[static_cast<std::size_t>(u)]->Collect(state_.parameters.data(), learner_.scales(),
                                                 collection, imitation > 0.0);
  });
  const double collected = Now();
  const double progress =
      static_cast<double>(state_.env_steps) / static_cast<double>(config_.steps);
  const double scale = 1.0 - (1.0 - config_.lr_final) * std::min(progress, 1.0);
  std::vector<const RolloutBuffer*> rollouts;
  for (const auto& unit : units_) rollouts.push_back(&unit->buffer());
  const Learner::Report learned = learner_.Update(rollouts, collection, scale, &state_, imitation);
  const UpdateReport& report = learned.update;
  for (const auto& unit : units_) {
    learner_.AddMoments(unit->observation_moments(), unit->state_moments());
  }
  learner_.UpdateInputScales();
  const double updated = Now();
  ++state_.collections;
  state_.env_steps += static_cast<std::int64_t>(config_.envs) * config_.horizon;

  double env = 0.0, inference = 0.0;
  std::vector<task::EpisodeMetrics> episodes;
  for (const auto& unit : units_) {
    env += unit->env_seconds();
    inference += unit->inference_seconds();
    episodes.insert(episodes.end(), unit->finished().begin(), unit->finished().end());
  }
  record->env_steps = state_.env_steps;
  record->collections = state_.collections;
  record->learning_rate = config_.lr * scale;
  record->env_seconds = (collected - begin) * env / (env + inference);
  record->inference_seconds = (collected - begin) * inference / (env + inference);
  record->update_seconds = updated - collected;
  record->update_flops = report.flops;
  record->reward = learned.reward;
  record->explained_variance = learned.explained_variance;
  record->kl = report.sums.kl / report.sums.rows;
  record->clip_fraction = report.sums.clipped / report.sums.rows;
  record->actor_loss = report.sums.actor_loss / report.sums.rows;
  record->value_loss = report.sums.value_loss / report.sums.samples;
  record->actor_norm = report.actor_norm;
  record->critic_norm = report.critic_norm;
  for (int a = 0; a < networks().action_size(); ++a) {
    const double log_std = static_cast<double>(
        state_.parameters[networks().log_std_offset() + static_cast<std::size_t>(a)]);
    record->sigma += std::exp(log_std) / networks().action_size();
    record->entropy += log_std + 1.4189385332046727;  // (1 + log 2 pi) / 2
  }
  record->episodes = static_cast<int>(episodes.size());
  if (!episodes.empty()) {
    const task::MetricSummary summary = task::Summarise(episodes);
    record->train_return = summary.Mean("return");
    record->train_tail_distance = summary.Mean("tail_distance");
    record->train_lost_rate = summary.Mean("lost_rate");
  }
}

void Trainer::Validate(TrainRecord* record) {
  const double begin = Now();
  last_validation_ =
      task::Summarise(validation_.Run(state_.parameters.data(), learner_.scales().observations));
  record->validated = true;
  record->validation = last_validation_;
  if (last_validation_.Mean("return") > state_.best_return) {
    state_.best_return = last_validation_.Mean("return");
    SavePolicy("policy_best.onnx");
  }
  next_validation_ =
      (state_.env_steps / config_.validation_interval + 1) * config_.validation_interval;
  record->validation_seconds = Now() - begin;
}

bool Trainer::AtBoundary(bool force) {
  const int episode = std::max(1, scenario_.time.episode_steps / config_.horizon);
  // Cutting staggered episodes at every boundary would undo the staggering.
  const int every = config_.stagger ? 2 * episode : episode;
  if (state_.collections % every != 0 && !force) return false;
  bool at_start = true;
  for (const auto& unit : units_) at_start = at_start && unit->at_episode_start();
  std::uint64_t round = 0;
  for (const auto& unit : units_) round = std::max(round, unit->round());
  if (!at_start || config_.stagger) {
    ++round;
    for (auto& unit : units_) unit->RestartAt(round);
  }
  state_.round = round;
  return true;
}

void Trainer::Save() {
  TrainState saved = state_;
  learner_.Save(&saved);
  saved.wall_seconds = Elapsed();
  saved.log = log_->Save();
  SaveCheckpoint(saved, CheckpointPath(options_.out, state_.env_steps));
  PruneCheckpoints(options_.out, config_.keep_checkpoints);
  SavePolicy("policy_last.onnx");
  next_checkpoint_ =
      (state_.env_steps / config_.checkpoint_interval + 1) * config_.checkpoint_interval;
}

agent::Policy Trainer::MakePolicy() const {
  agent::PolicyMetadata m;
  m.id = scenario_.name + "-" + config_.variant + "-" + config_.preset + "-seed" +
         std::to_string(config_.seed) + "-" + std::to_string(state_.env_steps);
  m.observation_layout = agent::ObservationLayout(train_scenario_);
  m.action_interface = agent::ActionInterfaceName(train_scenario_.control.interface);
  m.scenario_hash = ScenarioHash(train_scenario_);
  m.training_step = state_.env_steps;
  m.seed = config_.seed;
  for (const char* name :
       {"return", "tail_distance", "tracking_error", "lost_rate", "tail_colliding_pairs"}) {
    if (last_validation_.names.empty()) break;
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", last_validation_.Mean(name));
    m.metrics[std::string("validation_") + name] = text;
  }
  return networks().ToPolicy(state_.parameters.data(), learner_.scales().observations,
                             std::move(m));
}

void Trainer::SavePolicy(const std::string& name) const {
  MakePolicy().SaveOnnx((fs::path(options_.out) / name).string());
}

}  // namespace stg::learn
