#include "marl_trainer/learn/algorithms/masac/masac_config.hpp"

#include <string>
#include <vector>

#include "marl_trainer/learn/algorithms/masac/masac.hpp"

namespace stg::learn {

void MasacConfig::Describe(config::Table* t) {
  ReplayConfig::Describe(t);
  DescribeCritics(t);
  t->Add("initial-alpha", &initial_alpha, {1e-9, 1e3}, "-",
         "weight of the entropy at the start, for rewards with the standard deviation 1 - gamma");
  t->Add("alpha-lr", &alpha_lr, {0, 1}, "-",
         "Adam's learning rate of the logarithm of this weight; 0: the weight is fixed");
  t->Add("target-entropy", &target_entropy, {-20, 1}, "-",
         "entropy that the weight is adjusted to, per AUV and action dimension in [-1, 1]");
  t->Own("target-entropy",
         {"weight of the entropy", {"adjusted"}, "alpha-lr", [this] {
            return std::vector<std::string>{alpha_lr > 0.0 ? "adjusted" : "fixed"};
          }});
  t->Add("min-log-std", &min_log_std, {-20, 2}, "-", "lower bound of log sigma before the squash");
  t->Add("max-log-std", &max_log_std, {-20, 2}, "-", "upper bound of log sigma before the squash");
}

void MasacConfig::ApplyPreset(const std::string& preset, TrainConfig* common) {
  ReplayConfig::ApplyPreset(preset, common);
  if (preset != "paper") return;
  initial_alpha = 0.01;
  target_entropy = -1.0;
}

void MasacConfig::ValidateOrThrow(const TrainConfig& common) const {
  ReplayConfig::ValidateOrThrow(common);
  RequireOption(min_log_std < max_log_std, "max-log-std", "must be above --min-log-std");
}

std::unique_ptr<Algorithm> MasacConfig::Make(const TrainConfig& common, const Problem& problem,
                                             const Team& team) const {
  return std::make_unique<Masac>(*this, *this, common, problem, team);
}

}  // namespace stg::learn
