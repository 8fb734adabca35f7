#include "marl_trainer/learn/algorithms/mappo/mappo.hpp"

#include <algorithm>
#include <utility>

#include "marl_trainer/learn/nn/wall_units.hpp"
#include "marl_trainer/learn/train_config.hpp"
#include "stg_agent/graph/observation.hpp"

namespace stg::learn {

Mappo::Mappo(const MappoConfig& config, const TrainConfig& common, const Problem& problem,
             const Team& team)
    : wall_units_(config.wall_units),
      problem_(problem),
      networks_(problem, config),
      actor_(networks_.NewActor(common.seed, 0, config.initial_log_std)),
      critic_(networks_.NewCritic(common.seed)),
      update_(networks_, config, common.seed, problem.agents, team),
      rollouts_(problem, config, networks_.critic, team),
      acting_(PassesOf(networks_.actor.mean(), team.pool->workers())) {}

void Mappo::Begin(const Collection& collection) {
  collection_ = collection.number;
  rollouts_.Begin(collection);
}

/// Draws every AUV's action from its own observation (Eqs. 9, 37).
void Mappo::Act(const Decision& decision, const Actions& out) {
  const int rows = decision.envs * problem_.agents;
  const float* mean = acting_[static_cast<std::size_t>(decision.worker)].Evaluate(
      actor_.numbers.data(), scales().observations, decision.observations, rows);
  std::copy_n(mean, rows * networks_.action_size(), out.actions);
  if (decision.explore == nullptr) return;
  for (int row = 0; row < rows; ++row) {
    networks_.Explore(actor_, *decision.explore, problem_.agents, row, out);
  }
}

UpdateReport Mappo::Update(const UpdateContext& context) {
  const double explained_variance = rollouts_.Estimate(critic_.numbers.data());  // Eqs. 38-40
  update_.Begin(rollouts_.buffers(), scales(), collection_, context);
  const int epochs = update_.TrainActor({0, problem_.agents}, 0, nullptr, &actor_);  // Eqs. 41, 42
  update_.TrainCritic(epochs, 0, &critic_);                                          // Eq. 43
  rollouts_.UpdateInputScales();
  return update_.Report(explained_variance, {&actor_});
}

void Mappo::Save(Archive* archive) const {
  actor_.Save("actor", archive);
  critic_.Save("critic", archive);
  rollouts_.normalisers().Save(archive);
}

void Mappo::Load(const Archive& archive) {
  Trained actor = actor_, critic = critic_;
  actor.Load("actor", archive);
  critic.Load("critic", archive);
  rollouts_.normalisers().Load(archive);
  actor_ = std::move(actor);
  critic_ = std::move(critic);
}

void Mappo::StartFrom(const Archive& archive) {
  const std::vector<float>& actor = archive.Floats("actor", actor_.numbers.size());
  const std::vector<float>& critic = archive.Floats("critic", critic_.numbers.size());
  rollouts_.normalisers().Load(archive);
  std::copy_n(actor.begin(), networks_.actor.log_std_offset(), actor_.numbers.begin());
  critic_.numbers = critic;
  if (wall_units_ > 0.0) {
    PlaceWallUnits(networks_.actor.mean(), {agent::kOwnPositionIndex, agent::kTargetOffsetIndex},
                   wall_units_, problem_.workspace_half_extent_m, scales().observations,
                   actor_.numbers.data());
  }
}

void Mappo::StartFrom(const agent::Policy& policy) {
  networks_.actor.FromPolicy(policy, actor_.numbers.data());
  rollouts_.normalisers().StartFrom(policy, problem_.agents);
}

std::vector<agent::Policy> Mappo::Policies(const agent::PolicyMetadata& metadata) const {
  return {networks_.actor.ToPolicy(actor_.numbers.data(), scales().observations, metadata)};
}

std::vector<NetworkSize> Mappo::Sizes() const {
  return {{"actor", actor_.numbers.size()}, {"critic", critic_.numbers.size()}};
}

}  // namespace stg::learn
