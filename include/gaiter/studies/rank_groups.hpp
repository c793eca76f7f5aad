// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <mpi.h>

namespace gaiter::studies {

// Ranks that solve one case together, neighbours in their order; the last group may be smaller.
struct RankGroups {
  RankGroups(MPI_Comm comm, int ranks_per_group);  // @note Collective, as is the destructor.
  ~RankGroups();
  RankGroups(const RankGroups&) = delete;
  RankGroups& operator=(const RankGroups&) = delete;

  MPI_Comm group = MPI_COMM_NULL;  // this rank's
  int count = 1;                   // of groups
  int mine = 0;                    // number of this rank's group
};

}  // namespace gaiter::studies
