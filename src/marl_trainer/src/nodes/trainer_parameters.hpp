#pragma once

#include <string>
#include <vector>

#include "marl_trainer/learn/train_config.hpp"

namespace stg::nodes {

/// Reads private parameters named as the options of `train`, with _ for -, over the given defaults.
/// Throws UserError for another type; ranges are checked with the rest of the configuration.
void LoadTrainParameters(learn::TrainSetup* setup);

/// The bags to train on: a list of texts, or one text with names separated by spaces.
std::vector<std::string> LoadBagNames();

}  // namespace stg::nodes
