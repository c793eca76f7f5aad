// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/archive/layout.hpp"

#include <hdf5.h>
#include <hdf5_hl.h>

#include <cstdint>
#include <limits>
#include <numeric>
#include <string_view>

#include "gaiter/archive/hdf5.hpp"
#include "gaiter/archive/schema.hpp"

namespace gaiter::archive {
namespace {

// Strings are of variable length and UTF-8 throughout: h5py and xarray give them back as str, where
// fixed-length ones would come as bytes. A long text of options also fits only so (HDF5 limits an attribute
// to 64 kB, but not what it points to). MPI-IO cannot write them, a reason to create the file serially.
Id text_type() {
  Id type = own(H5Tcopy(H5T_C_S1), "make a string type");
  check(H5Tset_size(type.get(), H5T_VARIABLE), "make a string type");
  check(H5Tset_cset(type.get(), H5T_CSET_UTF8), "make a string type");
  return type;
}

void put_text(hid_t object, const std::string& name, std::string_view text) {
  const Id type = text_type();
  const Id space = own(H5Screate(H5S_SCALAR), "make attribute " + name);
  const Id attribute =
      own(H5Acreate2(object, name.c_str(), type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT),
          "make attribute " + name);
  const std::string terminated(text);
  const char* pointer = terminated.c_str();
  check(H5Awrite(attribute.get(), type.get(), &pointer), "write attribute " + name);
}

void put_count(hid_t object, const std::string& name, int value) {
  const Id space = own(H5Screate(H5S_SCALAR), "make attribute " + name);
  const Id attribute =
      own(H5Acreate2(object, name.c_str(), H5T_STD_I32LE, space.get(), H5P_DEFAULT, H5P_DEFAULT),
          "make attribute " + name);
  check(H5Awrite(attribute.get(), H5T_NATIVE_INT, &value), "write attribute " + name);
}

void put_flags(hid_t object, const std::vector<std::string_view>& words) {
  std::vector<signed char> values(words.size());
  std::iota(values.begin(), values.end(), static_cast<signed char>(0));
  std::string meanings;
  for (const std::string_view word : words) {
    meanings.append(meanings.empty() ? "" : " ").append(word);
  }
  const hsize_t size = values.size();
  const Id space = own(H5Screate_simple(1, &size, nullptr), "make attribute flag_values");
  const Id attribute =
      own(H5Acreate2(object, "flag_values", H5T_STD_I8LE, space.get(), H5P_DEFAULT, H5P_DEFAULT),
          "make attribute flag_values");
  check(H5Awrite(attribute.get(), H5T_NATIVE_SCHAR, values.data()), "write attribute flag_values");
  put_text(object, "flag_meanings", meanings);
}

void describe(hid_t variable, std::string_view unit, std::string_view long_name) {
  if (!unit.empty()) {
    put_text(variable, "units", unit);
  }
  put_text(variable, "long_name", long_name);
}

hid_t file_type(Stored stored) {
  switch (stored) {
    case Stored::float64:
      return H5T_IEEE_F64LE;
    case Stored::int32:
      return H5T_STD_I32LE;
    case Stored::int8:
      return H5T_STD_I8LE;
  }
  return H5I_INVALID_HID;
}

// The space is taken at once, so that a full disk shows before the work, and so that the ranks later change
// nothing but raw data. No times are kept in the file: the same results give the same file.
Id make_variable(hid_t file, const std::string& name, hid_t type, const std::vector<hsize_t>& shape) {
  const std::string action = "make variable " + name;
  const Id properties = own(H5Pcreate(H5P_DATASET_CREATE), action);
  check(H5Pset_obj_track_times(properties.get(), false), action);
  if (H5Tget_class(type) != H5T_STRING) {
    const double missing = H5Tget_class(type) == H5T_FLOAT ? std::numeric_limits<double>::quiet_NaN() : -1;
    check(H5Pset_fill_value(properties.get(), H5T_NATIVE_DOUBLE, &missing), action);
    check(H5Pset_alloc_time(properties.get(), H5D_ALLOC_TIME_EARLY), action);
  }
  const Id space = own(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), action);
  return own(H5Dcreate2(file, name.c_str(), type, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
             action);
}

Id make_case_scale(hid_t file, std::size_t cases) {
  Id scale = make_variable(file, "case", H5T_STD_I64LE, {cases});
  std::vector<std::int64_t> numbers(cases);
  std::iota(numbers.begin(), numbers.end(), std::int64_t{0});
  check(H5Dwrite(scale.get(), H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data()),
        "write variable case");
  check(H5DSset_scale(scale.get(), "case"), "make case a dimension");
  describe(scale.get(), "1", "number of the case, in the order of the sweep");
  return scale;
}

Id make_segment_scale(hid_t file, const std::vector<std::string>& names) {
  const Id type = text_type();
  Id scale = make_variable(file, "segment", type.get(), {names.size()});
  std::vector<const char*> pointers;
  for (const std::string& name : names) {
    pointers.push_back(name.c_str());
  }
  check(H5Dwrite(scale.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, pointers.data()),
        "write variable segment");
  check(H5DSset_scale(scale.get(), "segment"), "make segment a dimension");
  describe(scale.get(), "", "name of the segment of leg, from the ankle up");
  return scale;
}

}  // namespace

void create_archive(const std::string& path, const Layout& layout, const Provenance& provenance) {
  const QuietErrors quiet;
  Id file = own(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), "make the file " + path);
  put_count(file.get(), "schema_version", schema_version);
  put_text(file.get(), "gaiter_version", provenance.gaiter_version);
  put_text(file.get(), "petsc_version", provenance.petsc_version);
  put_text(file.get(), "options", provenance.options);
  put_text(file.get(), "command", provenance.command);
  put_text(file.get(), "created", provenance.created);
  put_count(file.get(), "ranks", provenance.ranks);

  const Id cases = make_case_scale(file.get(), layout.cases);
  const Id segments = make_segment_scale(file.get(), layout.segments);
  const auto attach = [](const Id& variable, const Id& scale, unsigned dimension, const std::string& name) {
    check(H5DSattach_scale(variable.get(), scale.get(), dimension), "name the dimensions of " + name);
  };

  for (const Column& column : columns()) {
    const std::string name(column.name);
    const Id variable =
        make_variable(file.get(), name, file_type(stored_as(column)), {layout.cases, layout.segments.size()});
    describe(variable.get(), column.unit, column.long_name);
    if (const auto words = flag_words(column); !words.empty()) {
      put_flags(variable.get(), words);
    }
    attach(variable, cases, 0, name);
    attach(variable, segments, 1, name);
  }

  for (const SweptVariable& swept : layout.swept) {
    const Id variable = make_variable(file.get(), swept.name, H5T_IEEE_F64LE, {layout.cases});
    describe(variable.get(), swept.unit, swept.long_name);
    attach(variable, cases, 0, swept.name);
    check(H5Dwrite(variable.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, swept.values.data()),
          "write variable " + swept.name);
  }

  const Id wall_time = make_variable(file.get(), "wall_time", H5T_IEEE_F64LE, {layout.cases});
  describe(wall_time.get(), "s", "wall-clock time that the case took");
  attach(wall_time, cases, 0, "wall_time");

  check(H5Fflush(file.get(), H5F_SCOPE_LOCAL), "write the file " + path);
}

}  // namespace gaiter::archive
