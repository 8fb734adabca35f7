#include "marl_trainer/learn/algorithms/happo/happo.hpp"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

#include "auv_common/error.hpp"
#include "auv_common/numbers/random.hpp"
#include "marl_trainer/learn/train_config.hpp"

namespace stg::learn {
namespace {

/// Number of keys for the epochs of one training in an update: of each AUV, then of the critic.
constexpr std::uint32_t kEpochsOfATurn = 1000;
/// Index of the draw for the order of the AUVs, among the draws of a collection's shuffles.
constexpr std::uint32_t kOrderDraw = 1;

std::string ActorName(std::size_t auv) { return "actor_" + std::to_string(auv); }

}  // namespace

Happo::Happo(const HappoConfig& config, const TrainConfig& common, const Problem& problem,
             const Team& team)
    : config_(config),
      seed_(common.seed),
      agents_(problem.agents),
      networks_(problem, config),
      critic_(networks_.NewCritic(common.seed)),
      update_(networks_, config, common.seed, 1, team),
      ratio_(networks_, team),
      rollouts_(problem, config, networks_.critic, team),
      acting_(PassesOf(networks_.actor.mean(), team.pool->workers())),
      own_(acting_.size()),
      order_(static_cast<std::size_t>(problem.agents)) {
  for (int i = 0; i < agents_; ++i) {
    actors_.push_back(networks_.NewActor(common.seed, i, config.initial_log_std));
  }
}

void Happo::Begin(const Collection& collection) {
  collection_ = collection.number;
  rollouts_.Begin(collection);
}

void Happo::Act(const Decision& decision, const Actions& out) {
  ObservedPass& acting = acting_[static_cast<std::size_t>(decision.worker)];
  std::vector<float>& own = own_[static_cast<std::size_t>(decision.worker)];
  const int size = networks_.action_size(), inputs = networks_.actor.inputs();
  own.resize(static_cast<std::size_t>(decision.envs * inputs));
  for (int i = 0; i < agents_; ++i) {
    const Trained& actor = actors_[static_cast<std::size_t>(i)];
    for (int e = 0; e < decision.envs; ++e) {
      std::copy_n(decision.observations + static_cast<std::ptrdiff_t>(e * agents_ + i) * inputs,
                  inputs, own.data() + static_cast<std::ptrdiff_t>(e) * inputs);
    }
    const float* mean = acting.Evaluate(actor.numbers.data(), rollouts_.scales().observations,
                                        own.data(), decision.envs);
    for (int e = 0; e < decision.envs; ++e) {
      const int row = e * agents_ + i;
      std::copy_n(mean + static_cast<std::ptrdiff_t>(e) * size, size,
                  out.actions + static_cast<std::ptrdiff_t>(row) * size);
      if (decision.explore != nullptr) {
        networks_.Explore(actor, *decision.explore, agents_, row, out);
      }
    }
  }
}

void Happo::DrawOrder() {
  std::iota(order_.begin(), order_.end(), 0);
  Random random(seed_, Stream::kShuffle, collection_, 0, kOrderDraw);
  for (std::size_t i = order_.size() - 1; i > 0; --i) {
    const auto j = static_cast<std::size_t>(random.Uniform() * static_cast<double>(i + 1));
    std::swap(order_[i], order_[j]);
  }
}

UpdateReport Happo::Update(const UpdateContext& context) {
  const double explained_variance = rollouts_.Estimate(critic_.numbers.data());
  update_.Begin(rollouts_.buffers(), rollouts_.scales(), collection_, context);
  ratio_.Begin(rollouts_.buffers());
  DrawOrder();
  std::uint32_t first_epoch = 0;
  for (const int auv : order_) {
    Trained& actor = actors_[static_cast<std::size_t>(auv)];
    update_.TrainActor({auv, 1}, first_epoch, config_.sequential ? &ratio_.factors() : nullptr,
                       &actor);
    ratio_.Multiply(auv, actor);
    first_epoch += kEpochsOfATurn;
  }
  update_.TrainCritic(config_.epochs, first_epoch, &critic_);
  rollouts_.UpdateInputScales();

  std::vector<const Trained*> actors;
  for (const Trained& actor : actors_) actors.push_back(&actor);
  UpdateReport report = update_.Report(explained_variance, actors);
  report.values.push_back(ratio_.Miss());
  report.flops +=
      2.0 * update_.samples().size() * agents_ * networks_.actor.mean().spec().forward_products();
  return report;
}

std::vector<ReportColumn> Happo::Columns() const {
  std::vector<ReportColumn> columns = PpoColumns();
  columns.push_back({"joint_ratio_miss", "|M-1|", 3});
  return columns;
}

std::vector<NetworkSize> Happo::Sizes() const {
  std::vector<NetworkSize> sizes;
  for (std::size_t i = 0; i < actors_.size(); ++i) {
    sizes.push_back({ActorName(i), actors_[i].numbers.size()});
  }
  sizes.push_back({"critic", critic_.numbers.size()});
  return sizes;
}

void Happo::Save(Archive* archive) const {
  for (std::size_t i = 0; i < actors_.size(); ++i) actors_[i].Save(ActorName(i), archive);
  critic_.Save("critic", archive);
  rollouts_.normalisers().Save(archive);
}

void Happo::Load(const Archive& archive) {
  std::vector<Trained> actors = actors_;
  Trained critic = critic_;
  for (std::size_t i = 0; i < actors.size(); ++i) actors[i].Load(ActorName(i), archive);
  if (archive.Has(ActorName(actors.size()))) {
    throw UserError("there are actors for more than " + std::to_string(actors.size()) + " AUVs");
  }
  critic.Load("critic", archive);
  rollouts_.normalisers().Load(archive);
  actors_ = std::move(actors);
  critic_ = std::move(critic);
}

void Happo::StartFrom(const Archive& archive) {
  std::vector<Trained> actors = actors_;
  for (std::size_t i = 0; i < actors.size(); ++i) {
    const std::vector<float>& theirs = archive.Floats(ActorName(i), actors[i].numbers.size());
    std::copy_n(theirs.begin(), networks_.actor.log_std_offset(), actors[i].numbers.begin());
  }
  const std::vector<float>& critic = archive.Floats("critic", critic_.numbers.size());
  rollouts_.normalisers().Load(archive);
  actors_ = std::move(actors);
  critic_.numbers = critic;
}

std::vector<agent::Policy> Happo::Policies(const agent::PolicyMetadata& metadata) const {
  std::vector<agent::Policy> policies;
  for (std::size_t i = 0; i < actors_.size(); ++i) {
    agent::PolicyMetadata own = metadata;
    own.id += "-auv" + std::to_string(i);
    policies.push_back(
        networks_.actor.ToPolicy(actors_[i].numbers.data(), rollouts_.scales().observations, own));
  }
  return policies;
}

}  // namespace stg::learn
