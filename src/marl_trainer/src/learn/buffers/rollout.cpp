#include "marl_trainer/learn/buffers/rollout.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <cmath>

#include "auv_common/numbers/random.hpp"
#include "marl_trainer/learn/algorithms/mappo/gae.hpp"
#include "stg_agent/policy/gaussian.hpp"

namespace stg::learn {
namespace {

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::size_t Size(int a, int b = 1, int c = 1, int d = 1) {
  return static_cast<std::size_t>(a) * static_cast<std::size_t>(b) * static_cast<std::size_t>(c) *
         static_cast<std::size_t>(d);
}

}  // namespace

void EstimateValues(const ActorCritic& networks, const float* parameters, const Scales& scales,
                    const float* states, int rows, Mlp::Workspace* critic, float* values) {
  for (int first = 0; first < rows; first += critic->rows()) {
    const int count = std::min(critic->rows(), rows - first);
    networks.critic.Forward(parameters + networks.critic_offset(),
                            states + Size(first, networks.critic.inputs()), count, critic);
    const float* out = critic->output();
    for (int r = 0; r < count; ++r) {
      values[first + r] = scales.value_mean + scales.value_std * out[r];
    }
  }
}

RolloutUnit::RolloutUnit(const std::vector<Scenario>& scenarios, const ActorCritic& networks,
                         const TrainConfig& config, int first_env, int envs)
    : networks_(networks),
      seed_(TrainingSeed(config.seed)),
      first_env_(first_env),
      envs_(envs),
      horizon_(config.horizon),
      agents_(scenarios.front().agents),
      episode_steps_(scenarios.front().time.episode_steps),
      total_envs_(config.envs),
      stagger_(config.stagger),
      gamma_(static_cast<float>(config.gamma)),
      lambda_(static_cast<float>(config.lambda)),
      actor_(networks.actor, envs * scenarios.front().agents),
      critic_(networks.critic, 256),
      observation_moments_(networks.actor.inputs()),
      state_moments_(networks.critic.inputs()) {
  assert(envs % kLanes == 0);
  env::EnvOptions options;
  options.seed = seed_;
  options.total_envs = config.envs;
  for (int env = 0; env < envs; env += kLanes) {
    options.first_env = first_env + env;
    const Scenario& scenario =
        scenarios[static_cast<std::size_t>(options.first_env / kLanes) % scenarios.size()];
    options.curriculum = scenario.reset.curriculum;
    groups_.emplace_back(scenario, options);
  }
  const int features = networks.actor.inputs(), state = networks.critic.inputs();
  buffer_.observations.resize(Size(horizon_, envs, agents_, features));
  buffer_.actions.resize(Size(horizon_, envs, agents_, networks.action_size()));
  buffer_.log_prob.resize(Size(horizon_, envs, agents_));
  buffer_.states.resize(Size(horizon_, envs, state));
  for (auto* per_sample :
       {&buffer_.rewards, &buffer_.values, &buffer_.final_values, &buffer_.advantages}) {
    per_sample->resize(Size(horizon_, envs));
  }
  buffer_.done.resize(Size(horizon_, envs));
  buffer_.bootstrap.resize(Size(envs));
  raw_observations_.resize(Size(envs, agents_, features));
  raw_states_.resize(Size(envs, state));
  last_states_.resize(Size(envs, state));
  if (!config.imitate.empty()) {
    teachers_.push_back(env::MakeController(config.imitate, scenarios.front()));
    teachers_.front().privileged = config.privileged_teacher;
  }
  RestartAt(0);
}

int RolloutUnit::stagger(std::size_t group) const {
  if (!stagger_) return 0;
  const int groups = total_envs_ / kLanes;
  const int index = first_env_ / kLanes + static_cast<int>(group);
  return std::max(1, episode_steps_ * (index + 1) / groups);
}

void RolloutUnit::RestartAt(std::uint64_t round) {
  for (std::size_t g = 0; g < groups_.size(); ++g) groups_[g].RestartAt(round, stagger(g));
}

bool RolloutUnit::at_episode_start() const {
  return std::all_of(groups_.begin(), groups_.end(),
                     [](const env::EnvGroup& group) { return group.step() == 0; });
}

void RolloutUnit::Collect(const float* parameters, const Scales& scales, std::uint32_t collection,
                          bool teach) {
  observation_moments_.Clear();
  state_moments_.Clear();
  finished_.clear();
  final_states_.clear();
  final_samples_.clear();
  env_seconds_ = inference_seconds_ = 0.0;
  if (!teach) buffer_.teacher.clear();
  std::fill(buffer_.done.begin(), buffer_.done.end(), std::uint8_t{0});
  const std::size_t per_group = Size(kLanes, agents_, networks_.action_size());
  for (int t = 0; t < horizon_; ++t) {
    Clock::time_point start = Clock::now();
    Observe(scales, t);
    ActRandomly(parameters, collection, t);
    if (teach) AskTeacher(t);
    inference_seconds_ += SecondsSince(start);
    start = Clock::now();
    const float* actions =
        buffer_.actions.data() +
        Size(t, envs_, agents_) * static_cast<std::size_t>(networks_.action_size());
    for (std::size_t g = 0; g < groups_.size(); ++g) groups_[g].Step(actions + g * per_group);
    StoreStep(scales, t);
    env_seconds_ += SecondsSince(start);
  }
  const Clock::time_point start = Clock::now();
  ComputeValues(parameters, scales);
  inference_seconds_ += SecondsSince(start);
}

void RolloutUnit::Observe(const Scales& scales, int t) {
  const int features = networks_.actor.inputs(), state = networks_.critic.inputs();
  const std::size_t per_observation = Size(kLanes, agents_, features);
  const std::size_t per_state = Size(kLanes, state);
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    std::copy_n(groups_[g].observations(), per_observation,
                raw_observations_.data() + g * per_observation);
    std::copy_n(groups_[g].states(), per_state, raw_states_.data() + g * per_state);
  }
  if (t % kMomentStride == 0) {
    observation_moments_.Add(raw_observations_.data(), envs_ * agents_);
    state_moments_.Add(raw_states_.data(), envs_);
  }
  scales.observations.Apply(raw_observations_.data(), envs_ * agents_,
                            buffer_.observations.data() + Size(t, envs_, agents_, features));
  scales.states.Apply(raw_states_.data(), envs_, buffer_.states.data() + Size(t, envs_, state));
}

