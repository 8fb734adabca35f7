#include "marl_trainer/learn/collect/collector.hpp"

#include <algorithm>
#include <optional>

#include "auv_common/error.hpp"
#include "marl_trainer/learn/stopwatch.hpp"
#include "stg_env/env/decide.hpp"
#include "stg_env/task/critic_state.hpp"

namespace stg::learn {

Problem ProblemOf(const RunConfig& run, const dynamics::WorldConfig& world,
                  const agent::AgentConfig& agent) {
  Problem problem;
  problem.agents = run.agents;
  problem.observation_size = agent.observation_size();
  problem.state_size = task::CriticStateSize(run, world);
  problem.action_size = world.control.action_size();
  problem.action_scale = world.control.action_scale;
  problem.workspace_half_extent_m = world.workspace.half_extent_m;
  return problem;
}

namespace {

std::string PastName(int first_env) { return "actions_" + std::to_string(first_env); }

}  // namespace

/// The environments of one shard, and the memory for one step.
class Collector::Unit {
 public:
  Unit(const env::EnvFactory& make_env, const TrainConfig& config, const ImitationConfig* imitation,
       const Shard& shard)
      : seed_(TrainingSeed(config.seed)),
        shard_(shard),
        env_(make_env.Make(EnvOptions(config, shard))),
        now_(env_.MakeMemory()),
        next_(env_.MakeMemory()) {
    const auto rows = static_cast<std::size_t>(shard.envs * env_.agents());
    actions_.resize(rows * static_cast<std::size_t>(env_.action_size()));
    log_prob_.resize(rows);
    if (imitation != nullptr && !imitation->controller.empty()) {
      teacher_ = agent::MakeDecider(imitation->controller, make_env.model());
      if (imitation->privileged) env::ReadTruth(&*teacher_, make_env.mode());
      teacher_actions_.resize(actions_.size());
      taught_.resize(actions_.size());
    }
    RestartAt(0);
  }

  /// @param index number of this shard. @param worker the worker that runs it.
  void Collect(std::uint32_t number, int steps, bool teach, int index, int worker,
               Algorithm* algorithm);

  void RestartAt(std::uint64_t k) {
    env_.RestartAt(k, now_.arrays());
    past_.clear();
  }
  void ForgetPast() { past_.clear(); }
  /// Actions since the last start, step by step.
  const std::vector<float>& past() const { return past_; }
  /// Repeats these actions.
  void Repeat(const std::vector<float>& actions);
  const env::VectorEnv& env() const { return env_; }
  const Shard& shard() const { return shard_; }
  std::size_t decision_size() const { return actions_.size(); }
  const CollectionReport& report() const { return report_; }

 private:
  static env::VectorEnvOptions EnvOptions(const TrainConfig& config, const Shard& shard) {
    env::VectorEnvOptions options;
    options.seed = TrainingSeed(config.seed);
    options.envs = shard.envs;
    options.first_env = shard.first_env;
    options.total_envs = config.envs;
    options.curriculum = true;  // only if the scenario has a curriculum
    options.stagger = config.stagger;
    return options;
  }
  void AskTeacher();

