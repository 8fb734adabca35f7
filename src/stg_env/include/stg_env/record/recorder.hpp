#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "stg_env/env/decide.hpp"

namespace stg::env {

/// Flies episodes as Evaluate flies them, with the same results, and writes into `folder`, which is
/// made if need be: `recording.stgv`, the messages of all episodes one after the other (see
/// Message), and `packets.csv`, the log of the same packets (see acoustics::PacketLog). Times of an
/// episode go on where those of the one before ended. The state after an episode's last decision is
/// not part of it. Throws UserError for what cannot be written.
/// @param scene what stands still, see SceneOf, and `condition`, which the page names
/// @param seed of episode 0
/// @param flown how many episodes the evaluation has
/// @param recorded how many of them are recorded, the first ones
void RecordEpisodes(const EnvFactory& make_env, const nlohmann::json& scene,
                    const agent::Decider& controller, std::uint64_t seed, int flown, int recorded,
                    const std::string& folder);

}  // namespace stg::env
