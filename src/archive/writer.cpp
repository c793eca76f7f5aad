// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/archive/writer.hpp"

#include <algorithm>
#include <vector>

#include "gaiter/archive/agree.hpp"
#include "gaiter/archive/hdf5.hpp"
#include "gaiter/archive/schema.hpp"
#include "gaiter/base/error.hpp"

namespace gaiter::archive {
namespace {

bool is_first(MPI_Comm comm) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank == 0;
}

std::string context(const OutputFile& file) {
  return "archive " + file.final_path();
}

void require_complete(const Layout& layout) {
  if (layout.rows() == 0) {
    throw base::InternalError("it would hold no result");
  }
  for (const SweptVariable& swept : layout.swept) {
    if (swept.values.size() != layout.cases) {
      throw base::InternalError(swept.name + " has " + std::to_string(swept.values.size()) + " values for " +
                                std::to_string(layout.cases) + " cases");
    }
  }
}

// A little more than the file will take.
std::size_t size_of_file(const Layout& layout, const Provenance& provenance) {
  std::size_t row = 0;
  for (const Column& column : columns()) {
    row += bytes_of(stored_as(column));
  }
  const std::size_t per_case = (layout.swept.size() + 2) * sizeof(double);  // also case and wall_time
  return row * layout.rows() + per_case * layout.cases + provenance.options.size() + 100000;
}

hid_t memory_type(Stored stored) {
  switch (stored) {
    case Stored::float64:
      return H5T_NATIVE_DOUBLE;
    case Stored::int32:
      return H5T_NATIVE_INT32;
    case Stored::int8:
      return H5T_NATIVE_INT8;
  }
  return H5I_INVALID_HID;
}

// A range of the cells of a table of `rows` x `columns`, counted row by row.
struct CellRange {
  std::size_t rows;
  std::size_t columns;
  std::size_t first;
  std::size_t count;
};

void require_inside(const CellRange& range) {
  const std::size_t cells = range.rows * range.columns;
  if (range.first > cells || range.count > cells - range.first) {
    throw base::InternalError("rows " + std::to_string(range.first) + " to " +
                              std::to_string(range.first + range.count) + " given, it has only " +
                              std::to_string(cells));
  }
}

// Adds one block of cells to the selection. A table of one column is a vector in the file.
void add_block(hid_t space, const hsize_t (&start)[2], const hsize_t (&count)[2]) {
  if (count[0] > 0 && count[1] > 0) {
    check(H5Sselect_hyperslab(space, H5S_SELECT_OR, start, nullptr, count, nullptr), "select rows");
  }
}

// The range is at most three blocks: the rest of a row it begins within, whole rows, the start of a row it
// ends within. HDF5 walks a selection row by row, which is the order of the values in memory.
void select(hid_t space, const CellRange& range) {
  check(H5Sselect_none(space), "select rows");
  const hsize_t columns = range.columns;
  const hsize_t end = range.first + range.count;
  hsize_t row = range.first / columns;
  if (const hsize_t column = range.first % columns; column > 0) {
    const hsize_t stop = std::min(end - row * columns, columns);
    add_block(space, {row, column}, {1, stop - column});
    ++row;
  }
  if (row * columns < end) {
    const hsize_t whole = end / columns - row;
    add_block(space, {row, 0}, {whole, columns});
    add_block(space, {row + whole, 0}, {1, end % columns});
  }
}

// The unfinished file, open on all ranks for one round of writing. All ranks construct it, and all destroy
// it, together: opening and closing are collective. Writing is not: a rank's rows are contiguous in the file
// anyway, and in a collective write Open MPI 4.1 hangs on the other ranks when one cannot write.
class OpenFile {
 public:
  OpenFile(MPI_Comm comm, const OutputFile& file) : comm_(comm), context_(context(file)) {
    agreed(comm_, context_, [&] {
      const Id access = own(H5Pcreate(H5P_FILE_ACCESS), "set up MPI-IO");
      check(H5Pset_fapl_mpio(access.get(), comm_, MPI_INFO_NULL), "set up MPI-IO");
      file_ = own(H5Fopen(file.part_path().c_str(), H5F_ACC_RDWR, access.get()), "open " + file.part_path());
    });
  }

  // Not collective; throws on this rank alone.
  void write(const std::string& name, const CellRange& range, hid_t type, const void* values) {
    if (range.count == 0) {
      return;
    }
    const Id variable = own(H5Dopen2(file_.get(), name.c_str(), H5P_DEFAULT), "open variable " + name);
    const Id in_file = own(H5Dget_space(variable.get()), "select rows");
    select(in_file.get(), range);
    const hsize_t count = range.count;
    const Id in_memory = own(H5Screate_simple(1, &count, nullptr), "select rows");
    check(H5Dwrite(variable.get(), type, in_memory.get(), in_file.get(), H5P_DEFAULT, values),
          "write variable " + name);
  }

  void close() {
    agreed(comm_, context_, [&] { check(H5Fflush(file_.get(), H5F_SCOPE_GLOBAL), "write to the disk"); });
    agreed(comm_, context_, [&] {
      if (!file_.reset()) {
        throw base::InternalError("cannot close the file: " + last_error());
      }
    });
  }

 private:
  QuietErrors quiet_;
  MPI_Comm comm_;
  std::string context_;
  Id file_;
};

}  // namespace

Writer::Writer(MPI_Comm comm, const std::string& path, const Layout& layout, const Provenance& provenance)
    : comm_(comm), cases_(layout.cases), segments_(layout.segments.size()), file_(path) {
  // Nobody goes on before all are here: a rank still busy with removing an abandoned file of the same name
  // would remove the new one.
  agreed(comm_, context(file_), [&] { require_complete(layout); });
  agreed(comm_, context(file_), [&] {
    if (is_first(comm_)) {
      // HDF5 1.10 cannot close a file that it fails to complete, and crashes over it at the end of the
      // program: so it is not let near a disk that is too small.
      file_.make_room(size_of_file(layout, provenance));
      create_archive(file_.part_path(), layout, provenance);
    }
  });
}

void Writer::write(std::size_t first_row, std::span<const model::SegmentResult> rows) {
  const CellRange range{cases_, segments_, first_row, rows.size()};
  agreed(comm_, context(file_), [&] {
    require_open();
    require_inside(range);
  });
  OpenFile file(comm_, file_);
  agreed(comm_, context(file_), [&] {
    std::vector<std::byte> values(rows.size() * sizeof(double));  // room for the widest stored type
    for (const Column& column : columns()) {
      gather(column, rows, values.data());
      file.write(std::string(column.name), range, memory_type(stored_as(column)), values.data());
    }
  });
  file.close();
}

void Writer::write_wall_times(std::size_t first_case, std::span<const double> seconds) {
  const CellRange range{cases_, 1, first_case, seconds.size()};
  agreed(comm_, context(file_), [&] {
    require_open();
    require_inside(range);
  });
  OpenFile file(comm_, file_);
  agreed(comm_, context(file_), [&] { file.write("wall_time", range, H5T_NATIVE_DOUBLE, seconds.data()); });
  file.close();
}

void Writer::close() {
  agreed(comm_, context(file_), [&] {
    require_open();
    if (is_first(comm_)) {
      file_.publish();
    }
  });
  file_.release();
  closed_ = true;
}

void Writer::require_open() const {
  if (closed_) {
    throw base::InternalError("it is closed already");
  }
}

}  // namespace gaiter::archive
