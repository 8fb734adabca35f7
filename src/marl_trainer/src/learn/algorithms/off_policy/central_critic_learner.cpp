#include "marl_trainer/learn/algorithms/off_policy/central_critic_learner.hpp"

#include <algorithm>
#include <array>
#include <string>

namespace stg::learn {

CentralCriticLearner::CentralCriticLearner(const ReplayOptions& options, const NetworkSpec& actor,
                                           int critics, const TrainConfig& common,
                                           const Problem& problem, const Team& team)
    : ReplayLearner(options, common, problem, team),
      actor_(actor),
      critics_(problem, options, critics, common.seed),
      actor_parameters_(actor_.parameters()),
      actor_adam_(actor_.parameters()),
      critic_adam_(critics_.parameters().size()),
      actor_gradient_(actor_.parameters(), team),
      critic_gradient_(critics_.parameters().size(), team),
      acting_(PassesOf(actor_, team.pool->workers())) {
  InitialiseOrthogonally(actor_.spec(), common.seed, 0, actor_parameters_.data());
  Keep("actor", &actor_parameters_);
  Keep("critics", &critics_.parameters());
  Keep("target_critics", &critics_.targets());
  Keep("actor_adam", &actor_adam_);
  Keep("critic_adam", &critic_adam_);
}

void CentralCriticLearner::TrainCritics(const StepContext& step) {
  std::array<Sums, kGroups> parts{};
  critic_gradient_.ComputeEqual(base().batch, [&](int slice, int, int, int, float* gradient) {
    AddCriticGradient(step, slice, gradient, &parts[static_cast<std::size_t>(slice)]);
  });
  const Adam adam(base().adam_eps, &critic_adam_);
  critic_norm_ +=
      critic_gradient_.Apply(adam, 0, critics_.parameters().size(), base().critic_lr * step.rate,
                             base().grad_clip, critics_.parameters().data());
  for (const Sums& part : OfAllSlices(parts)) sums_.squares += part.squares / base().batch;
  rate_ = step.rate;
}

CentralCriticLearner::Sums CentralCriticLearner::TrainActor(const StepContext& step) {
  std::array<Sums, kGroups> parts{};
  actor_gradient_.ComputeEqual(base().batch, [&](int slice, int, int, int, float* gradient) {
    AddActorGradient(step, slice, gradient, &parts[static_cast<std::size_t>(slice)]);
  });
  const Adam adam(base().adam_eps, &actor_adam_);
  actor_norm_ += actor_gradient_.Apply(adam, 0, actor_.parameters(), base().lr * step.rate,
                                       base().grad_clip, actor_parameters_.data());
  Sums means;
  for (const Sums& part : OfAllSlices(parts)) {
    means.value += part.value;
    means.entropy += part.entropy;
  }
  means.value /= base().batch;
  means.entropy /= base().batch * problem().agents;
  sums_.value += means.value;
  sums_.entropy += means.entropy;
  ++actor_steps_;
  return means;
}

CentralCriticLearner::Means CentralCriticLearner::TakeMeans(int steps) {
  const double critic = std::max(steps, 1), actor = std::max(actor_steps_, 1);
  const Means means = {base().lr * rate_,
                       sums_.squares / critic,
                       static_cast<double>(scales().reward_std) * (sums_.value / actor) +
                           static_cast<double>(scales().value_mean),
                       sums_.entropy / actor,
                       actor_norm_ / actor,
                       critic_norm_ / critic,
                       actor_steps_};
  sums_ = Sums();
  actor_norm_ = critic_norm_ = 0.0;
  actor_steps_ = 0;
  return means;
}

double CentralCriticLearner::Flops(int critic_steps, int actor_steps) const {
  const Products products = ProductsPerSample();
  return 2.0 * base().batch * (critic_steps * products.critics + actor_steps * products.actor);
}

UpdateReport CentralCriticLearner::Report(int steps) {
  const Means means = TakeMeans(steps);
  return {
      {means.learning_rate, means.critic_loss, means.value, means.actor_norm, means.critic_norm},
      Flops(steps, means.actor_steps)};
}

std::vector<ReportColumn> CentralCriticLearner::Columns() const {
  return {{"learning_rate", "", 0},
          {"critic_loss", "TD", 5},
          {"value", "Q", 2},
          {"actor_gradient_norm", "|dA|", 4},
          {"critic_gradient_norm", "", 0}};
}

std::vector<NetworkSize> CentralCriticLearner::Sizes() const {
  std::vector<NetworkSize> sizes = {{"actor", actor_.parameters()}};
  for (int k = 0; k < critics_.count(); ++k) {
    sizes.push_back({critics_.count() == 1 ? "critic" : "critic_" + std::to_string(k),
                     critics_.network().parameters()});
  }
  return sizes;
}

}  // namespace stg::learn
