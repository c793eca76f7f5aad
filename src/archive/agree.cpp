// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/archive/agree.hpp"

#include "gaiter/base/error.hpp"

namespace gaiter::archive {

void throw_if_any_failed(MPI_Comm comm, const std::string& failure) {
  int rank = 0;
  int ranks = 1;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &ranks);
  const int mine = failure.empty() ? ranks : rank;
  int first = ranks;
  MPI_Allreduce(&mine, &first, 1, MPI_INT, MPI_MIN, comm);
  if (first == ranks) {
    return;
  }
  int length = static_cast<int>(failure.size());
  MPI_Bcast(&length, 1, MPI_INT, first, comm);
  std::string message = failure;
  message.resize(static_cast<std::size_t>(length));
  MPI_Bcast(message.data(), length, MPI_CHAR, first, comm);
  throw base::InternalError(message);
}

}  // namespace gaiter::archive
