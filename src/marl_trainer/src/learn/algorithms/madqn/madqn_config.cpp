#include "marl_trainer/learn/algorithms/madqn/madqn_config.hpp"

#include <algorithm>
#include <cmath>

#include "marl_trainer/learn/algorithms/madqn/madqn.hpp"

namespace stg::learn {

void MadqnConfig::Describe(OptionTable* t) {
  ReplayConfig::Describe(t);
  t->Add("bins", &bins, {2, 65}, "values that each action dimension can take");
  t->Add("bin-power", &bin_power, {0.1, 10},
         "how they lie in [-1, 1]: x^power of evenly spaced x; above 1, finer around zero");
  t->Add("heads", &heads, {"separate", "joint", "book"},
         "separate: a value for each bin of each dimension; joint: one for each of the "
         "bins^dimensions combinations; book: one for each of the bins^3 combinations of three "
         "dimensions, which the other three repeat, the release's codebook of forces and moments");
  t->Add("reward", &reward, {"team", "own"},
         "what an AUV learns from: team (the mean over AUVs) or own (its share of it)");
  epsilon.Describe("epsilon", 1.0, "share of random choices", t);
}

void MadqnConfig::ApplyPreset(const std::string& preset, TrainConfig* common) {
  ReplayConfig::ApplyPreset(preset, common);
  if (preset == "paper") heads = "book";
}

std::unique_ptr<Algorithm> MadqnConfig::Make(const TrainConfig& common, const Problem& problem,
                                             const Team& team) const {
  const int free =
      heads == "book" ? std::min(problem.action_size, kBookDimensions) : problem.action_size;
  RequireOption(heads == "separate" || std::pow(bins, free) <= 1000.0, "heads",
                heads + " has more than 1000 combinations of " + std::to_string(bins) +
                    " bins in " + std::to_string(free) + " dimensions");
  return std::make_unique<Madqn>(*this, *this, common, problem, team);
}

}  // namespace stg::learn
