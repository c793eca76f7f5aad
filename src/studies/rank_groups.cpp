// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/rank_groups.hpp"

#include "gaiter/petsc/session.hpp"

namespace gaiter::studies {

RankGroups::RankGroups(MPI_Comm comm, int ranks_per_group) {
  const int rank = petsc::rank(comm);
  count = (petsc::size(comm) + ranks_per_group - 1) / ranks_per_group;
  mine = rank / ranks_per_group;
  MPI_Comm_split(comm, mine, rank, &group);
}

RankGroups::~RankGroups() {
  MPI_Comm_free(&group);
}

}  // namespace gaiter::studies
