#pragma once

#include <cstddef>
#include <vector>

#include "marl_trainer/learn/comm/communicator.hpp"
#include "marl_trainer/learn/nn/normaliser.hpp"

namespace stg::learn {

/// The moments of all ranks, one rank's after the other's.
/// @param own of this rank's shards, one at least: so many kinds of each shard in turn, of sizes
/// that are the same in every rank.
std::vector<RunningMoments> OfAllRanks(Communicator* ranks, const std::vector<RunningMoments>& own,
                                       std::size_t kinds);

}  // namespace stg::learn
