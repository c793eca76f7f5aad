// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/archive/agree.hpp"

namespace gaiter::archive {

void throw_if_any_failed(MPI_Comm comm, const Failure& failure) {
  int rank = 0;
  int ranks = 1;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &ranks);
  const int mine = failure.message.empty() ? ranks : rank;
  int first = ranks;
  MPI_Allreduce(&mine, &first, 1, MPI_INT, MPI_MIN, comm);
  if (first == ranks) {
    return;
  }
  int told[2] = {static_cast<int>(failure.message.size()), failure.by_input ? 1 : 0};
  MPI_Bcast(told, 2, MPI_INT, first, comm);
  std::string message = failure.message;
  message.resize(static_cast<std::size_t>(told[0]));
  MPI_Bcast(message.data(), told[0], MPI_CHAR, first, comm);
  if (told[1] != 0) {
    throw base::InputError(message);
  }
  throw base::InternalError(message);
}

}  // namespace gaiter::archive
