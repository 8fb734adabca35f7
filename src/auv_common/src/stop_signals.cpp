#include "auv_common/stop_signals.hpp"

#include <csignal>

namespace stg {
namespace {

std::atomic<int> stop_signal{0};

/// The first signal asks for a clean end, and the second one kills the program. SIGHUP is an
/// exception: when a terminal closes, the terminal and its shell both send it.
extern "C" void OnStopSignal(int signal) {
  stop_signal = signal;
  if (signal == SIGHUP) return;
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

}  // namespace

const std::atomic<int>& HeedStopSignals() {
  std::signal(SIGINT, OnStopSignal);
  std::signal(SIGTERM, OnStopSignal);
  std::signal(SIGUSR1, OnStopSignal);
  struct sigaction before {};
  sigaction(SIGHUP, nullptr, &before);
  if (before.sa_handler != SIG_IGN) std::signal(SIGHUP, OnStopSignal);
  return stop_signal;
}

}  // namespace stg
