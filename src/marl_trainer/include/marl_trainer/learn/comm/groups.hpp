#pragma once

#include <cstdint>

#include "marl_trainer/learn/comm/communicator.hpp"

namespace stg::learn {

/// Work is cut into so many parts, whose results are added up in one fixed order, wherever they
/// come from. So results depend neither on the number of workers nor on that of ranks.
inline constexpr int kGroups = 16;

/// The share of the groups that a rank has. There are kGroups, or one for each rank where there are
/// more ranks than that.
struct GroupShare {
  int groups = kGroups;            ///< of all ranks
  int first = 0, count = kGroups;  ///< this rank's

  static GroupShare Of(const Communicator& ranks);

  /// A group has whole blocks of so many environments, which fill the registers of the simulator;
  /// where there are few environments, some groups have none.
  static constexpr int kBlock = 4;
  /// Environments of a group among `envs`: from FirstEnv(g) to FirstEnv(g + 1) - 1.
  int FirstEnv(int group, int envs) const {
    if (group == groups) return envs;
    return static_cast<int>(static_cast<std::int64_t>(envs) * group / groups) / kBlock * kBlock;
  }
};

}  // namespace stg::learn
