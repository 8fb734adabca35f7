#pragma once

#include <string>
#include <vector>

#include "auv_common/config/field.hpp"

namespace stg::nodes {

/// Reads private parameters into the options of a training. They have the names of the options,
/// with _ instead of -. Throws UserError for another type. The ranges are checked with the rest of
/// the configuration.
/// @param except options that are not read here
/// Returns the options that are set.
std::vector<std::string> LoadTrainParameters(const config::Table& options,
                                             const std::vector<std::string>& except = {});

/// Throws UserError if one of these options, with the names of the command line, is a private
/// parameter. @param why it has no effect
void RefuseTrainParameters(const std::vector<std::string>& options, const std::string& why);

/// The bags to train on: a list of texts, or one text with names separated by spaces.
std::vector<std::string> LoadBagNames();

}  // namespace stg::nodes
