// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <mpi.h>

#include <map>
#include <string>

namespace gaiter::studies {

// Draws an archive, finished or not: one HTML page, whole in itself, with numbers and figures. `given`: the
// options -archive and -output, name without dash -> text. Returns the page's name. The first rank draws,
// with a Python that has h5py and matplotlib. Throws InputError for other options and for a file that is no
// archive, InternalError where Python fails. @note Collective.
std::string write_report(MPI_Comm comm, const std::map<std::string, std::string>& given);

}  // namespace gaiter::studies
