#pragma once

#include "marl_trainer/learn/algorithms/mappo/mappo_config.hpp"
#include "marl_trainer/learn/train_config.hpp"

namespace stg::learn {

/// The options of MAPPO in a setup.
inline MappoConfig& Own(TrainSetup& setup) { return dynamic_cast<MappoConfig&>(*setup.own); }

}  // namespace stg::learn
