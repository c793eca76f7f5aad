// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace gaiter::studies {

namespace {

using Seconds = std::chrono::duration<double>;

constexpr Seconds line_interval{0.5}, first_log{10}, last_log{600};

std::string duration(double seconds) {
  const auto whole = static_cast<std::int64_t>(std::ceil(seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

}  // namespace

std::string progress_text(std::int64_t designs, std::int64_t before, std::int64_t done, std::int64_t failed,
                          double seconds) {
  const double rate = seconds > 0 ? static_cast<double>(done) / seconds : 0;
  const std::int64_t left = designs - before - done;
  std::string text = fmt::format("{} of {} designs", before + done, designs);
  if (rate > 0) text += fmt::format(", {:.3g}/s, {} left", rate, duration(static_cast<double>(left) / rate));
  if (failed > 0) text += fmt::format(", {} failed", failed);
  return text;
}

ProgressReport::ProgressReport(Progress mode, std::int64_t designs, std::int64_t before)
    : mode_(mode), designs_(designs), before_(before) {
  if (mode_ == Progress::automatic) mode_ = isatty(STDERR_FILENO) ? Progress::line : Progress::log;
  interval_ = mode_ == Progress::line ? line_interval : first_log;
  next_ = start_ + std::chrono::duration_cast<Clock::duration>(interval_);
}

ProgressReport::~ProgressReport() {
  if (shown_ > 0) std::fputc('\n', stderr);
}

bool ProgressReport::due() const {
  return mode_ != Progress::off && Clock::now() >= next_;
}

void ProgressReport::show(std::int64_t done, std::int64_t failed) {
  const Seconds since = Clock::now() - start_;
  const std::string text = progress_text(designs_, before_, done, failed, since.count());
  if (mode_ == Progress::line) {
    // What is left of a longer line is wiped out by blanks.
    std::fprintf(stderr, "\r%-*s", static_cast<int>(shown_), text.c_str());
    shown_ = text.size();
  } else {
    std::fprintf(stderr, "gaiter: %s\n", text.c_str());
    interval_ = std::min(2 * interval_, Seconds(last_log));
  }
  std::fflush(stderr);
  next_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(interval_);
}

}  // namespace gaiter::studies
