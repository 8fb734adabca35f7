#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "marl_trainer/learn/recorded/recorded.hpp"

namespace stg::nodes {

/// What one bag holds for the trainer.
struct BagContents {
  std::vector<learn::RecordedEpisode> episodes;  ///< not yet checked
  std::uint64_t foreign_messages = 0;            ///< of another type or of an AUV that is not there
  std::string error;                             ///< why the bag, or its rest, could not be used
};

/// @param scenario of this training, as ToYaml writes it
/// Reads agent steps, rewards and the scenario of a bag. Never throws for what a bag holds: a
/// damaged one gives the episodes before the damage and an error, one of another scenario only an
/// error.
BagContents ReadBag(const std::string& path, const RunConfig& run, const std::string& scenario);

/// The bags that `names` mean: files, and all *.bag of folders, by name. Throws UserError for a
/// name that does not exist or a folder without bags.
std::vector<std::string> FindBags(const std::vector<std::string>& names);

}  // namespace stg::nodes
