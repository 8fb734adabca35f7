#pragma once

#include <cstdint>
#include <string>

#include "stg_env/env/decide.hpp"
#include "stg_env/scenario/scenario.hpp"

namespace stg::env {

/// Flies episodes as Evaluate flies them, with the same results, and writes into `folder`, which is
/// made if need be: `recording.stgv`, the messages of all episodes one after the other (see
/// Message), and `packets.csv`, the log of the same packets (see acoustics::PacketLog). Times of an
/// episode go on where those of the one before ended. The state after an episode's last decision is
/// not part of it. Throws UserError for what cannot be written.
/// @param seed of episode 0
/// @param flown how many episodes the evaluation has
/// @param recorded how many of them are recorded, the first ones
/// @param condition of the scenario, which the page names
void RecordEpisodes(const Scenario& scenario, const agent::Decider& controller, std::uint64_t seed,
                    int flown, int recorded, const std::string& folder,
                    const std::string& condition = "nominal");

}  // namespace stg::env
