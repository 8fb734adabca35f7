#pragma once

#include "auv_common/parallel/worker_pool.hpp"
#include "marl_trainer/learn/comm/groups.hpp"

namespace stg::learn {

/// What computes a training: the threads of this process, and the ranks that train together. Both
/// outlive the team.
struct Team {
  // A pool is a whole team: that of a process that trains by itself.
  // NOLINTNEXTLINE(google-explicit-constructor)
  Team(WorkerPool* own_pool, Communicator* all_ranks = Alone())
      : pool(own_pool), ranks(all_ranks) {}

  GroupShare share() const { return GroupShare::Of(*ranks); }

  WorkerPool* pool;
  Communicator* ranks;
};

}  // namespace stg::learn
