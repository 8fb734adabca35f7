#include "marl_trainer/learn/algorithms/mappo/mappo.hpp"

#include <algorithm>
#include <cmath>

#include "auv_common/error.hpp"
#include "auv_common/numbers/random.hpp"
#include "marl_trainer/learn/nn/wall_units.hpp"
#include "stg_agent/policy/gaussian.hpp"

namespace stg::learn {
namespace {

/// Observations that the normaliser of a given policy counts for at least.
constexpr double kStartCount = 10000.0;

}  // namespace

Mappo::Mappo(const MappoConfig& config, const TrainConfig& common, const Problem& problem,
             WorkerPool* pool)
    : config_(config),
      problem_(problem),
      seed_(common.seed),
      networks_(problem, config),
      update_(networks_, config, common, problem.agents, pool),
      rollouts_(problem, config, networks_.critic, pool),
      parameters_(networks_.Initialise(seed_, config.initial_log_std)),
      adam_(networks_.parameters()),
      acting_(PassesOf(networks_.actor.mean(), pool->workers())) {}

void Mappo::Join(Communicator* ranks) {
  update_.Join(ranks);
  rollouts_.Join(ranks);
}

void Mappo::Begin(const Collection& collection) {
  collection_ = collection.number;
  rollouts_.Begin(collection);
}

void Mappo::Act(const Decision& decision, const Actions& out) {
  const int size = networks_.action_size(), rows = decision.envs * problem_.agents;
  const float* mean = acting_[static_cast<std::size_t>(decision.worker)].Evaluate(
      parameters_.data(), scales().observations, decision.observations, rows);
  std::copy_n(mean, rows * size, out.actions);
  if (decision.explore == nullptr) return;
  const DrawKeys& keys = *decision.explore;
  const float* log_std = parameters_.data() + networks_.actor.log_std_offset();
  float* action = out.actions;
  for (int r = 0; r < rows; ++r, action += size) {
    Random random(keys.seed, Stream::kPolicy, keys.collection, keys.step,
                  static_cast<std::uint32_t>(keys.first_env * problem_.agents + r));
    const float log_prob = agent::SampleGaussian(log_std, size, &random, action);
    if (out.log_prob != nullptr) out.log_prob[r] = log_prob;
  }
}

void Mappo::Observe(const Transition& t) { rollouts_.Observe(t); }

UpdateReport Mappo::Update(const UpdateContext& context) {
  const double explained_variance =
      rollouts_.Estimate(parameters_.data() + networks_.critic_offset());
  const double rate = 1.0 - (1.0 - config_.lr_final) * std::min(context.progress, 1.0);
  const PpoReport ppo = update_.Run(rollouts_.buffers(), scales(), collection_, rate,
                                    context.imitation, &parameters_, &adam_);
  rollouts_.UpdateInputScales();

  double sigma = 0.0, entropy = 0.0;
  for (int a = 0; a < networks_.action_size(); ++a) {
    const auto log_std = static_cast<double>(
        parameters_[networks_.actor.log_std_offset() + static_cast<std::size_t>(a)]);
    sigma += std::exp(log_std) / networks_.action_size();
    entropy += log_std + agent::kHalfLogTwoPiE;
  }
  UpdateReport report;
  report.flops = ppo.flops + 2.0 * ppo.samples * networks_.critic.spec().forward_products();
  report.values = PpoValues(ppo, config_.lr * rate, entropy, explained_variance, sigma);
  return report;
}

void Mappo::Save(Archive* archive) const {
  archive->Put("parameters", parameters_);
  adam_.Save("adam", archive);
  rollouts_.normalisers().Save(archive);
}

void Mappo::Load(const Archive& archive) {
  const std::size_t size = networks_.parameters();
  const std::vector<float>& parameters = archive.Floats("parameters", size);
  AdamState adam(size);
  adam.Load("adam", archive);
  rollouts_.normalisers().Load(archive);
  parameters_ = parameters;
  adam_ = std::move(adam);
}

void Mappo::StartFrom(const Archive& archive) {
  const std::vector<float>& theirs = archive.Floats("parameters", networks_.parameters());
  rollouts_.normalisers().Load(archive);
  const auto spread = static_cast<std::ptrdiff_t>(networks_.actor.log_std_offset());
  const std::vector<float> untrained = parameters_;
  parameters_ = theirs;
  std::copy_n(untrained.begin() + spread, networks_.action_size(), parameters_.begin() + spread);
  if (config_.wall_units > 0.0) {
    PlaceWallUnits(networks_.actor.mean(), config_.wall_units, problem_.workspace_half_extent_m,
                   scales().observations, parameters_.data());
  }
}

/// The critic stays untrained.
void Mappo::StartFrom(const agent::Policy& policy) {
  const agent::Policy::Parameters& p = policy.parameters();
  networks_.actor.FromPolicy(policy, parameters_.data());
  const double count =
      std::max(kStartCount, static_cast<double>(p.metadata.training_step) * problem_.agents);
  std::vector<double> moments{count};
  for (const float mean : p.input_mean) moments.push_back(static_cast<double>(mean));
  for (const float input_std : p.input_std) {
    const double std = static_cast<double>(input_std) / config_.std_scale;
    moments.push_back(count * std * std);
  }
  RunningMoments observations(problem_.observation_size);
  observations.Load(moments);
  rollouts_.normalisers().Add(observations, RunningMoments(problem_.state_size));
  rollouts_.normalisers().UpdateInputScales();
}

std::vector<agent::Policy> Mappo::Policies(const agent::PolicyMetadata& metadata) const {
  return {networks_.actor.ToPolicy(parameters_.data(), scales().observations, metadata)};
}

std::vector<NetworkSize> Mappo::Sizes() const {
  return {{"actor", networks_.actor.parameters()}, {"critic", networks_.critic.parameters()}};
}

}  // namespace stg::learn
