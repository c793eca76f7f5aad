// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/archive/table_file.hpp"

#include <hdf5.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>

#include "gaiter/archive/attributes.hpp"
#include "gaiter/archive/schema.hpp"

namespace gaiter::archive {
namespace {

hid_t file_type(Stored stored) {
  switch (stored) {
    case Stored::float64:
      return H5T_IEEE_F64LE;
    case Stored::int64:
      return H5T_STD_I64LE;
    case Stored::int32:
      return H5T_STD_I32LE;
    case Stored::int8:
      return H5T_STD_I8LE;
  }
  return H5I_INVALID_HID;
}

Id creation_properties(const std::string& action) {
  Id properties = own(H5Pcreate(H5P_DATASET_CREATE), action);
  check(H5Pset_obj_track_times(properties.get(), false), action);
  return properties;
}

void chunk_and_compress(hid_t properties, const std::vector<hsize_t>& chunk, const std::string& action) {
  check(H5Pset_chunk(properties, static_cast<int>(chunk.size()), chunk.data()), action);
  check(H5Pset_shuffle(properties), action);
  check(H5Pset_deflate(properties, 1), action);
}

// The part of each chunk's file lies where the chunk's cases lie among all cases.
void map_parts(hid_t properties, const std::string& name, const CaseRange& range,
               const std::vector<hsize_t>& shape, const PartPath& part_path, const std::string& action) {
  const int dimensions = static_cast<int>(shape.size());
  const Id space = own(H5Screate_simple(dimensions, shape.data(), nullptr), action);
  std::vector<hsize_t> start(shape.size(), 0);
  std::vector<hsize_t> block = shape;
  for (std::size_t i = 0; i * range.chunk < range.count; ++i) {
    start[0] = i * range.chunk;
    block[0] = std::min<hsize_t>(range.chunk, range.count - start[0]);
    const std::vector<hsize_t> once(shape.size(), 1);
    check(H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, once.data(), block.data()),
          action);
    const Id part = own(H5Screate_simple(dimensions, block.data(), nullptr), action);
    check(H5Pset_virtual(properties, space.get(), part_path(i).c_str(), name.c_str(), part.get()), action);
  }
}

Id make_case_scale(hid_t file, const CaseRange& range) {
  const std::string action = "make variable case";
  const Id properties = creation_properties(action);
  chunk_and_compress(properties.get(), {range.chunk}, action);
  const hsize_t size = range.count;
  const hsize_t most = std::max(range.count, range.chunk);
  const Id space = own(H5Screate_simple(1, &size, &most), action);
  Id scale =
      own(H5Dcreate2(file, "case", H5T_STD_I64LE, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
          action);
  check(H5DSset_scale(scale.get(), "case"), "make case a dimension");
  put_text(scale.get(), "units", "1");
  put_text(scale.get(), "long_name", "number of the case, in the order of the sweep");
  std::vector<std::int64_t> numbers(range.chunk);
  Compressor compressor;
  for (std::size_t first = 0; first < range.count; first += range.chunk) {
    std::iota(numbers.begin(), numbers.end(), static_cast<std::int64_t>(range.first + first));
    put_chunk(scale.get(), first, compressor.compress(std::as_bytes(std::span(numbers)), 8));
  }
  return scale;
}

Id make_segment_scale(hid_t file, const std::vector<std::string>& names) {
  const std::string action = "make variable segment";
  const Id type = text_type();
  const Id properties = creation_properties(action);
  const hsize_t size = names.size();
  const Id space = own(H5Screate_simple(1, &size, nullptr), action);
  Id scale =
      own(H5Dcreate2(file, "segment", type.get(), space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
          action);
  std::vector<const char*> pointers;
  for (const std::string& name : names) {
    pointers.push_back(name.c_str());
  }
  // By default HDF5 converts texts in two megabytes that it clears first, which takes as long as all else
  // here.
  const Id transfer = own(H5Pcreate(H5P_DATASET_XFER), action);
  check(H5Pset_buffer(transfer.get(), 4096, nullptr, nullptr), action);
  check(H5Dwrite(scale.get(), type.get(), H5S_ALL, H5S_ALL, transfer.get(), pointers.data()),
        "write variable segment");
  check(H5DSset_scale(scale.get(), "segment"), "make segment a dimension");
  put_text(scale.get(), "long_name", "name of the segment of leg, from the ankle up");
  return scale;
}

Id make_variable(hid_t file, const FileVariable& variable, const CaseRange& range, std::size_t segments,
                 const Unfinished* unfinished) {
  const std::string action = "make variable " + variable.name;
  std::vector<hsize_t> shape{range.count};
  if (variable.per_segment) {
    shape.push_back(segments);
  }
  std::vector<hsize_t> chunk = shape;
  chunk[0] = range.chunk;
  std::vector<hsize_t> most = shape;
  most[0] = std::max(range.count, range.chunk);

  const Id properties = creation_properties(action);
  const double missing = variable.stored == Stored::float64 ? std::numeric_limits<double>::quiet_NaN() : -1;
  check(H5Pset_fill_value(properties.get(), H5T_NATIVE_DOUBLE, &missing), action);
  const bool windows = unfinished != nullptr && range.count <= most_parts_shown * range.chunk;
  if (windows) {
    map_parts(properties.get(), variable.name, range, shape, unfinished->part_path, action);
  } else {
    chunk_and_compress(properties.get(), chunk, action);
  }
  const Id space =
      own(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), windows ? nullptr : most.data()),
          action);
  Id made = own(H5Dcreate2(file, variable.name.c_str(), file_type(variable.stored), space.get(), H5P_DEFAULT,
                           properties.get(), H5P_DEFAULT),
                action);
  if (!variable.unit.empty()) {
    put_text(made.get(), "units", variable.unit);
  }
  put_text(made.get(), "long_name", variable.long_name);
  if (std::vector<std::string_view> words = variable.flag_words; !words.empty()) {
    if (unfinished != nullptr) {
      words.insert(words.begin(), "pending");
    }
    put_flags(made.get(), words, unfinished != nullptr ? -1 : 0);
  }
  return made;
}

}  // namespace

