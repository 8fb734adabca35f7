#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "marl_trainer/learn/recorded/recorded.hpp"

namespace stg::nodes {

/// Content of one bag for the trainer.
struct BagContents {
  std::vector<learn::RecordedEpisode> episodes;  ///< not yet checked
  /// Messages of another type, or of an AUV that the scenario does not have.
  std::uint64_t foreign_messages = 0;
  std::string error;  ///< reason why the bag, or a part of it, could not be used
};

/// Reads the agent steps, rewards and scenario of a bag. Never throws for the content of a bag: a
/// damaged bag gives the episodes before the damage and an error, and a bag of another scenario
/// gives only an error.
/// @param scenario of this training, as ToYaml writes it
BagContents ReadBag(const std::string& path, const RunConfig& run, const std::string& scenario);

/// The bags for `names`: files, and all *.bag in folders, sorted by name. Throws UserError for a
/// name that does not exist or a folder without bags.
std::vector<std::string> FindBags(const std::vector<std::string>& names);

}  // namespace stg::nodes
