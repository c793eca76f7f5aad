// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "gaiter/archive/compression.hpp"
#include "gaiter/archive/hdf5.hpp"
#include "gaiter/archive/layout.hpp"
#include "gaiter/archive/provenance.hpp"

namespace gaiter::archive {

// The file that holds chunk i of a run, as a path relative to the archive's own folder.
using PartPath = std::function<std::string(std::size_t chunk)>;

// What is special about the file that shows a run before it has ended.
struct Unfinished {
  PartPath part_path;
  std::string note;  // becomes the file's attribute `incomplete`, which finished archives do not have
};

// The attribute by which unfinished files are known.
inline constexpr const char* incomplete_attribute = "incomplete";

// More chunks than these are not shown before the end of the run. A reader keeps the file of every chunk open
// that it has touched, and where its system lets it open no more (often 1024) HDF5 gives out the fill value
// without a word; and to make the windows of a chunk takes 0.1 MB.
inline constexpr std::size_t most_parts_shown = 250;

// Fills a new file with dimensions, variables and attributes for a range of cases. Variables are chunked and
// compressed and hold nothing yet but the fill value: NaN, for integers -1. Of an unfinished run they
// are windows onto the files of its chunks, and none is returned; otherwise all, in the order of
// variables_of(). Throws base::InternalError. No times of objects are kept: the same results give the same
// file.
std::vector<Id> fill_file(hid_t file, const Layout& layout, const Provenance& provenance,
                          const CaseRange& range, const Unfinished* unfinished = nullptr);

// Where the compressed values of a variable lie in a file.
struct Extent {
  std::uint64_t place, bytes;
};

Extent place_of_first_chunk(hid_t variable);

// Writes the HDF5 chunk of a variable that begins with a case, counted from the file's first one. `stream`:
// what Compressor makes of the values of a whole chunk.
void put_chunk(hid_t variable, std::size_t case_in_file, std::span<const std::byte> stream);

}  // namespace gaiter::archive