void RolloutUnit::ActRandomly(const float* parameters, std::uint32_t collection, int t) {
  const int size = networks_.action_size(), rows = envs_ * agents_;
  const float* x = buffer_.observations.data() + Size(t, rows, networks_.actor.inputs());
  networks_.actor.Forward(parameters, x, rows, &actor_);
  float* mean = actor_.output();
  SquashMean(networks_.action_scale, rows * size, mean);
  const float* log_std = parameters + networks_.log_std_offset();
  float* action = buffer_.actions.data() + Size(t, rows, size);
  float* log_prob = buffer_.log_prob.data() + Size(t, rows);
  std::copy_n(mean, rows * size, action);
  for (int r = 0; r < rows; ++r, action += size) {
    Random random(seed_, Stream::kPolicy, collection, static_cast<std::uint32_t>(t),
                  static_cast<std::uint32_t>(first_env_ * agents_ + r));
    log_prob[r] = agent::SampleGaussian(log_std, size, &random, action);
  }
}

void RolloutUnit::AskTeacher(int t) {
  const std::size_t per_group = Size(kLanes, agents_, networks_.action_size());
  std::vector<double> actions(per_group);
  buffer_.teacher.resize(buffer_.actions.size());
  float* out = buffer_.teacher.data() +
               Size(t, envs_, agents_) * static_cast<std::size_t>(networks_.action_size());
  for (const env::EnvGroup& group : groups_) {
    env::Decide(teachers_.front(), group, actions.data());
    for (const double a : actions) *out++ = static_cast<float>(a);
  }
}

void RolloutUnit::StoreStep(const Scales& scales, int t) {
  const int state = networks_.critic.inputs();
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const env::EnvGroup& group = groups_[g];
    const std::size_t first = Size(t, envs_) + g * static_cast<std::size_t>(kLanes);
    std::copy_n(group.rewards(), kLanes, buffer_.rewards.data() + first);
    if (!group.truncated()) continue;
    const std::size_t offset = final_states_.size();
    final_states_.resize(offset + Size(kLanes, state));
    scales.states.Apply(group.final_states(), kLanes, final_states_.data() + offset);
    for (int lane = 0; lane < kLanes; ++lane) {
      const std::size_t sample = first + static_cast<std::size_t>(lane);
      buffer_.done[sample] = 1;
      final_samples_.push_back(static_cast<int>(sample));
      finished_.push_back(group.metrics(lane));
    }
  }
}

void RolloutUnit::ComputeValues(const float* parameters, const Scales& scales) {
  const int state = networks_.critic.inputs();
  const auto estimate = [&](const std::vector<float>& states, int rows, float* values) {
    EstimateValues(networks_, parameters, scales, states.data(), rows, &critic_, values);
  };
  estimate(buffer_.states, samples(), buffer_.values.data());
  const std::size_t per_state = Size(kLanes, state);
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    scales.states.Apply(groups_[g].states(), kLanes, last_states_.data() + g * per_state);
  }
  estimate(last_states_, envs_, buffer_.bootstrap.data());
  std::vector<float> finals(final_samples_.size());
  estimate(final_states_, static_cast<int>(finals.size()), finals.data());
  for (std::size_t i = 0; i < finals.size(); ++i) {
    buffer_.final_values[static_cast<std::size_t>(final_samples_[i])] = finals[i];
  }
  for (int e = 0; e < envs_; ++e) {
    GeneralisedAdvantages(buffer_.rewards.data() + e, buffer_.values.data() + e,
                          buffer_.done.data() + e, buffer_.final_values.data() + e,
                          buffer_.bootstrap[static_cast<std::size_t>(e)], horizon_, envs_, gamma_,
                          lambda_, buffer_.advantages.data() + e);
  }
}

}  // namespace stg::learn
