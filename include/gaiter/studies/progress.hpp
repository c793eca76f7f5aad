// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "gaiter/studies/option_table.hpp"

namespace gaiter::studies {

// Tells on stderr how far a sweep is. On one rank only.
class ProgressReport {
 public:
  // `mode`: automatic is a line on a terminal, a log elsewhere. `before`: designs that earlier runs solved.
  ProgressReport(Progress mode, std::int64_t designs, std::int64_t before);
  ~ProgressReport();  // ends the line, if one was written
  ProgressReport(const ProgressReport&) = delete;
  ProgressReport& operator=(const ProgressReport&) = delete;

  bool due() const;  // a report now would be shown
  void show(std::int64_t done, std::int64_t failed);

 private:
  using Clock = std::chrono::steady_clock;

  Progress mode_;
  std::int64_t designs_, before_;
  Clock::time_point start_ = Clock::now(), next_;
  std::chrono::duration<double> interval_;
  std::size_t shown_ = 0;  // letters of the line as it stands
};

// "1.2e6 of 1e7 designs, 52000/s, 2 min 49 s left, 3 failed". `done` are those of this run.
std::string progress_text(std::int64_t designs, std::int64_t before, std::int64_t done, std::int64_t failed,
                          double seconds);

}  // namespace gaiter::studies
