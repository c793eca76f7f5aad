// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>

#include <csignal>

namespace gaiter::archive {

// Throws base::InputError unless a file can be written at `path`, which the user gave to `option`: a name
// with this ending, in a folder that exists and takes new files. Meant to be called before any work is done;
// one rank is enough.
void check_writable(const std::string& path, const std::string& option = "-output",
                    const std::string& ending = ".h5");

std::string folder_of(const std::string& path);

// A name beside `path` that nobody else uses, on any machine; it ends in .tmp.
std::string temporary_name(const std::string& path);

// Writes the pieces one after the other to `temporary`, a new file, brings it to the disk and renames it to
// `path`: after a kill or a loss of power at any moment there is the whole new file or what was there before.
// Throws base::InternalError with the system's reason, and then leaves nothing behind.
void write_durably(const std::string& path, const std::string& temporary,
                   std::initializer_list<std::span<const std::byte>> pieces);

// Writes all of the bytes at a place of an open file. Throws base::InternalError with the system's reason.
void write_at(int descriptor, std::span<const std::byte> bytes, std::uint64_t place);

// The second half of that: brings a written file to the disk and renames it.
void publish(const std::string& temporary, const std::string& path);

// Takes the blocks for a file of this size without changing the size; throws base::InternalError if the disk,
// a quota or a limit does not allow it. Where a file system cannot take blocks ahead nothing is known.
void reserve(const std::string& path, std::size_t bytes);

// While it lives, a file that grows beyond the limit of the process (ulimit -f) is an error of the call, as a
// full disk is, and not the end of the process.
class LimitIsAnError {
 public:
  LimitIsAnError();
  ~LimitIsAnError();
  LimitIsAnError(const LimitIsAnError&) = delete;
  LimitIsAnError& operator=(const LimitIsAnError&) = delete;

 private:
  struct sigaction before_ {};
};

}  // namespace gaiter::archive
