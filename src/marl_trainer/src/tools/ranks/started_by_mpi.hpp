#pragma once

#include <cstdlib>

namespace stg::learn {

/// True if mpirun or srun has started this process: Open MPI's launcher, or one that uses PMIx
/// (SLURM) or PMI.
inline bool StartedByMpi() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK"}) {
    if (std::getenv(name) != nullptr) return true;
  }
  return false;
}

}  // namespace stg::learn