std::vector<Id> fill_file(hid_t file, const Layout& layout, const Provenance& provenance,
                          const CaseRange& range, const Unfinished* unfinished) {
  put_count(file, "schema_version", schema_version);
  put_text(file, "gaiter_version", provenance.gaiter_version);
  put_text(file, "petsc_version", provenance.petsc_version);
  put_text(file, "options", provenance.options);
  put_text(file, "command", provenance.command);
  put_text(file, "created", provenance.created);
  put_count(file, "ranks", provenance.ranks);
  if (unfinished != nullptr) {
    put_text(file, incomplete_attribute, unfinished->note);
  }

  const Id cases = make_case_scale(file, range);
  const Id segments = make_segment_scale(file, layout.segments);
  std::vector<Id> made;
  for (const FileVariable& variable : variables_of(layout)) {
    made.push_back(make_variable(file, variable, range, layout.segments.size(), unfinished));
    const std::string action = "name the dimensions of " + variable.name;
    check(H5DSattach_scale(made.back().get(), cases.get(), 0), action);
    if (variable.per_segment) {
      check(H5DSattach_scale(made.back().get(), segments.get(), 1), action);
    }
    if (unfinished != nullptr) {
      made.pop_back();  // its windows take megabytes while it is open
    }
  }
  return made;
}

Extent place_of_first_chunk(hid_t variable) {
  const hsize_t offset[2] = {0, 0};  // of as many as the variable has
  unsigned filters_left_out = 0;
  haddr_t place = HADDR_UNDEF;
  hsize_t bytes = 0;
  check(H5Dget_chunk_info_by_coord(variable, offset, &filters_left_out, &place, &bytes), "find values");
  return {place, bytes};
}

void put_chunk(hid_t variable, std::size_t case_in_file, std::span<const std::byte> stream) {
  const hsize_t offset[2] = {case_in_file, 0};  // of as many as the variable has
  check(H5Dwrite_chunk(variable, H5P_DEFAULT, 0, offset, stream.size(), stream.data()), "write values");
}

}  // namespace gaiter::archive
