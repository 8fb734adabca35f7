#include "marl_trainer/learn/algorithms/madqn/madqn_config.hpp"

#include <cmath>

#include "marl_trainer/learn/algorithms/madqn/madqn.hpp"

namespace stg::learn {

std::unique_ptr<AlgorithmConfig> MadqnConfig::Clone() const {
  return std::make_unique<MadqnConfig>(*this);
}

void MadqnConfig::Describe(OptionTable* t) {
  ReplayConfig::Describe(t);
  t->Add("bins", &bins, {2, 65}, "values that each action dimension can take");
  t->Add("bin-power", &bin_power, {0.1, 10},
         "how they lie in [-1, 1]: x^power of evenly spaced x; above 1, finer around zero");
  t->Add("heads", &heads,
         "separate: a value for each bin of each dimension; joint: one for each of the "
         "bins^dimensions combinations, the paper's codebook");
  t->Add("epsilon-min", &epsilon_min, {0, 1},
         "share of random choices in the first environment; between it and the last one it grows "
         "by equal factors");
  t->Add("epsilon-max", &epsilon_max, {0, 1}, "share of random choices in the last environment");
}

void MadqnConfig::ApplyPreset(const std::string& preset, TrainConfig* common) {
  ReplayConfig::ApplyPreset(preset, common);
  if (preset == "paper") heads = "joint";
}

void MadqnConfig::ValidateOrThrow(const TrainConfig& common) const {
  ReplayConfig::ValidateOrThrow(common);
  RequireOption(heads == "separate" || heads == "joint", "heads",
                "'" + heads + "' is not separate or joint");
  RequireOption(epsilon_min <= epsilon_max, "epsilon-max", "is below --epsilon-min");
  RequireOption(epsilon_min > 0.0 || epsilon_max == 0.0, "epsilon-min",
                "must not be 0 where --epsilon-max is not");
}

std::unique_ptr<Algorithm> MadqnConfig::Make(const TrainConfig& common, const Problem& problem,
                                             WorkerPool* pool) const {
  RequireOption(heads == "separate" || std::pow(bins, problem.action_size) <= 1000.0, "heads",
                "joint has more than 1000 combinations of " + std::to_string(bins) + " bins in " +
                    std::to_string(problem.action_size) + " dimensions");
  return std::make_unique<Madqn>(*this, *this, common, problem, pool);
}

}  // namespace stg::learn
