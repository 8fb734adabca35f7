#include "auv_common/stop_signals.hpp"

#include <csignal>

namespace stg {
namespace {

std::atomic<int> stop_signal{0};

/// The first signal asks for a clean end, the second one kills; but what closes a terminal tells so
/// more than once, itself and by its shell, and ends the session.
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
