// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <mpi.h>

#include <string>
#include <vector>

#include "gaiter/solvers/axisym_fields.hpp"
#include "gaiter/studies/scene_options.hpp"

namespace gaiter::studies {

// One file of -axisym_view FILE.hdf: FILE_rest.hdf and, where a voltage is applied, FILE_actuated.hdf; with
// several meshes, one a segment, FILE_<s>_rest.hdf and so on.
struct View {
  std::size_t first_segment = 0;  // of its mesh
  bool actuated = false;
  std::string path;
};

// All files asked for; none without the option.
std::vector<View> views_of(const Request& request);

// Throws base::InputError where the option does not fit the command or the fidelity.
void check_views(Command command, const Request& request);

// Throws base::InputError unless all files can be written. One rank is enough.
void check_views_writable(const Request& request);

// Writes the files of the states found, each from the rank that holds the fields. The file of a state that
// was not found is taken away, lest an earlier run's be taken for it. Returns a line on each file, on every
// rank. Throws base::InternalError on all ranks alike. @note Collective.
std::string write_views(MPI_Comm comm, const Request& request,
                        const std::vector<solvers::AxisymFields>& found);

}  // namespace gaiter::studies
