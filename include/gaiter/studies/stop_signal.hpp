// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <csignal>

namespace gaiter::studies {

// While it lives, SIGTERM and SIGINT (what batch systems and Ctrl-C send) are noted instead of ending the
// program. The second one of a kind ends it as usual.
class StopSignal {
 public:
  StopSignal();
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  int received() const;  // the signal's number, 0: none

 private:
  struct sigaction terminate_before_, interrupt_before_;
};

}  // namespace gaiter::studies
