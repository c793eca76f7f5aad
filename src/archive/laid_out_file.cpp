// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/archive/laid_out_file.hpp"

#include <H5FDpublic.h>
#if H5_VERSION_GE(1, 13, 0)
#include <H5FDdevelop.h>
#endif
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>
#include <utility>

#include "gaiter/archive/durable_file.hpp"
#include "gaiter/archive/table_file.hpp"
#include "gaiter/base/error.hpp"

namespace gaiter::archive {
namespace {

using Shared = LaidOutFile::Shared;

// HDF5 knows a driver's file by its first member.
struct File {
  H5FD_t common{};
  int descriptor = -1;
  haddr_t allocated = 0;  // HDF5's end of the file
  Shared* shared = nullptr;
};

File& of(H5FD_t* file) {
  return *reinterpret_cast<File*>(file);
}
const File& of(const H5FD_t* file) {
  return *reinterpret_cast<const File*>(file);
}

void keep_error(File& file) {
  if (file.shared->error == 0) {
    file.shared->error = errno;
  }
}

// The owner's part is what HDF5 keeps as the driver's settings; it is passed on by address.
void* copy_settings(const void* settings) {
  return new (std::nothrow) Shared*(*static_cast<Shared* const*>(settings));
}
herr_t free_settings(void* settings) {
  delete static_cast<Shared**>(settings);
  return 0;
}

H5FD_t* open(const char* name, unsigned, hid_t access, haddr_t) {
  const auto* settings = static_cast<Shared* const*>(H5Pget_driver_info(access));
  const int descriptor =
      settings == nullptr ? -1 : ::open(name, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  File* file = descriptor < 0 ? nullptr : new (std::nothrow) File;
  if (file == nullptr) {
    return nullptr;
  }
  file->descriptor = descriptor;
  file->shared = *settings;
  return &file->common;
}

herr_t close(H5FD_t* closed) {
  File* file = &of(closed);
  file->shared->size = file->allocated;
  if (::ftruncate(file->descriptor, static_cast<off_t>(file->allocated)) != 0) {
    keep_error(*file);
  }
  if (::close(file->descriptor) != 0) {
    keep_error(*file);
  }
  delete file;
  return 0;
}

// What HDF5's own driver for files answers, so that the file is laid out as it would be by that.
herr_t query(const H5FD_t*, unsigned long* features) {
  *features = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
              H5FD_FEAT_AGGREGATE_SMALLDATA;
  return 0;
}

haddr_t end_allocated(const H5FD_t* file, H5FD_mem_t) {
  return of(file).allocated;
}
herr_t set_end_allocated(H5FD_t* file, H5FD_mem_t, haddr_t end) {
  of(file).allocated = end;
  return 0;
}
haddr_t end_of_file(const H5FD_t* file, H5FD_mem_t) {
  return of(file).allocated;
}

// What was never written is zero.
herr_t read(H5FD_t* from, H5FD_mem_t, hid_t, haddr_t place, std::size_t bytes, void* out) {
  auto* to = static_cast<char*>(out);
  while (bytes > 0) {
    const ssize_t got = ::pread(of(from).descriptor, to, bytes, static_cast<off_t>(place));
    if (got < 0 && errno == EINTR) {
      continue;
    }
    if (got <= 0) {
      std::memset(to, 0, bytes);
      return 0;
    }
    to += got;
    place += static_cast<haddr_t>(got);
    bytes -= static_cast<std::size_t>(got);
  }
  return 0;
}

herr_t write(H5FD_t* to, H5FD_mem_t, hid_t, haddr_t place, std::size_t bytes, const void* values) {
  File& file = of(to);
  if (values == file.shared->left_out) {
    file.shared->left_out = nullptr;
    file.shared->place = place;
    return 0;
  }
  try {
    write_at(file.descriptor, {static_cast<const std::byte*>(values), bytes}, place);
  } catch (...) {
    keep_error(file);
  }
  return 0;
}

H5FD_class_t driver() {
  H5FD_class_t made{};
#if H5_VERSION_GE(1, 13, 0)
  made.version = H5FD_CLASS_VERSION;
  made.value = static_cast<H5FD_class_value_t>(499);  // 256 to 511 are for tests and drivers of one program
#endif
  made.name = "laid out";
  made.maxaddr = (haddr_t{1} << 62) - 1;
  made.fc_degree = H5F_CLOSE_WEAK;
  made.fapl_size = sizeof(Shared*);
  made.fapl_copy = copy_settings;
  made.fapl_free = free_settings;
  made.open = open;
  made.close = close;
  made.query = query;
  made.get_eoa = end_allocated;
  made.set_eoa = set_end_allocated;
  made.get_eof = end_of_file;
  made.read = read;
  made.write = write;
  const H5FD_mem_t one_for_all[H5FD_MEM_NTYPES] = H5FD_FLMAP_DICHOTOMY;
  std::copy(std::begin(one_for_all), std::end(one_for_all), made.fl_map);
  return made;
}

}  // namespace

LaidOutFile::LaidOutFile(const std::string& path) : path_(path), shared_(std::make_unique<Shared>()) {
  const std::string action = "make the file " + path;
  static const H5FD_class_t kind = driver();
  driver_ = own(H5FDregister(&kind), action);
  const Id access = own(H5Pcreate(H5P_FILE_ACCESS), action);
  Shared* const settings = shared_.get();
  check(H5Pset_driver(access.get(), driver_.get(), &settings), action);
  file_ = own(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.get()), action);
}

LaidOutFile::~LaidOutFile() = default;

std::uint64_t LaidOutFile::place(hid_t variable, std::size_t case_in_file, std::size_t bytes) {
  const std::byte unread{};
  shared_->left_out = &unread;
  put_chunk(variable, case_in_file, {&unread, bytes});
  if (std::exchange(shared_->left_out, nullptr) != nullptr) {
    throw base::InternalError("cannot lay out the file " + path_ + ": HDF5 writes values late");
  }
  return shared_->place;
}

void LaidOutFile::close() {
  if (!file_.reset()) {
    throw base::InternalError("cannot close the file " + path_ + ": " + last_error());
  }
  reserve(path_, shared_->size);
  if (shared_->error != 0) {
    throw base::InternalError("cannot write the file " + path_ + ": " + std::strerror(shared_->error));
  }
}

}  // namespace gaiter::archive
