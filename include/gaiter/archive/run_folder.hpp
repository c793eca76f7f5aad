// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace gaiter::archive {

// FILE.h5.parts beside the archive FILE.h5 while a run lasts: the files of the chunks, and the lock by which
// a run holds the archive. The system drops the lock when the process ends, in whatever way.
class RunFolder {
 public:
  explicit RunFolder(const std::string& archive_path);
  ~RunFolder();  // drops the lock, leaves the folder
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  const std::string& path() const { return path_; }
  bool exists() const;
  std::string chunk_path(std::size_t chunk) const;
  std::string chunk_path_from_archive(std::size_t chunk) const;  // relative to the archive's folder
  std::string temporary(const std::string& name) const;          // for a file that is being written

  // Makes the folder if need be and takes the lock. Throws base::InputError if the folder cannot be made or
  // another run holds it. On one rank of a run.
  void lock();

  // For each chunk, whether it has a file. The folder is listed, which shows what other machines have
  // stored where questions for single files may be answered from memory.
  std::vector<char> stored(std::size_t chunks) const;

  void remove_temporaries() const;
  void remove() const;  // with all that is in it; what cannot be removed stays

 private:
  std::string path_;
  std::string name_;
  int lock_ = -1;
};

}  // namespace gaiter::archive
