// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/archive/merge.hpp"

#include <hdf5.h>

#include <filesystem>
#include <vector>

#include "gaiter/archive/durable_file.hpp"
#include "gaiter/archive/table_file.hpp"
#include "gaiter/base/error.hpp"

namespace gaiter::archive {
namespace {

// A little more than the file will take.
std::size_t size_of_all(const RunFolder& folder, std::size_t chunks, const Layout& layout,
                        const Provenance& provenance) {
  std::size_t bytes = 1000000 + provenance.options.size() + layout.cases;
  bytes += chunks * variables_of(layout).size() * 100;  // where HDF5 keeps the places of the chunks
  for (std::size_t i = 0; i < chunks; ++i) {
    std::error_code error;
    bytes += std::filesystem::file_size(folder.chunk_path(i), error);
    if (error) {
      throw base::InternalError("cannot read " + folder.chunk_path(i) + ": " + error.message());
    }
  }
  return bytes;
}

void copy_chunk(hid_t part, const std::string& name, hid_t to, std::size_t first_case,
                std::vector<std::byte>& buffer) {
  const Id from = own(H5Dopen2(part, name.c_str(), H5P_DEFAULT), "open variable " + name);
  const hsize_t start[2] = {0, 0};
  hsize_t bytes = 0;
  check(H5Dget_chunk_storage_size(from.get(), start, &bytes), "read variable " + name);
  buffer.resize(bytes);
  std::uint32_t filters_left_out = 0;
  check(H5Dread_chunk(from.get(), H5P_DEFAULT, start, &filters_left_out, buffer.data()),
        "read variable " + name);
  put_chunk(to, first_case, buffer);
}

}  // namespace

void merge_chunks(const std::string& path, const RunFolder& folder, const Layout& layout,
                  const Provenance& provenance, std::size_t chunk_cases) {
  const QuietErrors quiet;
  const LimitIsAnError guard;
  const std::size_t chunks = (layout.cases + chunk_cases - 1) / chunk_cases;
  const std::size_t room = size_of_all(folder, chunks, layout, provenance);
  // HDF5 1.10 cannot close a file that it fails to complete: so the space is there before it begins. It drops
  // what was taken ahead when it makes the file, hence twice.
  reserve(path, room);
  Id file = own(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), "make the file " + path);
  reserve(path, room);
  {
    const std::vector<FileVariable> variables = variables_of(layout);
    const std::vector<Id> made = fill_file(file.get(), layout, provenance, {0, layout.cases, chunk_cases});
    std::vector<std::byte> buffer;
    for (std::size_t i = 0; i < chunks; ++i) {
      const std::string part_path = folder.chunk_path(i);
      const Id part = own(H5Fopen(part_path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), "open " + part_path);
      for (std::size_t v = 0; v < variables.size(); ++v) {
        copy_chunk(part.get(), variables[v].name, made[v].get(), i * chunk_cases, buffer);
      }
    }
  }
  check(H5Fflush(file.get(), H5F_SCOPE_LOCAL), "write the file " + path);
  if (!file.reset()) {
    throw base::InternalError("cannot close the file " + path + ": " + last_error());
  }
  // Gives back what was taken ahead and not used.
  std::error_code error;
  std::filesystem::resize_file(path, std::filesystem::file_size(path), error);
}

}  // namespace gaiter::archive
