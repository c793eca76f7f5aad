// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/work_queue.hpp"

#include <algorithm>

#include "gaiter/petsc/session.hpp"

namespace gaiter::studies {

WorkQueue::WorkQueue(MPI_Comm comm, std::int64_t items, Order order, int group, int groups)
    : comm_(comm), items_(items), next_(group), order_(order), groups_(groups) {
  MPI_Win_allocate(places * sizeof(std::int64_t), sizeof(std::int64_t), MPI_INFO_NULL, comm, &board_,
                   &window_);
  std::fill_n(board_, places, std::int64_t{0});
  MPI_Win_lock_all(MPI_MODE_NOCHECK, window_);
  MPI_Win_sync(window_);
  MPI_Barrier(comm);
}

WorkQueue::~WorkQueue() {
  MPI_Win_unlock_all(window_);
  MPI_Win_free(&window_);
}

std::int64_t WorkQueue::fetch(int rank, Place place, std::int64_t value, MPI_Op operation) {
  std::int64_t before = 0;
  const double start = MPI_Wtime();
  MPI_Fetch_and_op(&value, &before, MPI_INT64_T, rank, place, operation, window_);
  MPI_Win_flush(rank, window_);
  if (rank != petsc::rank(comm_)) {
    ++messages_;
    waiting_ += MPI_Wtime() - start;
  }
  return before;
}

std::int64_t WorkQueue::next() {
  if (order_ == Order::on_demand) {
    const std::int64_t item = fetch(0, counter, 1, MPI_SUM);
    return item < items_ ? item : -1;
  }
  if (next_ >= items_) return -1;
  const std::int64_t item = next_;
  next_ += groups_;
  return item;
}

void WorkQueue::stop(int reason) {
  for (int rank = 0; rank < petsc::size(comm_); ++rank) fetch(rank, stop_reason, reason, MPI_REPLACE);
}

// Asked of this rank's own memory, which also lets MPI attend to what others want of it.
int WorkQueue::stopped() {
  return static_cast<int>(fetch(petsc::rank(comm_), stop_reason, 0, MPI_NO_OP));
}

void WorkQueue::report(Done more) {
  fetch(0, designs_done, more.designs, MPI_SUM);
  if (more.failed > 0) fetch(0, designs_failed, more.failed, MPI_SUM);
}

WorkQueue::Done WorkQueue::done() {
  return {fetch(0, designs_done, 0, MPI_NO_OP), fetch(0, designs_failed, 0, MPI_NO_OP)};
}

}  // namespace gaiter::studies