  const std::uint64_t seed_;
  const Shard shard_;
  env::VectorEnv env_;
  env::EnvMemory now_, next_;
  std::vector<float> actions_, log_prob_, taught_, past_;
  std::optional<agent::Decider> teacher_;
  std::vector<double> teacher_actions_;
  CollectionReport report_;  // its reward is a sum
};

void Collector::Unit::Collect(std::uint32_t number, int steps, bool teach, int index, int worker,
                              Algorithm* algorithm) {
  report_ = CollectionReport();
  Stopwatch watch;
  for (int t = 0; t < steps; ++t) {
    const DrawKeys keys{seed_, number, static_cast<std::uint32_t>(t), shard_.first_env};
    Decision decision;
    decision.envs = shard_.envs;
    decision.observations = now_.observations.data();
    decision.explore = &keys;
    decision.worker = worker;
    algorithm->Act(decision, {actions_.data(), log_prob_.data()});
    if (teach) AskTeacher();
    report_.inference_seconds += watch.Lap();

    env_.Step(actions_.data(), next_.arrays());
    past_.insert(past_.end(), actions_.begin(), actions_.end());
    for (int e = 0; e < shard_.envs; ++e) {
      const auto i = static_cast<std::size_t>(e);
      report_.reward += static_cast<double>(next_.team_rewards[i]);
      if (next_.truncated[i] != 0) report_.finished.push_back(env_.metrics(e));
    }
    Transition transition;
    transition.shard = index;
    transition.step = t;
    transition.envs = shard_.envs;
    transition.observations = now_.observations.data();
    transition.states = now_.states.data();
    transition.actions = actions_.data();
    transition.log_prob = log_prob_.data();
    transition.teacher = teach ? taught_.data() : nullptr;
    transition.rewards = next_.rewards.data();
    transition.team_rewards = next_.team_rewards.data();
    transition.truncated = next_.truncated.data();
    transition.next_observations = next_.observations.data();
    transition.next_states = next_.states.data();
    transition.final_observations = next_.final_observations.data();
    transition.final_states = next_.final_states.data();
    algorithm->Observe(transition);
    std::swap(now_, next_);
    report_.env_seconds += watch.Lap();
  }
}

void Collector::Unit::Repeat(const std::vector<float>& actions) {
  for (std::size_t from = 0; from < actions.size(); from += actions_.size()) {
    env_.Step(actions.data() + from, next_.arrays());
    std::swap(now_, next_);
  }
  past_ = actions;
}

void Collector::Unit::AskTeacher() {
  env::Decide(*teacher_, env_, now_.observations.data(), teacher_actions_.data());
  std::transform(teacher_actions_.begin(), teacher_actions_.end(), taught_.begin(),
                 [](double a) { return static_cast<float>(a); });
}

Collector::Collector(const env::EnvFactory& make_env, const TrainConfig& config,
                     const ImitationConfig* imitation, const Team& team)
    : envs_(config.envs), horizon_(config.horizon), team_(team) {
  const GroupShare share = team.share();
  // Checks the shards of all ranks, so that all ranks refuse together.
  for (int first = 0; first < share.groups; first += share.count) {
    RequireOption(!ShardsOf(share, first, share.count, config.envs).empty(), "envs",
                  "must be " + std::to_string(GroupShare::kBlock) + " for each rank at least");
  }
  for (const Shard& shard : ShardsOf(share, share.first, share.count, config.envs)) {
    units_.push_back(std::make_unique<Unit>(make_env, config, imitation, shard));
  }
  for (const Shard& shard : ShardsOf(share, 0, share.groups, config.envs)) {
    places_.insert(PastName(shard.first_env));
  }
}

Collector::~Collector() = default;

CollectionReport Collector::Collect(std::uint32_t number, bool teach, Algorithm* algorithm) {
  const Stopwatch watch;
  Collection collection;
  collection.number = number;
  collection.steps = horizon_;
  collection.taught = teach;
  for (const auto& unit : units_) collection.shards.push_back(unit->shard());
  algorithm->Begin(collection);
  team_.pool->Run(static_cast<int>(units_.size()), [&](int u, int worker) {
    units_[static_cast<std::size_t>(u)]->Collect(number, horizon_, teach, u, worker, algorithm);
  });

  CollectionReport report;
  std::vector<double> rewards;  // by shard
  for (const auto& unit : units_) {
    const CollectionReport& part = unit->report();
    report.finished.insert(report.finished.end(), part.finished.begin(), part.finished.end());
    rewards.push_back(part.reward);
    report.env_seconds += part.env_seconds;
    report.inference_seconds += part.inference_seconds;
  }
  report.finished = team_.ranks->Gather(report.finished);
  for (const double sum : team_.ranks->Gather(rewards)) report.reward += sum;
  report.reward /= static_cast<double>(envs_) * horizon_;
  const double wall = watch.seconds();
  const double share = report.env_seconds / (report.env_seconds + report.inference_seconds);
  report.env_seconds = wall * share;
  report.inference_seconds = wall * (1.0 - share);
  return report;
}

void Collector::RestartAt(std::uint64_t k) {
  for (auto& unit : units_) unit->RestartAt(k);
}

void Collector::ForgetPast() {
  for (auto& unit : units_) unit->ForgetPast();
}

void Collector::Save(Archive* archive) const {
  std::vector<int> places;  // first environment and size of each unit
  std::vector<float> past;
  for (const auto& unit : units_) {
    places.push_back(unit->shard().first_env);
    places.push_back(static_cast<int>(unit->past().size()));
    past.insert(past.end(), unit->past().begin(), unit->past().end());
  }
  const std::vector<int> all_places = team_.ranks->Gather(places);
  const std::vector<float> all = team_.ranks->Gather(past);
  auto from = all.begin();
  for (std::size_t k = 0; k < all_places.size(); k += 2) {
    const auto end = from + all_places[k + 1];
    archive->Put(PastName(all_places[k]), std::vector<float>(from, end));
    from = end;
  }
}

void Collector::Load(const Archive& archive) {
  if (archive.arrays().empty()) return;  // the archive is from a start of an episode
  std::set<std::string> theirs;
  for (const auto& array : archive.arrays()) theirs.insert(array.first);
  if (theirs != places_) throw UserError("its environments are divided into other shards");
  for (const auto& unit : units_) {
    const std::vector<float>& past = archive.Floats(PastName(unit->shard().first_env));
    if (past.size() % unit->decision_size() != 0) {
      throw UserError("the saved actions of environments " +
                      std::to_string(unit->shard().first_env) +
                      " and later do not make whole decisions");
    }
  }
  team_.pool->Run(static_cast<int>(units_.size()), [&](int u, int) {
    Unit& unit = *units_[static_cast<std::size_t>(u)];
    unit.Repeat(archive.Floats(PastName(unit.shard().first_env)));
  });
}

std::uint64_t Collector::round() const {
  std::uint64_t round = 0;
  for (const auto& unit : units_) {
    for (int e = 0; e < unit->shard().envs; ++e) round = std::max(round, unit->env().round(e));
  }
  const std::vector<std::uint64_t> all = team_.ranks->Gather(std::vector<std::uint64_t>{round});
  return *std::max_element(all.begin(), all.end());
}

bool Collector::at_episode_start() const {
  bool at_start = true;
  for (const auto& unit : units_) {
    for (int e = 0; e < unit->shard().envs; ++e) at_start = at_start && unit->env().step(e) == 0;
  }
  const std::vector<char> all = team_.ranks->Gather(std::vector<char>{at_start ? '1' : '0'});
  return std::count(all.begin(), all.end(), '0') == 0;
}

}  // namespace stg::learn
