#include "marl_trainer/learn/algorithms/madqn/madqn_config.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "marl_trainer/learn/algorithms/madqn/madqn.hpp"

namespace stg::learn {

void MadqnConfig::Describe(config::Table* t) {
  ReplayConfig::Describe(t);
  t->Add("bins", &bins, {2, 65}, "-", "number of values that each action dimension can take");
  t->Add("bin-power", &bin_power, {0.1, 10}, "-",
         "spacing of the bins in [-1, 1]: x^power of evenly spaced x; above 1, the bins are finer "
         "around zero");
  t->Own("bin-power",
         {"bins", {"more than three"}, "bins", [this] {
            return std::vector<std::string>{bins > 3 ? "more than three" : "three or fewer"};
          }});
  t->Add("heads", config::Enum(&heads, {"separate", "joint", "book"}), config::kNone, "-",
         "outputs of the network. separate: a value for each bin of each dimension; joint: a value "
         "for each of the bins^dimensions combinations; book: a value for each of the bins^3 "
         "combinations of the first three dimensions, which the other three repeat (the release's "
         "codebook of forces and moments)");
  t->Add("reward", config::Enum(&reward, {"team", "own"}), config::kNone, "-",
         "reward from which an AUV learns: team (the mean over AUVs) or own (its own part)");
  epsilon.Describe("epsilon", 1.0, "share of random choices", t);
}

void MadqnConfig::ApplyPreset(const std::string& preset, TrainConfig* common) {
  ReplayConfig::ApplyPreset(preset, common);
  if (preset == "paper") heads = QHeads::kBook;
}

void MadqnConfig::ValidateOrThrow(const TrainConfig& common) const {
  ReplayConfig::ValidateOrThrow(common);
  epsilon.ValidateOrThrow("epsilon");
}

std::unique_ptr<Algorithm> MadqnConfig::Make(const TrainConfig& common, const Problem& problem,
                                             const Team& team) const {
  const int free =
      heads == QHeads::kBook ? std::min(problem.action_size, kBookDimensions) : problem.action_size;
  RequireOption(heads == QHeads::kSeparate || std::pow(bins, free) <= 1000.0, "heads",
                "there are more than 1000 combinations of " + std::to_string(bins) + " bins in " +
                    std::to_string(free) + " dimensions");
  return std::make_unique<Madqn>(*this, *this, common, problem, team);
}

}  // namespace stg::learn
