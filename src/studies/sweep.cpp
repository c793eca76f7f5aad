// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/sweep.hpp"

#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <optional>

#include "gaiter/archive/sweep_archive.hpp"
#include "gaiter/petsc/session.hpp"
#include "gaiter/studies/chunk_solver.hpp"
#include "gaiter/studies/progress.hpp"
#include "gaiter/studies/rank_groups.hpp"
#include "gaiter/studies/scene_checks.hpp"
#include "gaiter/studies/solve.hpp"
#include "gaiter/studies/stop_signal.hpp"
#include "gaiter/studies/work_queue.hpp"

namespace gaiter::studies {

namespace {

// How often a rank reports [s]: so seldom that the reports of all do not flood the first.
double report_interval(MPI_Comm comm) {
  return std::max(0.5, 1e-3 * petsc::size(comm));
}

// Time that the processor has given to this thread, or to all threads of the process.
double processor_seconds(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double thread_seconds() {
  return processor_seconds(CLOCK_THREAD_CPUTIME_ID);
}

double process_seconds() {
  return processor_seconds(CLOCK_PROCESS_CPUTIME_ID);
}

archive::Layout layout_of(const Request& request, const Designs& designs) {
  archive::Layout layout{static_cast<std::size_t>(designs.size()), {}, {}, request.columns};
  for (const model::Segment& segment : request.scene.leg.segments) layout.segments.push_back(segment.name);
  for (const SweepAxis& axis : designs.axes())
    layout.swept.push_back({axis.name, std::string(axis.unit()), std::string(axis.option->doc)});
  return layout;
}

// Meshes with the most cells first, so that no rank begins one when the others have nothing left to do.
void largest_first(std::vector<std::size_t>& chunks, const archive::SweepArchive& archive,
                   const Designs& designs, model::Scene scene) {
  if (scene.fidelity != model::Fidelity::axisym) return;
  std::map<std::size_t, double> cells;
  for (const std::size_t chunk : chunks)
    for (std::size_t k = 0; k < archive.cases_in(chunk); ++k)
      if (put_design(designs, static_cast<std::int64_t>(archive.first_case(chunk) + k), scene).empty())
        cells[chunk] += std::pow(4, scene.axisym.refine) * scene.axisym.order * scene.axisym.order;
  std::ranges::stable_sort(chunks, std::greater(), [&](std::size_t chunk) { return cells[chunk]; });
}

// The chunks that are left to do, by this rank's group as long as there are any.
class SweepRun {
 public:
  SweepRun(MPI_Comm comm, const Request& request, const Designs& designs, archive::SweepArchive& archive);
  SweepReport run();

 private:
  std::int64_t next_chunk();
  void solve(std::int64_t item);
  void finish();
  void store(std::size_t chunk, const SolvedChunk& solved);
  void tell();

  MPI_Comm comm_;
  archive::SweepArchive& archive_;
  std::vector<std::size_t> chunks_;  // to do
  SweepReport report_;
  RankGroups groups_;
  ChunkSolver solver_;
  std::optional<WorkQueue> queue_;
  StopSignal signal_;
  std::optional<ProgressReport> progress_;  // on rank 0
  WorkQueue::Done untold_;
  double told_ = MPI_Wtime();
};

SweepRun::SweepRun(MPI_Comm comm, const Request& request, const Designs& designs,
                   archive::SweepArchive& archive)
    : comm_(comm),
      archive_(archive),
      groups_(comm, may_take_axisym(request.scene) ? request.scene.axisym.ranks_per_case : 1),
      solver_(groups_.group, request.scene, designs) {
  for (std::size_t chunk = 0; chunk < archive.chunks(); ++chunk) {
    if (!archive.finished(chunk)) {
      chunks_.push_back(chunk);
      report_.missing += static_cast<std::int64_t>(archive.cases_in(chunk));
    }
  }
  largest_first(chunks_, archive, designs, request.scene);
  report_.taken_up = designs.size() - report_.missing;
  // Slices all cost about the same. The others may differ tenfold.
  const bool even =
      request.scene.fidelity == model::Fidelity::slice || request.scene.fidelity == model::Fidelity::rigid;
  queue_.emplace(comm, static_cast<std::int64_t>(chunks_.size()),
                 even ? WorkQueue::Order::in_turn : WorkQueue::Order::on_demand, groups_.mine, groups_.count);
  if (petsc::rank(comm) == 0 && request.progress != Progress::off)
    progress_.emplace(request.progress, designs.size(), report_.taken_up);
}

// The group's next chunk; -1: none is left, or all are to stop.
std::int64_t SweepRun::next_chunk() {
  // Where all ranks get the signal, as under Slurm, the first to see it tells the others.
  if (const int signal = signal_.received(); signal > 0 && queue_->stopped() == 0) queue_->stop(signal);
  std::int64_t item = -1;
  if (petsc::rank(groups_.group) == 0 && queue_->stopped() == 0) item = queue_->next();
  MPI_Bcast(&item, 1, MPI_INT64_T, 0, groups_.group);
  return item < 0 ? -1 : static_cast<std::int64_t>(chunks_[static_cast<std::size_t>(item)]);
}

void SweepRun::store(std::size_t chunk, const SolvedChunk& solved) {
  const double start = MPI_Wtime();
  archive_.store(chunk, solved.rows, solved.wall_times, solved.swept_values);
  report_.storing += MPI_Wtime() - start;
  const auto designs = static_cast<std::int64_t>(solved.wall_times.size());
  report_.designs += designs;
  report_.equilibria += solved.equilibria;
  untold_.designs += designs;
  untold_.failed += solved.failed;
  tell();
}

void SweepRun::tell() {
  if (MPI_Wtime() - told_ > report_interval(comm_)) {
    queue_->report(untold_);
    untold_ = {};
    told_ = MPI_Wtime();
  }
  if (!progress_ || !progress_->due()) return;
  const WorkQueue::Done done = queue_->done();
  progress_->show(done.designs + untold_.designs, done.failed + untold_.failed);
}

// One chunk, which a rank of the group stores. The other thread, which writes, is part of the archive's time.
void SweepRun::solve(std::int64_t item) {
  const auto chunk = static_cast<std::size_t>(item);
  const double start = MPI_Wtime(), thread = thread_seconds(), process = process_seconds();
  const SolvedChunk& solved =
      solver_.solve(static_cast<std::int64_t>(archive_.first_case(chunk)), archive_.cases_in(chunk));
  report_.solving += MPI_Wtime() - start;
  const double solving = thread_seconds() - thread;
  report_.solving_processor += solving;
  if (petsc::rank(groups_.group) == 0) store(chunk, solved);
  report_.archive_processor += process_seconds() - process - solving;
}

void SweepRun::finish() {
  const double start = MPI_Wtime(), process = process_seconds();
  archive_.finish();
  report_.finishing = MPI_Wtime() - start;
  if (petsc::rank(comm_) == 0) report_.archive_processor += process_seconds() - process;  // the others wait
}

SweepReport SweepRun::run() {
  const double start = MPI_Wtime();
  for (std::int64_t chunk = next_chunk(); chunk >= 0; chunk = next_chunk()) solve(chunk);
  const double flushing = MPI_Wtime();
  archive_.flush();
  const double flushed = MPI_Wtime();
  report_.storing += flushed - flushing;
  report_.missing -= static_cast<std::int64_t>(petsc::sum(comm_, static_cast<double>(report_.designs)));
  report_.waiting_at_the_end = MPI_Wtime() - flushed;
  report_.signal = static_cast<int>(petsc::largest(comm_, queue_->stopped()));
  if (report_.missing == 0) {
    report_.signal = 0;
    finish();
  }
  report_.messages = queue_->messages();
  report_.waiting_for_messages = queue_->waiting();
  report_.seconds = petsc::largest(comm_, MPI_Wtime() - start);
  return report_;
}

}  // namespace

std::size_t chunk_designs(const model::Scene& scene, std::int64_t designs) {
  // An archive takes thousands of chunks, but not hundreds of thousands.
  constexpr std::int64_t most_chunks = 20000;
  struct Size {
    std::int64_t least, most;
  };
  const bool sliding =
      scene.fidelity == model::Fidelity::sliding ||
      (scene.fidelity == model::Fidelity::automatic && scene.goal.up_to == model::Fidelity::sliding);
  const Size size = may_take_axisym(scene) ? Size{1, 1} : sliding ? Size{8, 128} : Size{256, 8192};
  // A multiple of 16 chunks where there are many designs, for as many ranks then have as much to do.
  const std::int64_t chunks = 16 * ((designs + 16 * size.most - 1) / (16 * size.most));
  const std::int64_t some = std::clamp((designs + chunks - 1) / chunks, size.least, size.most);
  return static_cast<std::size_t>(std::max(some, (designs + most_chunks - 1) / most_chunks));
}

SweepReport run_sweep(MPI_Comm comm, const Request& request, const Designs& designs,
                      archive::Provenance provenance) {
  archive::SweepArchive archive(comm, request.output, layout_of(request, designs), std::move(provenance),
                                chunk_designs(request.scene, designs.size()));
  if (archive.complete()) {
    SweepReport report;
    report.taken_up = designs.size();
    report.already_complete = true;
    return report;
  }
  return SweepRun(comm, request, designs, archive).run();
}

std::string speed_summary(MPI_Comm comm, const SweepReport& report) {
  enum Sum {
    designs,
    equilibria,
    busy,
    storing,
    finishing,
    solving_processor,
    archive_processor,
    messages,
    waiting,
    at_the_end,
    sums
  };
  std::array<double, sums> mine{static_cast<double>(report.designs),
                                report.equilibria,
                                report.solving + report.storing,
                                report.storing,
                                report.finishing,
                                report.solving_processor,
                                report.archive_processor,
                                static_cast<double>(report.messages),
                                report.waiting_for_messages,
                                report.waiting_at_the_end};
  std::array<double, sums> all{};
  MPI_Reduce(mine.data(), all.data(), sums, MPI_DOUBLE, MPI_SUM, 0, comm);
  const double ranks = petsc::size(comm);
  const double most_busy = petsc::largest(comm, mine[busy]), least_busy = -petsc::largest(comm, -mine[busy]);
  if (all[designs] == 0) return "";
  std::string text = fmt::format("{:.0f} designs in {:.3g} s on {:.0f} ranks: {:.3g} designs/s a rank",
                                 all[designs], report.seconds, ranks, all[designs] / report.seconds / ranks);
  if (all[equilibria] > 0)
    text += fmt::format(", {:.3g} equilibria/s a rank", all[equilibria] / report.seconds / ranks);
  const double processor = all[solving_processor] + all[archive_processor];
  text += fmt::format("\n  busy {:.3g} to {:.3g} s, imbalance {:.3f}; archive {:.1f} % of the time\n",
                      least_busy, most_busy, all[busy] > 0 ? most_busy * ranks / all[busy] : 1.0,
                      100 * (all[storing] + all[finishing]) / (ranks * report.seconds));
  text += fmt::format("  processor time {:.4g} s", processor);
  if (all[equilibria] > 0) text += fmt::format(", {:.3g} equilibria/s of it", all[equilibria] / processor);
  text += fmt::format("; archive {:.1f} % of it\n", 100 * all[archive_processor] / processor);
  text += fmt::format(
      "  {:.2g} messages and {:.2g} s of waiting for them a design; at the end {:.2g} s a rank for the "
      "slowest, "
      "{:.2g} s for the merge\n",
      all[messages] / all[designs], all[waiting] / all[designs], all[at_the_end] / ranks, report.finishing);
  return text;
}

}  // namespace gaiter::studies
