#pragma once

#include <atomic>

namespace stg {

/// The exit status of a program that saved and ended because it was asked to, by whichever signal.
inline constexpr int kStopped = 130;

/// From now on signals ask the program to end by itself, instead of ending it: Ctrl-C (SIGINT),
/// SIGTERM, SIGUSR1 (what SLURM and mpirun pass on) and a closed terminal (SIGHUP). A second SIGINT
/// or SIGTERM ends it at once. A hangup that is ignored, as nohup has it, stays so.
/// @return the signal that came last, 0 before any; the same object in all calls.
const std::atomic<int>& HeedStopSignals();

}  // namespace stg
