#include "auv_common/error.hpp"
#include "mpi.hpp"
#include "started_by_mpi.hpp"

namespace stg::learn {

std::unique_ptr<Communicator> JoinRanks(int*, char***) {
  if (StartedByMpi()) {
    throw UserError(
        "started by mpirun or srun, but built without MPI: install libopenmpi-dev and build again");
  }
  return std::make_unique<OneRank>();
}

void AbortRanks(int) {}

}  // namespace stg::learn
