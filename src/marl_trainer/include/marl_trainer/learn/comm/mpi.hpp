#pragma once

#include <memory>

#include "marl_trainer/learn/comm/communicator.hpp"

namespace stg::learn {

/// The ranks that mpirun, srun or an operator of theirs has started this process among; OneRank
/// where none of them did. Throws UserError where one of them did and this program was built
/// without MPI.
std::unique_ptr<Communicator> JoinRanks(int* argc, char*** argv);

/// Ends all ranks at once; returns where there are none.
void AbortRanks(int status);

}  // namespace stg::learn
