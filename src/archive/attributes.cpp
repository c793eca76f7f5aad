// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/archive/attributes.hpp"

#include <numeric>

namespace gaiter::archive {
namespace {

Id make_attribute(hid_t object, const std::string& name, hid_t type, hid_t space) {
  return own(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT),
             "make attribute " + name);
}

}  // namespace

Id text_type() {
  Id type = own(H5Tcopy(H5T_C_S1), "make a string type");
  check(H5Tset_size(type.get(), H5T_VARIABLE), "make a string type");
  check(H5Tset_cset(type.get(), H5T_CSET_UTF8), "make a string type");
  return type;
}

void put_text(hid_t object, const std::string& name, std::string_view text) {
  const Id type = text_type();
  const Id space = own(H5Screate(H5S_SCALAR), "make attribute " + name);
  const Id attribute = make_attribute(object, name, type.get(), space.get());
  const std::string terminated(text);
  const char* pointer = terminated.c_str();
  check(H5Awrite(attribute.get(), type.get(), &pointer), "write attribute " + name);
}

void put_count(hid_t object, const std::string& name, int value) {
  const Id space = own(H5Screate(H5S_SCALAR), "make attribute " + name);
  const Id attribute = make_attribute(object, name, H5T_STD_I32LE, space.get());
  check(H5Awrite(attribute.get(), H5T_NATIVE_INT, &value), "write attribute " + name);
}

void put_flags(hid_t object, const std::vector<std::string_view>& words, int first) {
  std::vector<signed char> values(words.size());
  std::iota(values.begin(), values.end(), static_cast<signed char>(first));
  std::string meanings;
  for (const std::string_view word : words) {
    meanings.append(meanings.empty() ? "" : " ").append(word);
  }
  const hsize_t size = values.size();
  const Id space = own(H5Screate_simple(1, &size, nullptr), "make attribute flag_values");
  const Id attribute = make_attribute(object, "flag_values", H5T_STD_I8LE, space.get());
  check(H5Awrite(attribute.get(), H5T_NATIVE_SCHAR, values.data()), "write attribute flag_values");
  put_text(object, "flag_meanings", meanings);
}

std::string get_text(hid_t object, const std::string& name) {
  if (H5Aexists(object, name.c_str()) <= 0) {
    return "";
  }
  const Id attribute = own(H5Aopen(object, name.c_str(), H5P_DEFAULT), "open attribute " + name);
  const Id stored = own(H5Aget_type(attribute.get()), "read attribute " + name);
  if (H5Tis_variable_str(stored.get()) <= 0) {
    return "";
  }
  const Id type = text_type();
  char* pointer = nullptr;
  check(H5Aread(attribute.get(), type.get(), &pointer), "read attribute " + name);
  const std::string text = pointer == nullptr ? "" : pointer;
  check(H5free_memory(pointer), "read attribute " + name);
  return text;
}

}  // namespace gaiter::archive
