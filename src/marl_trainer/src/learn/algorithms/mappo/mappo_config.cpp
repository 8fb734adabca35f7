#include "marl_trainer/learn/algorithms/mappo/mappo_config.hpp"

#include "marl_trainer/learn/algorithms/mappo/mappo.hpp"
#include "marl_trainer/learn/nn/wall_units.hpp"
#include "marl_trainer/learn/train_config.hpp"

namespace stg::learn {

void MappoConfig::Describe(config::Table* t) {
  PpoConfig::Describe(t);
  t->Add("wall-units", &wall_units, {0, 1e3}, "-",
         "with --start-from and relu: 24 units of the actor's first layer restart as hinges on the "
         "target's distance to each wall, at 1/2, 1, 2 and 4 times this margin [m]; 0: none");
}

void MappoConfig::ValidateOrThrow(const TrainConfig& common) const {
  PpoConfig::ValidateOrThrow(common);
  RequireOption(wall_units == 0.0 || !common.start_from.empty(), "wall-units",
                "needs the normalisers of another run: --start-from");
  RequireOption(
      wall_units == 0.0 || (activation == HiddenActivation::kRelu && actor_hidden[0] >= kWallUnits),
      "wall-units", "needs --activation relu and 24 units in the actor's first layer");
}

std::unique_ptr<Algorithm> MappoConfig::Make(const TrainConfig& common, const Problem& problem,
                                             const Team& team) const {
  return std::make_unique<Mappo>(*this, common, problem, team);
}

}  // namespace stg::learn
