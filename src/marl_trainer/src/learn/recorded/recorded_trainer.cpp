#include "marl_trainer/learn/recorded/recorded_trainer.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "auv_common/error.hpp"
#include "marl_trainer/learn/collect/collector.hpp"
#include "marl_trainer/learn/nn/blas.hpp"
#include "marl_trainer/learn/run/train_log.hpp"
#include "marl_trainer/learn/stopwatch.hpp"

namespace stg::learn {
namespace {

std::shared_ptr<const agent::Policy> LoadStart(const std::string& path,
                                               const agent::AgentModel& model) {
  if (path.empty()) return nullptr;
  auto policy = std::make_shared<const agent::Policy>(agent::Policy::LoadOnnx(path));
  policy->RequireFits(model);
  const double scale = policy->metadata().action_scale;
  if (std::abs(scale - model.control.action_scale) > 1e-6) {
    throw UserError(path + ": its action scale is " + std::to_string(scale) +
                    ", the scenario's control.action_scale " +
                    std::to_string(model.control.action_scale));
  }
  return policy;
}

/// The setup for collections of whole episodes. The actor has the shape of the policy to start
/// from.
TrainSetup Fit(TrainSetup setup, const RunConfig& run, const agent::Policy* start) {
  setup.common.envs = 1;
  setup.common.horizon = run.time.episode_steps;
  setup.common.stagger = false;
  if (start != nullptr) setup.own->FitPolicy(*start);
  setup.ValidateOrThrow();
  return setup;
}

/// FNV-1a hash of the policy's numbers, which identifies the result of an update.
std::string Hash(const agent::Policy& policy) {
  std::uint32_t hash = 2166136261U;
  const auto add = [&hash](const float* data, Eigen::Index count) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(data);
    const std::size_t size = static_cast<std::size_t>(count) * sizeof(float);
    for (std::size_t i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * 16777619U;
  };
  const agent::Policy::Parameters& p = policy.parameters();
  for (const agent::Policy::Layer& layer : p.layers) {
    add(layer.weight.data(), layer.weight.size());
    add(layer.bias.data(), layer.bias.size());
  }
  add(p.log_std.data(), p.log_std.size());
  add(p.input_mean.data(), p.input_mean.size());
  add(p.input_std.data(), p.input_std.size());
  char text[12];
  std::snprintf(text, sizeof text, "%08x", hash);
  return text;
}

/// Arrays of a transition, for one step of a recorded episode.
struct StepArrays {
  std::vector<float> observations, actions, log_prob;
  float reward = 0.0F;
  std::uint8_t truncated = 0;

