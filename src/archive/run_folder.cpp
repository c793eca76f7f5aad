// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/archive/run_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>

#include "gaiter/archive/durable_file.hpp"
#include "gaiter/base/error.hpp"

namespace gaiter::archive {
namespace {

namespace fs = std::filesystem;

std::string chunk_name(std::size_t chunk) {
  char name[40];
  std::snprintf(name, sizeof name, "chunk-%06zu.h5", chunk);
  return name;
}

std::optional<std::size_t> chunk_number(const std::string& name) {
  std::size_t number = 0;
  if (std::sscanf(name.c_str(), "chunk-%zu.h5", &number) == 1 && name == chunk_name(number)) {
    return number;
  }
  return std::nullopt;
}

// Whether the open file is still the one of that name: a run that ends removes its lock.
bool still_there(int descriptor, const std::string& path) {
  struct stat opened {};
  struct stat named {};
  return ::fstat(descriptor, &opened) == 0 && ::stat(path.c_str(), &named) == 0 &&
         opened.st_ino == named.st_ino && opened.st_dev == named.st_dev;
}

}  // namespace

RunFolder::RunFolder(const std::string& archive_path)
    : path_(archive_path + ".parts"), name_(fs::path(path_).filename().string()) {}

RunFolder::~RunFolder() {
  if (lock_ >= 0) {
    ::close(lock_);
  }
}

bool RunFolder::exists() const {
  std::error_code ignored;
  return fs::is_directory(path_, ignored);
}

std::string RunFolder::chunk_path(std::size_t chunk) const {
  return path_ + "/" + chunk_name(chunk);
}

std::string RunFolder::chunk_path_from_archive(std::size_t chunk) const {
  return name_ + "/" + chunk_name(chunk);
}

std::string RunFolder::temporary(const std::string& name) const {
  return temporary_name(path_ + "/" + name);
}

void RunFolder::lock() {
  const std::string path = path_ + "/lock";
  for (;;) {
    if (::mkdir(path_.c_str(), 0777) != 0 && errno != EEXIST) {
      throw base::InputError("the folder " + path_ + " cannot be made: " + std::strerror(errno));
    }
    const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor < 0 && errno == ENOENT) {
      continue;  // another run has just removed the folder
    }
    if (descriptor < 0) {
      throw base::InputError("no file can be made in the folder " + path_ + ": " + std::strerror(errno));
    }
    // A file system that knows no locks (some cluster set-ups) leaves it to the user to start one run only.
    if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      ::close(descriptor);
      throw base::InputError("another run is writing this archive; wait for its end or choose another name");
    }
    if (still_there(descriptor, path)) {
      lock_ = descriptor;
      return;
    }
    ::close(descriptor);
  }
}

std::vector<char> RunFolder::stored(std::size_t chunks) const {
  std::vector<char> found(chunks, 0);
  std::error_code error;
  for (fs::directory_iterator entry(path_, error), end; !error && entry != end; entry.increment(error)) {
    const auto number = chunk_number(entry->path().filename().string());
    if (number && *number < chunks) {
      found[*number] = 1;
    }
  }
  if (error) {
    throw base::InternalError("cannot list " + path_ + ": " + error.message());
  }
  return found;
}

void RunFolder::remove_temporaries() const {
  std::error_code error;
  for (fs::directory_iterator entry(path_, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->path().extension() == ".tmp") {
      std::error_code ignored;
      fs::remove(entry->path(), ignored);
    }
  }
}

void RunFolder::remove() const {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace gaiter::archive
