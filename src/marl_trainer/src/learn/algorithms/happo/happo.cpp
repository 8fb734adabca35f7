#include "marl_trainer/learn/algorithms/happo/happo.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "auv_common/error.hpp"
#include "auv_common/numbers/random.hpp"
#include "stg_agent/policy/gaussian.hpp"

namespace stg::learn {
namespace {

std::string ActorName(std::size_t agent) { return "actor_" + std::to_string(agent); }

}  // namespace

Happo::Happo(const HappoConfig& config, const TrainConfig& common, const Problem& problem,
             WorkerPool* pool)
    : config_(config),
      problem_(problem),
      networks_(problem, config),
      update_(networks_, config, common, problem.agents, pool),
      rollouts_(problem, config, networks_.critic, pool),
      acting_(PassesOf(networks_.actor.mean(), pool->workers())),
      own_(acting_.size()) {
  for (int i = 0; i < problem.agents; ++i) {
    std::vector<float> actor(networks_.actor.parameters());
    // Network 1 is the critic's.
    networks_.actor.Initialise(common.seed, static_cast<std::uint32_t>(i == 0 ? 0 : i + 1),
                               config.initial_log_std, actor.data());
    parameters_.actor_adams.emplace_back(actor.size());
    parameters_.actors.push_back(std::move(actor));
  }
  parameters_.critic.resize(networks_.critic.parameters());
  InitialiseOrthogonally(networks_.critic.spec(), common.seed, 1, parameters_.critic.data());
  parameters_.critic_adam = AdamState(parameters_.critic.size());
}

void Happo::Join(Communicator* ranks) {
  update_.Join(ranks);
  rollouts_.Join(ranks);
}

void Happo::Begin(const Collection& collection) {
  collection_ = collection.number;
  rollouts_.Begin(collection);
}

void Happo::Act(const Decision& decision, const Actions& out) {
  ObservedPass& acting = acting_[static_cast<std::size_t>(decision.worker)];
  std::vector<float>& own = own_[static_cast<std::size_t>(decision.worker)];
  const int envs = decision.envs, agents = problem_.agents, size = networks_.action_size();
  const auto inputs = static_cast<std::size_t>(networks_.actor.inputs());
  own.resize(static_cast<std::size_t>(envs) * inputs);
  for (int i = 0; i < agents; ++i) {
    const float* actor = parameters_.actors[static_cast<std::size_t>(i)].data();
    for (int e = 0; e < envs; ++e) {
      std::copy_n(decision.observations + static_cast<std::size_t>(e * agents + i) * inputs, inputs,
                  own.data() + static_cast<std::size_t>(e) * inputs);
    }
    const float* mean = acting.Evaluate(actor, rollouts_.scales().observations, own.data(), envs);
    const float* log_std = actor + networks_.actor.log_std_offset();
    for (int e = 0; e < envs; ++e) {
      const int row = e * agents + i;
      float* action = out.actions + static_cast<std::ptrdiff_t>(row) * size;
      std::copy_n(mean + static_cast<std::ptrdiff_t>(e) * size, size, action);
      if (decision.explore == nullptr) continue;
      const DrawKeys& keys = *decision.explore;
      Random random(keys.seed, Stream::kPolicy, keys.collection, keys.step,
                    static_cast<std::uint32_t>(keys.first_env * agents + row));
      const float log_prob = agent::SampleGaussian(log_std, size, &random, action);
      if (out.log_prob != nullptr) out.log_prob[row] = log_prob;
    }
  }
}

UpdateReport Happo::Update(const UpdateContext& context) {
  const double explained_variance = rollouts_.Estimate(parameters_.critic.data());
  const double rate = 1.0 - (1.0 - config_.lr_final) * std::min(context.progress, 1.0);
  const PpoReport ppo = update_.Run(rollouts_.buffers(), rollouts_.scales(), collection_, rate,
                                    context.imitation, &parameters_);
  rollouts_.UpdateInputScales();

  double sigma = 0.0, entropy = 0.0;
  for (const std::vector<float>& actor : parameters_.actors) {
    for (int a = 0; a < networks_.action_size(); ++a) {
      const auto log_std = static_cast<double>(
          actor[networks_.actor.log_std_offset() + static_cast<std::size_t>(a)]);
      sigma += std::exp(log_std) / (networks_.action_size() * problem_.agents);
      entropy += (log_std + agent::kHalfLogTwoPiE) / problem_.agents;
    }
  }
  UpdateReport report;
  report.flops = ppo.flops + 2.0 * ppo.samples * networks_.critic.spec().forward_products();
  report.values = PpoValues(ppo, config_.lr * rate, entropy, explained_variance, sigma);
  report.values.push_back(update_.ratio_miss());
  return report;
}

std::vector<ReportColumn> Happo::Columns() const {
  std::vector<ReportColumn> columns = PpoColumns();
  columns.push_back({"joint_ratio_miss", "|M-1|", 3});
  return columns;
}

std::vector<NetworkSize> Happo::Sizes() const {
  std::vector<NetworkSize> sizes;
  for (std::size_t i = 0; i < parameters_.actors.size(); ++i) {
    sizes.push_back({ActorName(i), networks_.actor.parameters()});
  }
  sizes.push_back({"critic", networks_.critic.parameters()});
  return sizes;
}

void Happo::Save(Archive* archive) const {
  for (std::size_t i = 0; i < parameters_.actors.size(); ++i) {
    archive->Put(ActorName(i), parameters_.actors[i]);
    parameters_.actor_adams[i].Save(ActorName(i) + "_adam", archive);
  }
  archive->Put("critic", parameters_.critic);
  parameters_.critic_adam.Save("critic_adam", archive);
  rollouts_.normalisers().Save(archive);
}

void Happo::Load(const Archive& archive) {
  HappoParameters loaded = parameters_;
  for (std::size_t i = 0; i < loaded.actors.size(); ++i) {
    loaded.actors[i] = archive.Floats(ActorName(i), loaded.actors[i].size());
    loaded.actor_adams[i].Load(ActorName(i) + "_adam", archive);
  }
  if (archive.Has(ActorName(loaded.actors.size()))) {
    throw UserError("actors of more AUVs than " + std::to_string(loaded.actors.size()));
  }
  loaded.critic = archive.Floats("critic", loaded.critic.size());
  loaded.critic_adam.Load("critic_adam", archive);
  rollouts_.normalisers().Load(archive);
  parameters_ = std::move(loaded);
}

void Happo::StartFrom(const Archive& archive) {
  const HappoParameters untrained = parameters_;
  Load(archive);
  const auto spread = static_cast<std::ptrdiff_t>(networks_.actor.log_std_offset());
  for (std::size_t i = 0; i < untrained.actors.size(); ++i) {
    std::copy_n(untrained.actors[i].begin() + spread, networks_.action_size(),
                parameters_.actors[i].begin() + spread);
  }
  parameters_.actor_adams = untrained.actor_adams;
  parameters_.critic_adam = untrained.critic_adam;
}

std::vector<agent::Policy> Happo::Policies(const agent::PolicyMetadata& metadata) const {
  std::vector<agent::Policy> policies;
  for (std::size_t i = 0; i < parameters_.actors.size(); ++i) {
    agent::PolicyMetadata own = metadata;
    own.id += "-auv" + std::to_string(i);
    policies.push_back(networks_.actor.ToPolicy(parameters_.actors[i].data(),
                                                rollouts_.scales().observations, own));
  }
  return policies;
}

}  // namespace stg::learn
