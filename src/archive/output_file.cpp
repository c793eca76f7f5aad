// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/archive/output_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <utility>

#include "gaiter/base/error.hpp"

namespace gaiter::archive {
namespace {

std::string folder_of(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  return folder.empty() ? "." : folder.string();
}

void bring_to_disk(const std::string& path, int flags) {
  const int descriptor = ::open(path.c_str(), flags | O_CLOEXEC);
  bool ok = descriptor >= 0 && ::fsync(descriptor) == 0;
  const int reason = errno;
  // Some file systems cannot sync a folder and say so; the rename is then as safe as they make it.
  ok = ok || ((flags & O_DIRECTORY) != 0 && reason == EINVAL);
  if (descriptor >= 0) {
    ::close(descriptor);
  }
  if (!ok) {
    throw base::InternalError("cannot bring " + path + " to the disk: " + std::strerror(reason));
  }
}

}  // namespace

void check_writable(const std::string& path, const std::string& option, const std::string& ending) {
  const auto refuse = [&](const std::string& reason) {
    throw base::InputError(option + " " + path + ": " + reason);
  };
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    refuse("this is a folder; give the name of a file that ends in " + ending);
  }
  if (std::filesystem::path(path).extension() != ending) {
    refuse("the name must end in " + ending);
  }
  if (std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored)) {
    refuse("this is there already and is not a file that can be replaced");
  }
  const std::string folder = folder_of(path);
  if (!std::filesystem::is_directory(folder, ignored)) {
    refuse("the folder " + folder + " does not exist");
  }
  // Permissions, read-only mounts, quotas, too long names: only trying tells. The name is unique, so that any
  // number of ranks may try at once.
  std::string probe = path + ".XXXXXX";
  const int descriptor = ::mkstemp(probe.data());
  if (descriptor < 0) {
    refuse("no file can be made in the folder " + folder + ": " + std::strerror(errno));
  }
  ::close(descriptor);
  ::unlink(probe.c_str());
}

OutputFile::OutputFile(std::string final_path)
    : final_path_(std::move(final_path)), part_path_(final_path_ + ".part") {}

OutputFile::~OutputFile() {
  if (!released_) {
    ::unlink(part_path_.c_str());
  }
}

void OutputFile::make_room(std::size_t bytes) {
  const int descriptor = ::open(part_path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  const int opened = descriptor < 0 ? errno : 0;
  const int failed = descriptor < 0 ? opened : ::posix_fallocate(descriptor, 0, static_cast<off_t>(bytes));
  if (descriptor >= 0) {
    ::close(descriptor);
  }
  if (failed != 0) {
    throw base::InternalError("cannot make room for " + std::to_string(bytes) +
                              " bytes: " + std::strerror(failed));
  }
}

void OutputFile::publish() {
  bring_to_disk(part_path_, O_RDONLY);
  if (std::rename(part_path_.c_str(), final_path_.c_str()) != 0) {
    throw base::InternalError("cannot rename " + part_path_ + ": " + std::strerror(errno));
  }
  bring_to_disk(folder_of(final_path_), O_RDONLY | O_DIRECTORY);
}

}  // namespace gaiter::archive
