#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "stg_env/env/decide.hpp"

namespace stg::env {

/// Runs episodes as Evaluate does, with the same results, and writes into `folder`, which is
/// created if necessary: `recording.stgv`, the messages of all episodes one after the other (see
/// Message), and `packets.csv`, the log of the same packets (see acoustics::PacketLog). The times
/// of an episode continue those of the previous one. The state after an episode's last decision is
/// not recorded. Throws UserError if a file cannot be written.
/// @param scene the fixed parts, see SceneOf, and `condition`, which the page shows
/// @param seed of episode 0
/// @param flown number of episodes of the evaluation
/// @param recorded number of recorded episodes, the first ones
void RecordEpisodes(const EnvFactory& make_env, const nlohmann::json& scene,
                    const agent::Decider& controller, std::uint64_t seed, int flown, int recorded,
                    const std::string& folder);

}  // namespace stg::env
