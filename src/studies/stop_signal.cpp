// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/stop_signal.hpp"

namespace gaiter::studies {

namespace {

volatile std::sig_atomic_t noted = 0;

extern "C" void note_signal(int signal) {
  noted = signal;
}

}  // namespace

StopSignal::StopSignal() {
  noted = 0;
  struct sigaction action = {};
  action.sa_handler = note_signal;
  action.sa_flags = SA_RESTART | static_cast<int>(SA_RESETHAND);
  sigemptyset(&action.sa_mask);
  sigaction(SIGTERM, &action, &terminate_before_);
  sigaction(SIGINT, &action, &interrupt_before_);
}

StopSignal::~StopSignal() {
  sigaction(SIGTERM, &terminate_before_, nullptr);
  sigaction(SIGINT, &interrupt_before_, nullptr);
}

int StopSignal::received() const {
  return noted;
}

}  // namespace gaiter::studies
