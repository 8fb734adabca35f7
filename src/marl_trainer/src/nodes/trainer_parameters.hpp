#pragma once

#include <string>
#include <vector>

#include "marl_trainer/learn/train_config.hpp"

namespace stg::nodes {

/// Reads private parameters into the setup. They have the names of the options of `train`, with _
/// instead of -. Throws UserError for another type. The ranges are checked with the rest of the
/// configuration.
void LoadTrainParameters(learn::TrainSetup* setup);

/// The bags to train on: a list of texts, or one text with names separated by spaces.
std::vector<std::string> LoadBagNames();

}  // namespace stg::nodes
