// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <mpi.h>

#include <cstdint>

namespace gaiter::studies {

// Shares a row of work items among groups of ranks, without any rank that only hands out. `in_turn`: group g
// takes every groups-th item, for work of even cost; nothing is sent. `on_demand`: a group that is free takes
// the next item from a counter on rank 0, by one-sided atomic addition, for work of uneven cost. Also carries
// what ranks tell each other meanwhile: that all should stop, and how much is done.
class WorkQueue {
 public:
  enum class Order { in_turn, on_demand };

  // @note Collective, as is the destructor.
  WorkQueue(MPI_Comm comm, std::int64_t items, Order order, int group, int groups);
  ~WorkQueue();
  WorkQueue(const WorkQueue&) = delete;
  WorkQueue& operator=(const WorkQueue&) = delete;

  // The next item of this rank's group, for one rank of the group to ask; -1: there is none left.
  std::int64_t next();

  // Asks all ranks to stop, for `reason` > 0; the reason this rank has been given, 0: none.
  void stop(int reason);
  int stopped();

  // Adds to what rank 0 knows to be done; what it knows, for rank 0 to ask.
  struct Done {
    std::int64_t designs = 0, failed = 0;
  };
  void report(Done more);
  Done done();

  std::int64_t messages() const { return messages_; }  // to other ranks, so far
  double waiting() const { return waiting_; }          // for their answers [s]

 private:
  enum Place { counter, stop_reason, designs_done, designs_failed, places };
  std::int64_t fetch(int rank, Place place, std::int64_t value, MPI_Op operation);

  MPI_Comm comm_;
  std::int64_t items_, next_, messages_ = 0;
  double waiting_ = 0;
  Order order_;
  int groups_;
  std::int64_t* board_ = nullptr;  // this rank's places
  MPI_Win window_ = MPI_WIN_NULL;
};

}  // namespace gaiter::studies
