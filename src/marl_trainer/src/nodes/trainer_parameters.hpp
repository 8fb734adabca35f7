#pragma once

#include <string>
#include <vector>

#include "marl_trainer/learn/train_config.hpp"

namespace stg::nodes {

/// Private parameters named as the options of `train`, with _ for -, over the given defaults.
/// Throws UserError for another type; ranges are checked with the rest of the configuration.
learn::TrainConfig LoadTrainParameters(const learn::TrainConfig& defaults);

/// The bags to train on: a list of texts, or one text with names separated by spaces.
std::vector<std::string> LoadBagNames();

}  // namespace stg::nodes
