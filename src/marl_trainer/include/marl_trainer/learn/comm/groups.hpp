#pragma once

#include <cstdint>

#include "marl_trainer/learn/comm/communicator.hpp"

namespace stg::learn {

/// Number of parts into which work is divided. Their results are added in one fixed order, wherever
/// they were computed. So results depend neither on the number of workers nor on the number of
/// ranks.
inline constexpr int kGroups = 16;

/// A rank's share of the groups. There are kGroups groups. With more ranks than kGroups, there is
/// one group for each rank.
struct GroupShare {
  int groups = kGroups;            ///< number of groups of all ranks
  int first = 0, count = kGroups;  ///< this rank's groups

  static GroupShare Of(const Communicator& ranks);

  /// A group has whole blocks of this number of environments, which fill the registers of the
  /// simulator. If there are few environments, some groups have none.
  static constexpr int kBlock = 4;
  /// The environments of a group, among `envs`, are FirstEnv(g) to FirstEnv(g + 1) - 1.
  int FirstEnv(int group, int envs) const {
    if (group == groups) return envs;
    return static_cast<int>(static_cast<std::int64_t>(envs) * group / groups) / kBlock * kBlock;
  }
};

}  // namespace stg::learn
