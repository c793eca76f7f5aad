// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <hdf5.h>

#include <string>
#include <string_view>
#include <vector>

#include "gaiter/archive/hdf5.hpp"

namespace gaiter::archive {

// Strings of variable length, UTF-8: h5py and xarray give them back as str, where fixed-length ones would
// come as bytes. A long text of options also fits only so (HDF5 limits an attribute to 64 kB, but not what it
// points to).
Id text_type();

// Attributes of a file or a variable; throw base::InternalError.
void put_text(hid_t object, const std::string& name, std::string_view text);
void put_count(hid_t object, const std::string& name, int value);
// CF's flag_values and flag_meanings: the words stand for first, first + 1, ...
void put_flags(hid_t object, const std::vector<std::string_view>& words, int first);

// Nothing if there is no such text.
std::string get_text(hid_t object, const std::string& name);

}  // namespace gaiter::archive
