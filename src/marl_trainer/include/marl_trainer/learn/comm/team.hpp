#pragma once

#include "auv_common/parallel/worker_pool.hpp"
#include "marl_trainer/learn/comm/groups.hpp"

namespace stg::learn {

/// Resources of a training: the threads of this process, and the ranks that train together. Both
/// must outlive the team.
struct Team {
  // Not explicit, because a pool alone is a team: a process that trains alone.
  // NOLINTNEXTLINE(google-explicit-constructor)
  Team(WorkerPool* own_pool, Communicator* all_ranks = Alone())
      : pool(own_pool), ranks(all_ranks) {}

  GroupShare share() const { return GroupShare::Of(*ranks); }

  WorkerPool* pool;
  Communicator* ranks;
};

}  // namespace stg::learn
