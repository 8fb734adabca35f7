#pragma once

#include <memory>

#include "marl_trainer/learn/comm/communicator.hpp"

namespace stg::learn {

/// The ranks among which mpirun, srun or a similar launcher has started this process; OneRank if
/// there is no such launcher. Throws UserError if there is one but this program was built without
/// MPI.
std::unique_ptr<Communicator> JoinRanks(int* argc, char*** argv);

/// Ends all ranks at once. Returns if there are no ranks.
void AbortRanks(int status);

}  // namespace stg::learn