  void Read(const RecordedEpisode& episode, std::uint32_t t) {
    observations.clear();
    actions.clear();
    log_prob.clear();
    for (const auto& steps : episode.steps) {
      const AgentRecord& r = steps.at(t);
      observations.insert(observations.end(), r.observation.begin(), r.observation.end());
      actions.insert(actions.end(), r.action.begin(), r.action.end());
      log_prob.push_back(r.log_probability);
    }
    const RewardRecord& r = episode.rewards.at(t);
    reward = static_cast<float>(r.reward);
    truncated = r.truncated ? 1 : 0;
  }
};

}  // namespace

TrainSetup RecordedSetup(const RunConfig& run, const std::string& algorithm) {
  TrainSetup setup(algorithm, "fast");
  setup.common.envs = 1;
  setup.common.horizon = run.time.episode_steps;
  setup.own->ApplyRecordings(setup.common);
  return setup;
}

RecordedTrainer::RecordedTrainer(const Scenario& scenario, const TrainSetup& setup,
                                 const Options& options)
    : RecordedTrainer(scenario, setup, options, LoadStart(options.policy, scenario.model())) {}

RecordedTrainer::RecordedTrainer(const Scenario& scenario, const TrainSetup& setup,
                                 const Options& options,
                                 const std::shared_ptr<const agent::Policy>& start)
    : scenario_(scenario),
      setup_(Fit(setup, scenario.run, start.get())),
      options_(options),
      problem_(ProblemOf(scenario.run, scenario.world, scenario.agent)),
      pool_(options.workers),
      algorithm_(setup_.own->Make(setup_.common, problem_, &pool_)),
      folder_(options.out, options.log) {
  folder_.Lock();
  UseOneBlasThread();
  state_.config = ToJson(setup_).dump();
  state_.scenario = ToYaml(scenario_);
  if (const auto loaded = folder_.Newest()) {
    Restore(*loaded, start.get());
  } else if (start) {
    algorithm_->StartFrom(*start);
    state_.env_steps = start->metadata().training_step;
    policy_ = start;
  }
  if (!policy_) policy_ = std::make_shared<const agent::Policy>(MakePolicy());
  policy_->SaveOnnx(policy_path());
}

void RecordedTrainer::Restore(const TrainState& state, const agent::Policy* start) {
  GoOnFrom(
      state, options_.out, [this](const Archive& a) { algorithm_->Load(a); }, &state_);
  policy_ = std::make_shared<const agent::Policy>(MakePolicy());
  if (start != nullptr && start->metadata().id != policy_id()) {
    throw UserError(options_.out + ": holds the training of '" + policy_id() + "', not of '" +
                    start->metadata().id + "'; use another folder or no policy");
  }
}

Finding RecordedTrainer::Check(const RecordedEpisode& episode) const {
  return EpisodeChecker(scenario_.run, scenario_.agent.observation, state_size(), *policy_)
      .Check(episode);
}

double RecordedTrainer::Observe(const RecordedEpisode& episode, int shard) {
  const auto steps = static_cast<std::uint32_t>(scenario_.run.time.episode_steps);
  StepArrays step, next;
  step.Read(episode, 0);
  double sum = 0.0;
  for (std::uint32_t t = 0; t < steps; ++t) {
    const RewardRecord& reward = episode.rewards.at(t);
    const bool last = t + 1 == steps;
    if (!last) next.Read(episode, t + 1);
    Transition transition;
    transition.shard = shard;
    transition.step = static_cast<int>(t);
    transition.envs = 1;
    transition.observations = step.observations.data();
    transition.states = reward.state.data();
    transition.actions = step.actions.data();
    transition.log_prob = step.log_prob.data();
    transition.team_rewards = &step.reward;
    transition.truncated = &step.truncated;
    transition.next_observations = last ? nullptr : next.observations.data();
    transition.next_states =
        last ? reward.final_state.data() : episode.rewards.at(t + 1).state.data();
    transition.final_states = last ? reward.final_state.data() : nullptr;
    algorithm_->Observe(transition);
    sum += reward.reward;
    std::swap(step, next);
  }
  return sum;
}

RecordedTrainer::Progress RecordedTrainer::Update(const std::vector<RecordedEpisode>& episodes) {
  assert(!episodes.empty());
  const Stopwatch watch;
  Collection collection;
  collection.number = static_cast<std::uint32_t>(state_.collections);
  collection.steps = scenario_.run.time.episode_steps;
  const int count = static_cast<int>(episodes.size());
  for (int e = 0; e < count; ++e) {
    collection.shards.push_back({e, 1, e * kGroups / std::max(count, kGroups)});
  }
  algorithm_->Begin(collection);
  std::vector<double> returns(episodes.size());
  pool_.Run(static_cast<int>(episodes.size()), [&](int e, int) {
    const auto i = static_cast<std::size_t>(e);
    returns[i] = Observe(episodes[i], e);
  });
  const UpdateReport report = algorithm_->Update(UpdateContext());
  ++state_.collections;
  state_.env_steps += static_cast<std::int64_t>(episodes.size()) * collection.steps;
  policy_ = std::make_shared<const agent::Policy>(MakePolicy());
  policy_->SaveOnnx(policy_path());

  Progress p;
  p.seconds = watch.seconds();
  state_.wall_seconds += p.seconds;
  TrainState saved = state_;
  algorithm_->Save(&saved.algorithm);
  folder_.Save(saved, setup_.common.keep_checkpoints);
  p.updates = state_.collections;
  p.env_steps = state_.env_steps;
  p.episodes = static_cast<int>(episodes.size());
  p.episode_return = std::accumulate(returns.begin(), returns.end(), 0.0) * scenario_.run.agents /
                     static_cast<double>(episodes.size());
  p.report = ReportText(algorithm_->Columns(), report.values);
  return p;
}

agent::Policy RecordedTrainer::MakePolicy() const {
  const std::string id = scenario_.run.name + "-recorded-" + std::to_string(state_.env_steps);
  agent::PolicyMetadata m =
      MetadataOf(scenario_.agent.observation, scenario_.world.control, ScenarioHash(scenario_), id,
                 state_.env_steps, setup_.common.seed);
  std::vector<agent::Policy> policies = algorithm_->Policies(m);
  if (policies.size() != 1) {
    throw UserError(setup_.algorithm +
                    " cannot learn from recordings: its AUVs fly with policies "
                    "of their own");
  }
  m.id += "-" + Hash(policies.front());
  return std::move(algorithm_->Policies(m).front());
}

}  // namespace stg::learn
