#include "marl_trainer/learn/recorded/recorded_trainer.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "auv_common/config/files.hpp"
#include "auv_common/error.hpp"
#include "marl_trainer/learn/algorithms/mappo/gae.hpp"
#include "marl_trainer/learn/nn/blas.hpp"
#include "marl_trainer/scenario/scenario.hpp"

namespace stg::learn {
namespace {

namespace fs = std::filesystem;

constexpr int kValueRows = 256;
/// Observations that the normaliser of a given policy counts for at least.
constexpr double kStartCount = 10000.0;

double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::shared_ptr<const agent::Policy> LoadStart(const std::string& path, const Scenario& scenario) {
  if (path.empty()) return nullptr;
  auto policy = std::make_shared<const agent::Policy>(agent::Policy::LoadOnnx(path));
  policy->RequireFits(scenario);
  const double scale = policy->metadata().action_scale;
  if (std::abs(scale - scenario.control.action_scale) > 1e-6) {
    throw UserError(path + ": its action scale is " + std::to_string(scale) +
                    ", the scenario's control.action_scale " +
                    std::to_string(scenario.control.action_scale));
  }
  return policy;
}

/// The configuration with the actor's shape taken from the policy to start from.
TrainConfig Fit(TrainConfig config, const Scenario& scenario, const agent::Policy* start) {
  const int steps = scenario.time.episode_steps;
  config.envs = kLanes;
  config.horizon = steps;
  config.stagger = false;
  if (start != nullptr) {
    const agent::Policy::Parameters& p = start->parameters();
    config.actor_hidden.clear();
    for (std::size_t l = 0; l + 1 < p.layers.size(); ++l) {
      config.actor_hidden.push_back(static_cast<int>(p.layers[l].bias.size()));
    }
    config.activation = p.activation == agent::Policy::Activation::kRelu ? "relu" : "tanh";
    config.observation_clip = static_cast<double>(p.input_clip);
    // A component that never moved has the smallest deviation: the floor, scaled.
    const auto smallest = static_cast<double>(p.input_std.minCoeff());
    if (smallest < config.std_floor * config.std_scale) {
      config.std_scale = smallest / config.std_floor;
    }
  }
  config.ValidateOrThrow();
  if (steps % config.minibatch != 0) {
    throw UserError("minibatch " + std::to_string(config.minibatch) +
                    " must divide the episode's " + std::to_string(steps) + " steps");
  }
  return config;
}

std::string Hash(const std::vector<float>& parameters) {
  std::uint32_t hash = 2166136261U;
  const auto* bytes = reinterpret_cast<const unsigned char*>(parameters.data());
  for (std::size_t i = 0; i < parameters.size() * sizeof(float); ++i) {
    hash = (hash ^ bytes[i]) * 16777619U;
  }
  char text[12];
  std::snprintf(text, sizeof text, "%08x", hash);
  return text;
}

}  // namespace

TrainConfig RecordedConfig(const Scenario& scenario) {
  TrainConfig config = Preset("fast");
  config.epochs = 10;
  config.lr_final = 1.0;
  config.target_kl = 0.1;
  config.minibatch = std::min(500, scenario.time.episode_steps);
  while (scenario.time.episode_steps % config.minibatch != 0) --config.minibatch;
  return config;
}

RecordedTrainer::RecordedTrainer(const Scenario& scenario, const TrainConfig& config,
                                 const Options& options)
    : RecordedTrainer(scenario, config, options, LoadStart(options.policy, scenario)) {}

RecordedTrainer::RecordedTrainer(const Scenario& scenario, const TrainConfig& config,
                                 const Options& options,
                                 const std::shared_ptr<const agent::Policy>& start)
    : scenario_(scenario),
      config_(Fit(config, scenario, start.get())),
      options_(options),
      pool_(options.workers),
      learner_(scenario_, config_, &pool_),
      critic_(learner_.networks().critic, kValueRows),
      observation_moments_(learner_.networks().actor.inputs()),
      state_moments_(learner_.networks().critic.inputs()) {
  UseOneBlasThread();
  learner_.Initialise(&state_);
  state_.config = ToJson(config_).dump();
  state_.scenario = ToYaml(scenario_);
  std::error_code error;
  fs::create_directories(options_.out, error);
  if (!fs::is_directory(options_.out)) throw UserError(options_.out + ": cannot create the folder");
  if (const auto loaded = LoadNewestCheckpoint(options_.out, options_.log)) {
    Restore(*loaded, start.get());
  } else if (start) {
    StartFrom(*start);
    policy_ = start;
  }
  if (!policy_) policy_ = std::make_shared<const agent::Policy>(MakePolicy());
  policy_->SaveOnnx(policy_path());
}

void RecordedTrainer::Restore(const TrainState& state, const agent::Policy* start) {
  if (state.scenario != state_.scenario) {
    throw UserError(options_.out + ": holds a training in another scenario");
  }
  if (!learner_.Restore(state)) {
    throw UserError(options_.out + ": holds a training with other network sizes");
  }
  const std::string config = state_.config;
  state_ = state;
  state_.config = config;
  policy_ = std::make_shared<const agent::Policy>(MakePolicy());
  if (start != nullptr && start->metadata().id != policy_id()) {
    throw UserError(options_.out + ": holds the training of '" + policy_id() + "', not of '" +
                    start->metadata().id + "'; use another folder or no policy");
  }
}

/// Takes actor, spread and observation normaliser from a policy; the critic stays untrained.
void RecordedTrainer::StartFrom(const agent::Policy& policy) {
  using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const agent::Policy::Parameters& p = policy.parameters();
  const ActorCritic& networks = learner_.networks();
  float* out = state_.parameters.data();
  for (int l = 0; l < networks.actor.layers(); ++l) {
    const agent::Policy::Layer& layer = p.layers[static_cast<std::size_t>(l)];
    Eigen::Map<RowMajor>(out + networks.actor.weight_offset(l), layer.weight.rows(),
                         layer.weight.cols()) = layer.weight;
    Eigen::Map<Eigen::VectorXf>(out + networks.actor.bias_offset(l), layer.bias.size()) =
        layer.bias;
  }
  for (Eigen::Index a = 0; a < p.log_std.size(); ++a) {
    out[networks.log_std_offset() + static_cast<std::size_t>(a)] = p.log_std[a];
  }
  const auto size = static_cast<std::size_t>(policy.observation_size());
  const double count =
      std::max(kStartCount, static_cast<double>(p.metadata.training_step) * scenario_.agents);
  std::vector<double> moments{count};
  for (std::size_t i = 0; i < size; ++i) {
    moments.push_back(static_cast<double>(p.input_mean[static_cast<Eigen::Index>(i)]));
  }
  for (std::size_t i = 0; i < size; ++i) {
    const double std =
        static_cast<double>(p.input_std[static_cast<Eigen::Index>(i)]) / config_.std_scale;
    moments.push_back(count * std * std);
  }
  RunningMoments observations(static_cast<int>(size));
  observations.Load(moments);
  learner_.AddMoments(observations, RunningMoments(state_size()));
  learner_.UpdateInputScales();
  state_.env_steps = p.metadata.training_step;
}

std::string RecordedTrainer::policy_path() const {
  return fs::absolute(fs::path(options_.out) / "policy_last.onnx").string();
}

Finding RecordedTrainer::Check(const RecordedEpisode& episode) const {
  return EpisodeChecker(scenario_, state_size(), *policy_).Check(episode);
}

RolloutBuffer RecordedTrainer::Rollout(const RecordedEpisode& episode) {
  const int steps = scenario_.time.episode_steps, agents = scenario_.agents;
  const ActorCritic& networks = learner_.networks();
  const Scales& scales = learner_.scales();
  const auto samples = static_cast<std::size_t>(steps);
  RolloutBuffer b;
  std::vector<float> final_state(static_cast<std::size_t>(state_size()));
  b.states.resize(samples * final_state.size());
  b.observations.resize(samples * static_cast<std::size_t>(agents * networks.actor.inputs()));
  float* observation = b.observations.data();
  float* state = b.states.data();
  for (int t = 0; t < steps; ++t) {
    const auto k = static_cast<std::uint32_t>(t);
    for (int i = 0; i < agents; ++i) {
      const AgentRecord& r = episode.steps[static_cast<std::size_t>(i)].at(k);
      observation_moments_.Add(r.observation.data(), 1);
      scales.observations.Apply(r.observation.data(), 1, observation);
      observation += networks.actor.inputs();
      b.actions.insert(b.actions.end(), r.action.begin(), r.action.end());
      b.log_prob.push_back(r.log_probability);
    }
    const RewardRecord& r = episode.rewards.at(k);
    state_moments_.Add(r.state.data(), 1);
    scales.states.Apply(r.state.data(), 1, state);
    state += state_size();
    b.rewards.push_back(static_cast<float>(r.reward));
    b.done.push_back(r.truncated ? 1 : 0);
    if (r.truncated) scales.states.Apply(r.final_state.data(), 1, final_state.data());
  }
  b.values.resize(samples);
  b.final_values.resize(samples);
  b.advantages.resize(samples);
  b.bootstrap.assign(1, 0.0F);
  const float* parameters = state_.parameters.data();
  EstimateValues(networks, parameters, scales, b.states.data(), steps, &critic_, b.values.data());
  EstimateValues(networks, parameters, scales, final_state.data(), 1, &critic_,
                 &b.final_values.back());
  GeneralisedAdvantages(b.rewards.data(), b.values.data(), b.done.data(), b.final_values.data(),
                        0.0F, steps, 1, static_cast<float>(config_.gamma),
                        static_cast<float>(config_.lambda), b.advantages.data());
  return b;
}

RecordedTrainer::Progress RecordedTrainer::Update(const std::vector<RecordedEpisode>& episodes) {
  assert(!episodes.empty());
  const double begin = Now();
  observation_moments_.Clear();
  state_moments_.Clear();
  std::vector<RolloutBuffer> buffers;
  std::vector<const RolloutBuffer*> rollouts;
  for (const RecordedEpisode& episode : episodes) buffers.push_back(Rollout(episode));
  for (const RolloutBuffer& buffer : buffers) rollouts.push_back(&buffer);
  const Learner::Report learned =
      learner_.Update(rollouts, static_cast<std::uint32_t>(state_.collections), 1.0, &state_);
  learner_.AddMoments(observation_moments_, state_moments_);
  learner_.UpdateInputScales();
  ++state_.collections;
  state_.env_steps +=
      static_cast<std::int64_t>(episodes.size()) * static_cast<std::int64_t>(config_.horizon);
  policy_ = std::make_shared<const agent::Policy>(MakePolicy());
  policy_->SaveOnnx(policy_path());

  Progress p;
  p.seconds = Now() - begin;
  state_.wall_seconds += p.seconds;
  TrainState saved = state_;
  learner_.Save(&saved);
  SaveCheckpoint(saved, CheckpointPath(options_.out, state_.env_steps));
  PruneCheckpoints(options_.out, config_.keep_checkpoints);
  p.updates = state_.collections;
  p.env_steps = state_.env_steps;
  p.episodes = static_cast<int>(episodes.size());
  p.episode_return = learned.reward * scenario_.agents * config_.horizon;
  p.kl = learned.update.sums.kl / learned.update.sums.rows;
  p.clip_fraction = learned.update.sums.clipped / learned.update.sums.rows;
  p.explained_variance = learned.explained_variance;
  const auto& log_std = policy_->parameters().log_std;
  p.sigma = static_cast<double>(log_std.array().exp().mean());
  return p;
}

agent::Policy RecordedTrainer::MakePolicy() const {
  agent::PolicyMetadata m;
  m.id = scenario_.name + "-recorded-" + std::to_string(state_.env_steps) + "-" +
         Hash(state_.parameters);
  m.observation_layout = agent::ObservationLayout(scenario_);
  m.action_interface = agent::ActionInterfaceName(scenario_.control.interface);
  m.scenario_hash = ScenarioHash(scenario_);
  m.training_step = state_.env_steps;
  m.seed = config_.seed;
  return learner_.networks().ToPolicy(state_.parameters.data(), learner_.scales().observations,
                                      std::move(m));
}

}  // namespace stg::learn
