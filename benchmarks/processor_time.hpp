// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <time.h>

// Of this process [s]: others may run beside it.
inline double processor_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}
