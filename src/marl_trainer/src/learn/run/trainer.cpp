#include "marl_trainer/learn/run/trainer.hpp"

#include <algorithm>
#include <cstdio>
#include <functional>

#include "auv_common/error.hpp"
#include "marl_trainer/learn/nn/blas.hpp"
#include "marl_trainer/learn/run/validation.hpp"

namespace stg::learn {
namespace {

Scenario Valid(const Scenario& scenario, const TrainSetup& setup) {
  setup.ValidateOrThrow();
  scenario.ValidateOrThrow();
  return scenario;
}

/// The scenarios of the training. All have the observation and the episode length of the first one.
std::vector<Scenario> Mix(const Scenario& scenario, const std::vector<Scenario>& mix,
                          const TrainSetup& setup) {
  const Scenario base = env::VariantScenario(scenario, setup.common.variant);
  std::vector<Scenario> all;
  for (const Scenario& s : mix) {
    all.push_back(env::VariantScenario(Valid(s, setup), setup.common.variant));
  }
  if (static_cast<int>(all.size()) > env::MostOfMix(setup.common.envs)) {
    throw UserError(std::to_string(all.size()) + " conditions need at least " +
                    std::to_string((static_cast<int>(all.size()) - 1) * env::kMixBlock + 1) +
                    " environments (--envs), because " + std::to_string(env::kMixBlock) +
                    " have the same one");
  }
  if (all.empty()) all.push_back(base);
  for (const Scenario& s : all) {
    if (s.run.agents != base.run.agents || s.world.target.count != base.world.target.count ||
        s.run.time.episode_steps != base.run.time.episode_steps ||
        s.world.control.interface != base.world.control.interface ||
        agent::ObservationLayout(s.agent.observation) !=
            agent::ObservationLayout(base.agent.observation)) {
      throw UserError(
          "all scenarios of a training must have the same number of AUVs, episode length and "
          "observation");
    }
  }
  return all;
}

/// Starts an algorithm with the networks of the run in `folder`.
void StartFrom(const std::string& folder, const std::string& algorithm, std::ostream* log,
               Algorithm* learner) {
  const std::optional<TrainState> theirs = LoadNewestCheckpoint(folder, log);
  if (!theirs) throw UserError("--start-from: no checkpoint in " + folder);
  const auto config = nlohmann::json::parse(theirs->config, nullptr, false);
  if (!config.is_object() || !config.contains("algorithm") || config["algorithm"] != algorithm) {
    throw UserError("--start-from: " + folder + " was not trained with " + algorithm);
  }
  try {
    learner->StartFrom(theirs->algorithm);
  } catch (const UserError& error) {
    throw UserError("--start-from: " + folder + ": " + error.what());
  }
}

/// The algorithm at the start of a training. Throws UserError if it cannot start.
std::unique_ptr<Algorithm> AtStart(const TrainSetup& setup, const Problem& problem,
                                   const Trainer::Options& options, const Team& team) {
  const int size = team.ranks->size(), most = setup.own->MostRanks();
  if ((size & (size - 1)) != 0) {
    throw UserError("started with " + std::to_string(size) +
                    " ranks: their number must be a power of two");
  }
  if (size > most) {
    throw UserError("--algorithm " + setup.algorithm + ": trains with at most " +
                    std::to_string(most) + " ranks");
  }
  std::unique_ptr<Algorithm> learner = setup.own->Make(setup.common, problem, team);
  const std::string& folder = setup.common.start_from;
  if (!options.resume && !folder.empty()) {
    StartFrom(folder, setup.algorithm, options.log, learner.get());
  }
  return learner;
}

/// The first multiple of `interval` that is larger than `steps`.
std::int64_t NextMultiple(std::int64_t steps, std::int64_t interval) {
  return (steps / interval + 1) * interval;
}

double PeakFlops(WorkerPool* pool) {
  std::vector<double> rates(static_cast<std::size_t>(pool->workers()));
  pool->Run(pool->workers(),
            [&](int w, int) { rates[static_cast<std::size_t>(w)] = MeasurePeakFlops(); });
  double peak = 0.0;
  for (const double rate : rates) peak += rate;
  return peak;
}

}  // namespace

Trainer::Trainer(const Scenario& scenario, const TrainSetup& setup, const Options& options)
    : scenario_(Valid(scenario, setup)),
      train_scenario_(env::VariantScenario(scenario, setup.common.variant)),
      evaluation_scenario_(env::EvaluationScenario(scenario, setup.common.variant)),
      mix_(Mix(scenario, options.mix, setup)),
      setup_(setup),
      options_(options),
      problem_(ProblemOf(train_scenario_.run, train_scenario_.world, train_scenario_.agent)),
      pool_(options.workers),
      team_(&pool_, options.ranks),
      algorithm_(AtStart(setup_, problem_, options_, team_)),
      collector_(env::EnvFactory(mix_), setup_.common, setup_.own->Imitation(), team_),
      folder_(options.out, options.log) {
  if (leads()) folder_.Lock();
  UseOneBlasThread();
  state_.config = ToJson(setup_).dump();
  for (const Scenario& s : mix_) state_.scenario += ToYaml(s);
  RequireEqualRanks();
  if (options_.resume) {
    Resume();
  } else if (folder_.HoldsRun()) {
    throw UserError(options_.out + ": holds another run; use --resume or another folder");
  }
  ScheduleNext();
  // Waits until all ranks have read the folder, before rank 0 writes.
  team_.ranks->GatherBytes({});
  if (!leads()) return;
  std::vector<std::string> mix;
  for (const Scenario& s : options.mix) mix.push_back(ToYaml(s));
  folder_.WriteSetup(ToJson(setup_), ToYaml(scenario_), mix);
  log_ = std::make_unique<TrainLog>(options_.out, algorithm_->Columns(),
                                    options_.resume ? state_.env_steps : -1, setup_.common.steps,
                                    options_.log);
  if (!state_.log.empty()) log_->Load(state_.log);
}

void Trainer::RequireEqualRanks() const {
  const std::uint64_t mine = std::hash<std::string>()(state_.config + state_.scenario);
  for (const std::uint64_t theirs : team_.ranks->Gather(std::vector<std::uint64_t>{mine})) {
    if (theirs != mine) {
      throw UserError(
          "the ranks have different options or scenarios; start all with the same ones");
    }
  }
}

void Trainer::Resume() {
  const std::optional<TrainState> loaded = folder_.Newest();
  if (!loaded) throw UserError(options_.out + ": no checkpoint to resume from");
  const std::string where = options_.out + ": cannot resume";
  RequireSameRun(*loaded, ToJson(setup_), state_.scenario, where);
  for (const std::int64_t steps :
       team_.ranks->Gather(std::vector<std::int64_t>{loaded->env_steps})) {
    if (steps != loaded->env_steps) {
      throw UserError(where +
                      ": the ranks see different checkpoints; all ranks must use the same folder");
    }
  }
  const std::string config = state_.config;
  state_ = *loaded;
  state_.config = config;
  state_.algorithm = Archive();
  state_.episodes = Archive();
  collector_.RestartAt(state_.round);
  try {
    collector_.Load(loaded->episodes);
    algorithm_->Load(loaded->algorithm);
  } catch (const UserError& error) {
    throw UserError(where + ": " + error.what());
  }
}

void Trainer::ScheduleNext() {
  next_validation_ = NextMultiple(state_.env_steps, setup_.common.validation_interval);
  next_checkpoint_ = NextMultiple(state_.env_steps, setup_.common.checkpoint_interval);
}

TrainState Trainer::state() const {
  TrainState state = state_;
  state.wall_seconds = Elapsed();
  if (leads()) state.log = log_->Save();
  algorithm_->Save(&state.algorithm);
  collector_.Save(&state.episodes);
  return state;
}

bool Trainer::Run() {
  bool finished = state_.env_steps >= setup_.common.steps;
  bool stopped = false;
  while (!finished && !stopped) {
    TrainRecord record;
    Iterate(&record);
    finished = state_.env_steps >= setup_.common.steps;
    if (finished || state_.env_steps >= next_validation_) RunValidation(&record);
    record.wall_seconds = Elapsed();
    if (leads()) log_->Add(record);
    AlignEpisodes(finished);
    stopped = Stopped();
    if (stopped || finished || state_.env_steps >= next_checkpoint_) Save();
  }
  if (leads() && options_.log != nullptr && state_.best_return <= TrainState().best_return) {
    *options_.log << "there is no policy_best yet, because the first validation is at "
                  << next_validation_ << " steps; policy_last is the newest policy" << std::endl;
  }
  if (leads()) {
    log_->Conclude();
    log_->WriteSummary(algorithm_->Sizes(), pool_.workers(), PeakFlops(&pool_),
                       finished ? "finished" : "signal", *team_.ranks);
  }
  return finished;
}

bool Trainer::Stopped() const {
  const bool asked = options_.stop != nullptr && *options_.stop != 0;
  if (options_.halt_after > 0 && state_.env_steps >= options_.halt_after) return true;
  // A stop of one rank stops all.
  const std::vector<char> all = team_.ranks->GatherBytes({asked ? '1' : '0'});
  return std::count(all.begin(), all.end(), '1') > 0;
}

void Trainer::Iterate(TrainRecord* record) {
  const TrainConfig& config = setup_.common;
  UpdateContext context;
  const ImitationConfig* imitation = setup_.own->Imitation();
  if (imitation != nullptr) context.imitation = imitation->Weight(state_.env_steps);
  context.progress = static_cast<double>(state_.env_steps) / static_cast<double>(config.steps);
  const CollectionReport collected = collector_.Collect(
      static_cast<std::uint32_t>(state_.collections), context.imitation > 0.0, algorithm_.get());
  const Stopwatch watch;
  UpdateReport report;
  try {
    report = algorithm_->Update(context);
  } catch (const UserError& error) {
    throw UserError(options_.out + ": after " + std::to_string(state_.env_steps) +
                    " steps: " + error.what());
  }
  record->update_seconds = watch.seconds();
  ++state_.collections;
  state_.env_steps += static_cast<std::int64_t>(config.envs) * config.horizon;

  record->env_steps = state_.env_steps;
  record->collections = state_.collections;
  record->env_seconds = collected.env_seconds;
  record->inference_seconds = collected.inference_seconds;
  record->reward = collected.reward;
  record->update_flops = report.flops;
  record->algorithm = std::move(report.values);
  record->episodes = static_cast<int>(collected.finished.size());
  if (!collected.finished.empty()) {
    const task::MetricSummary summary = task::Summarise(collected.finished);
    record->train_return = summary.Mean("return");
    record->train_tail_distance = summary.Mean("tail_distance");
    record->train_lost_rate = summary.Mean("lost_rate");
  }
}

void Trainer::RunValidation(TrainRecord* record) {
  const Stopwatch watch;
  const auto fly = [this](const Scenario& scenario) {
    return task::Summarise(Validate(env::EnvFactory(scenario), setup_.common.validation_episodes,
                                    algorithm_.get(), team_));
  };
  last_validation_ = fly(train_scenario_);
  // The flights are the same, because a reward has no effect on them.
  const task::MetricSummary judged =
      setup_.common.variant == env::Variant::kStg ? last_validation_ : fly(evaluation_scenario_);
  last_validation_.Append("scenario_return", judged.Mean("return"), judged.Std("return"));
  record->validated = true;
  record->validation = last_validation_;
  if (last_validation_.Mean("return") > state_.best_return) {
    state_.best_return = last_validation_.Mean("return");
    SavePolicy("policy_best");
  }
  next_validation_ = NextMultiple(state_.env_steps, setup_.common.validation_interval);
  record->validation_seconds = watch.seconds();
}

void Trainer::AlignEpisodes(bool force) {
  const TrainConfig& config = setup_.common;
  const int whole = scenario_.run.time.episode_steps / config.horizon;
  // Cutting staggered episodes at every boundary would undo the staggering. Other episodes must
  // reach their end before they are cut, even if the horizon does not divide them.
  const int every = config.stagger
                        ? 2 * std::max(1, whole)
                        : (scenario_.run.time.episode_steps + config.horizon - 1) / config.horizon;
  if (state_.collections % every != 0 && !force) return;
  state_.round = collector_.round();
  if (config.stagger || !collector_.at_episode_start()) {
    ++state_.round;
    collector_.RestartAt(state_.round);
  } else {
    collector_.ForgetPast();
  }
}

void Trainer::Save() {
  const TrainState now = state();
  if (leads()) {
    log_->Flush();  // so that a resumed run finds the rows up to the checkpoint
    folder_.Save(now, setup_.common.keep_checkpoints);
  }
  SavePolicy("policy_last");
  next_checkpoint_ = NextMultiple(state_.env_steps, setup_.common.checkpoint_interval);
}

void Trainer::SavePolicy(const std::string& name) const {
  if (!leads()) return;
  const TrainConfig& config = setup_.common;
  const std::string id = scenario_.run.name + "-" + env::NameOf(config.variant) + "-" +
                         config.preset + "-seed" + std::to_string(config.seed) + "-" +
                         std::to_string(state_.env_steps);
  agent::PolicyMetadata m =
      MetadataOf(train_scenario_.agent.observation, train_scenario_.world.control,
                 ScenarioHash(train_scenario_), id, state_.env_steps, config.seed);
  for (const char* metric : {"return", "scenario_return", "tail_distance", "tracking_error",
                             "lost_rate", "tail_colliding_pairs"}) {
    if (last_validation_.names.empty()) break;
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", last_validation_.Mean(metric));
    m.metrics[std::string("validation_") + metric] = text;
  }
  folder_.SavePolicies(algorithm_->Policies(m), name);
}

}  // namespace stg::learn
