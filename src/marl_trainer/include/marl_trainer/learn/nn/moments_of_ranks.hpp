#pragma once

#include <cstddef>
#include <vector>

#include "marl_trainer/learn/comm/communicator.hpp"
#include "marl_trainer/learn/nn/normaliser.hpp"

namespace stg::learn {

/// The moments of all ranks, in the order of the ranks.
/// @param own moments of this rank's shards, at least one: `kinds` moments of each shard in turn.
/// Their sizes are the same in every rank.
std::vector<RunningMoments> OfAllRanks(Communicator* ranks, const std::vector<RunningMoments>& own,
                                       std::size_t kinds);

}  // namespace stg::learn
