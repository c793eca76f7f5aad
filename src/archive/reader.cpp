// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/archive/reader.hpp"

#include <hdf5.h>
#include <hdf5_hl.h>

#include <array>
#include <charconv>
#include <functional>
#include <numeric>

#include "gaiter/archive/hdf5.hpp"
#include "gaiter/base/error.hpp"

namespace gaiter::archive {
namespace {

using Name = std::array<char, 256>;

std::vector<std::size_t> shape_of(hid_t space) {
  const int rank = H5Sget_simple_extent_ndims(space);
  check(rank, "read a shape");
  std::vector<hsize_t> shape(static_cast<std::size_t>(rank));
  check(H5Sget_simple_extent_dims(space, shape.data(), nullptr), "read a shape");
  return {shape.begin(), shape.end()};
}

std::size_t product(const std::vector<std::size_t>& shape) {
  return std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
}

std::string type_name(hid_t type) {
  const std::string bits = std::to_string(8 * H5Tget_size(type));
  switch (H5Tget_class(type)) {
    case H5T_FLOAT:
      return "float" + bits;
    case H5T_INTEGER:
      return "int" + bits;
    case H5T_STRING:
      return "string";
    default:
      return "";
  }
}

// `read` fills the buffer it is given with `count` pointers to strings that HDF5 has allocated.
template <class Read>
std::vector<std::string> read_texts(hid_t type, hid_t space, std::size_t count, Read&& read) {
  std::vector<char*> pointers(count, nullptr);
  check(read(pointers.data()), "read text");
  std::vector<std::string> texts;
  for (const char* pointer : pointers) {
    texts.emplace_back(pointer == nullptr ? "" : pointer);
  }
  check(H5Dvlen_reclaim(type, space, H5P_DEFAULT, pointers.data()), "read text");
  return texts;
}

std::string joined(const std::vector<double>& numbers) {
  std::string text;
  for (const double number : numbers) {
    std::array<char, 32> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
    text.append(text.empty() ? "" : " ").append(digits.data(), end);
  }
  return text;
}

// References, by which HDF5 keeps its dimension scales, are passed over: the dimensions tell them by name.
Attributes attributes_of(hid_t object) {
  H5O_info_t info;
  check(H5Oget_info2(object, &info, H5O_INFO_NUM_ATTRS), "count attributes");
  Attributes attributes;
  for (hsize_t i = 0; i < info.num_attrs; ++i) {
    const Id attribute =
        own(H5Aopen_by_idx(object, ".", H5_INDEX_NAME, H5_ITER_INC, i, H5P_DEFAULT, H5P_DEFAULT),
            "open an attribute");
    Name name{};
    check(static_cast<herr_t>(H5Aget_name(attribute.get(), name.size(), name.data())), "read an attribute");
    const Id type = own(H5Aget_type(attribute.get()), "read an attribute");
    const Id space = own(H5Aget_space(attribute.get()), "read an attribute");
    const std::size_t count = product(shape_of(space.get()));
    const H5T_class_t kind = H5Tget_class(type.get());
    if (kind == H5T_STRING && H5Tis_variable_str(type.get()) > 0) {
      attributes[name.data()] = read_texts(type.get(), space.get(), count, [&](char** to) {
                                  return H5Aread(attribute.get(), type.get(), to);
                                }).at(0);
    } else if (kind == H5T_INTEGER || kind == H5T_FLOAT) {
      std::vector<double> numbers(count);
      check(H5Aread(attribute.get(), H5T_NATIVE_DOUBLE, numbers.data()), "read an attribute");
      attributes[name.data()] = joined(numbers);
    }
  }
  return attributes;
}

herr_t keep_name(hid_t, unsigned, hid_t scale, void* name) noexcept {
  auto& text = *static_cast<Name*>(name);
  return H5DSget_scale_name(scale, text.data(), text.size()) < 0 ? -1 : 1;  // 1: the first will do
}

std::vector<std::string> dimensions_of(hid_t variable, const std::string& name, std::size_t rank) {
  if (H5DSis_scale(variable) > 0) {
    return {name};
  }
  std::vector<std::string> dimensions;
  for (unsigned i = 0; i < rank; ++i) {
    Name scale{};
    if (H5DSget_num_scales(variable, i) > 0) {
      check(H5DSiterate_scales(variable, i, nullptr, keep_name, &scale), "read the dimensions of " + name);
    }
    dimensions.emplace_back(scale.data());
  }
  return dimensions;
}

Variable read_variable(hid_t file, const std::string& name) {
  const Id dataset = own(H5Dopen2(file, name.c_str(), H5P_DEFAULT), "open variable " + name);
  const Id type = own(H5Dget_type(dataset.get()), "read variable " + name);
  const Id space = own(H5Dget_space(dataset.get()), "read variable " + name);
  Variable variable;
  variable.shape = shape_of(space.get());
  variable.dimensions = dimensions_of(dataset.get(), name, variable.shape.size());
  variable.type = type_name(type.get());
  variable.attributes = attributes_of(dataset.get());
  const std::size_t count = product(variable.shape);
  if (variable.type == "string") {
    variable.words = read_texts(type.get(), space.get(), count, [&](char** to) {
      return H5Dread(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, to);
    });
  } else {
    variable.numbers.resize(count);
    check(H5Dread(dataset.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, variable.numbers.data()),
          "read variable " + name);
  }
  return variable;
}

}  // namespace

Archive read_archive(const std::string& path) {
  const QuietErrors quiet;
  const Id file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
  if (file.get() < 0) {
    throw base::InputError("archive " + path + " cannot be opened: " + last_error());
  }
  Archive archive;
  archive.attributes = attributes_of(file.get());
  H5G_info_t root;
  check(H5Gget_info(file.get(), &root), "list the variables of " + path);
  for (hsize_t i = 0; i < root.nlinks; ++i) {
    Name name{};
    check(static_cast<herr_t>(H5Lget_name_by_idx(file.get(), ".", H5_INDEX_NAME, H5_ITER_INC, i, name.data(),
                                                 name.size(), H5P_DEFAULT)),
          "list the variables of " + path);
    archive.variables.emplace(name.data(), read_variable(file.get(), name.data()));
  }
  return archive;
}

}  // namespace gaiter::archive
