// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include <mpi.h>
#include "gaiter/archive/layout.hpp"
#include "gaiter/archive/output_file.hpp"
#include "gaiter/archive/provenance.hpp"
#include "gaiter/model/result.hpp"

namespace gaiter::archive {

// Writes one archive from all ranks. The final name appears, or is replaced, at close() and never holds an
// unfinished file; a Writer that goes away before close() removes what it wrote.
//
// A row is one (case, segment), row = case * segments + segment. Every call opens and closes the file, so
// that between calls the unfinished file is complete as far as it goes and nothing collective is left to a
// destructor. A failure on any rank is thrown as the same base::InternalError on all of them.
// @note Collective over the communicator, every member function and the constructor, but not the destructor.
class Writer {
 public:
  Writer(MPI_Comm comm, const std::string& path, const Layout& layout, const Provenance& provenance);
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  // Each rank gives the rows first_row, first_row + 1, ...: possibly none, and not necessarily whole cases.
  // The ranges of different ranks do not overlap.
  void write(std::size_t first_row, std::span<const model::SegmentResult> rows);

  // Seconds each case took; ranges as in write(), in cases. Cases never written stay NaN.
  void write_wall_times(std::size_t first_case, std::span<const double> seconds);

  void close();

 private:
  void require_open() const;

  MPI_Comm comm_;
  std::size_t cases_;
  std::size_t segments_;
  OutputFile file_;
  bool closed_ = false;
};

}  // namespace gaiter::archive
