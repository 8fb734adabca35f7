#pragma once

#include "marl_trainer/learn/algorithms/mappo/mappo_config.hpp"
#include "marl_trainer/learn/train_config.hpp"

namespace stg::learn {

/// MAPPO's own part of a setup.
inline MappoConfig& Own(TrainSetup& setup) { return dynamic_cast<MappoConfig&>(*setup.own); }

}  // namespace stg::learn
