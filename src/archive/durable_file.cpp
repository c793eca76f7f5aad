// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/archive/durable_file.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <random>
#include <sstream>

#include "gaiter/base/error.hpp"

namespace gaiter::archive {
namespace {

[[noreturn]] void fail(const std::string& action, int reason) {
  throw base::InternalError("cannot " + action + ": " + std::strerror(reason));
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
    fail("bring " + path + " to the disk", reason);
  }
}

void write_all(int descriptor, std::span<const std::byte> bytes, const std::string& path) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno != EINTR) {
      fail("write " + path, errno);
    }
    bytes = bytes.subspan(written > 0 ? static_cast<std::size_t>(written) : 0);
  }
}

void give_name(const std::string& temporary, const std::string& path) {
  if (std::rename(temporary.c_str(), path.c_str()) != 0) {
    fail("rename " + temporary + " to " + path, errno);
  }
  bring_to_disk(folder_of(path), O_RDONLY | O_DIRECTORY);
}

}  // namespace

std::string folder_of(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  return folder.empty() ? "." : folder.string();
}

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

std::string temporary_name(const std::string& path) {
  std::random_device device;
  std::ostringstream name;
  name << path << '.' << std::hex << device() << device() << ".tmp";
  return name.str();
}

void write_at(int descriptor, std::span<const std::byte> bytes, std::uint64_t place) {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(place));
    if (written < 0 && errno != EINTR) {
      fail("write values", errno);
    }
    const std::size_t done = written > 0 ? static_cast<std::size_t>(written) : 0;
    bytes = bytes.subspan(done);
    place += done;
  }
}

void publish(const std::string& temporary, const std::string& path) {
  bring_to_disk(temporary, O_RDONLY);
  give_name(temporary, path);
}

void write_durably(const std::string& path, const std::string& temporary,
                   std::initializer_list<std::span<const std::byte>> pieces) {
  const LimitIsAnError guard;
  const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    fail("make " + temporary, errno);
  }
  bool open = true;
  try {
    for (const auto piece : pieces) {
      write_all(descriptor, piece, path);
    }
    if (::fsync(descriptor) != 0) {
      fail("bring " + path + " to the disk", errno);
    }
    open = false;
    if (::close(descriptor) != 0) {  // where a network file system may first tell of a full disk
      fail("write " + path, errno);
    }
    give_name(temporary, path);
  } catch (...) {
    if (open) {
      ::close(descriptor);
    }
    ::unlink(temporary.c_str());
    throw;
  }
}

void reserve(const std::string& path, std::size_t bytes) {
  const std::string action = "make room for " + std::to_string(bytes) + " bytes";
  rlimit limit{};
  if (::getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY && limit.rlim_cur < bytes) {
    fail(action, EFBIG);
  }
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    fail("make " + path, errno);
  }
  const int reason =
      ::fallocate(descriptor, FALLOC_FL_KEEP_SIZE, 0, static_cast<off_t>(bytes)) == 0 ? 0 : errno;
  ::close(descriptor);
  if (reason != 0 && reason != EOPNOTSUPP && reason != ENOSYS) {
    fail(action, reason);
  }
}

LimitIsAnError::LimitIsAnError() {
  struct sigaction ignore {};
  ignore.sa_handler = SIG_IGN;
  ::sigaction(SIGXFSZ, &ignore, &before_);
}

LimitIsAnError::~LimitIsAnError() {
  ::sigaction(SIGXFSZ, &before_, nullptr);
}

}  // namespace gaiter::archive
