// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstddef>
#include <string>

namespace gaiter::archive {

// Throws base::InputError unless a file can be written at `path`, which the user gave to `option`: a name
// with this ending, in a folder that exists and takes new files. Meant to be called before any work is done;
// one rank is enough.
void check_writable(const std::string& path, const std::string& option = "-output",
                    const std::string& ending = ".h5");

// A file that is written beside its final name and gets that name only when it is finished.
class OutputFile {
 public:
  explicit OutputFile(std::string final_path);
  ~OutputFile();  // removes the unfinished file, if it is still there
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  const std::string& final_path() const { return final_path_; }
  const std::string& part_path() const { return part_path_; }

  // Makes the unfinished file anew and takes so much space for it, to see that the disk has it. Throws
  // base::InternalError. To be called on one rank.
  void make_room(std::size_t bytes);

  // Brings the content to the disk and renames. Throws base::InternalError. To be called on one rank ...
  void publish();
  // ... and this on every rank, once publish() has succeeded.
  void release() { released_ = true; }

 private:
  std::string final_path_;
  std::string part_path_;
  bool released_ = false;
};

}  // namespace gaiter::archive
