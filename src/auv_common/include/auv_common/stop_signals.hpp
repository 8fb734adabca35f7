#pragma once

#include <atomic>

namespace stg {

/// Exit status of a program that saved its work and ended after any of the signals below.
inline constexpr int kStopped = 130;

/// Makes the program end by itself after these signals: Ctrl-C (SIGINT), SIGTERM, SIGUSR1 (passed
/// on by SLURM and mpirun) and a closed terminal (SIGHUP). A second SIGINT or SIGTERM ends it at
/// once. A SIGHUP that is ignored already, as under nohup, stays ignored.
/// @return the last signal, 0 if there was none; the same object in all calls.
const std::atomic<int>& HeedStopSignals();

}  // namespace stg
