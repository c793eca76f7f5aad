// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "gaiter/archive/compression.hpp"
#include "gaiter/archive/hdf5.hpp"
#include "gaiter/archive/layout.hpp"
#include "gaiter/archive/memory_file.hpp"
#include "gaiter/archive/provenance.hpp"
#include "gaiter/archive/table_file.hpp"

namespace gaiter::archive {

// What the making of one file leaves to the next: to have memory anew costs as much as to fill it.
struct Workspace {
  Compressor compressor;
  std::vector<std::byte> values;
  SpareMemory spare;
  std::size_t file_bytes = std::size_t{1} << 20;  // of the largest file so far, and a little more
};

// An HDF5 file with these cases, in memory, and where its values lie, in the order of variables_of().
// `range.count` may be less than `range.chunk`: then the chunk is filled up, as the last one of a long
// variable is. Throws base::InternalError.
class FileOfCases {
 public:
  FileOfCases(const Layout& layout, const Provenance& provenance, const CaseRange& range,
              const CaseResults& results, bool newest_format, Workspace& workspace);
  std::span<const std::byte> bytes() const { return bytes_; }
  std::span<const Extent> places() const { return places_; }

 private:
  MemoryFile file_;
  std::vector<Extent> places_;
  std::span<const std::byte> bytes_;
};

// Writes an archive of all cases at once, from one rank, and replaces what was there only once it is whole.
// Throws base::InternalError that begins with "-output PATH: ".
void write_archive(const std::string& path, const Layout& layout, const Provenance& provenance,
                   const CaseResults& results);

// What one chunk's file has behind its HDF5 bytes and the places of its values (readers of HDF5 do not look
// there): by it a file torn by a loss of power, or damaged, or of another sweep is known.
struct Seal {
  char mark[8];
  std::uint64_t sweep;  // a number that sweeps differ in
  std::uint64_t bytes;  // before the seal
  std::uint64_t check;  // their Adler-32
};

Seal seal_of(std::uint64_t sweep, const FileOfCases& file);

// The places of the values in the file of a chunk that is known to be sound.
std::vector<Extent> places_in(const std::string& path, std::size_t variables);

enum class ChunkState { missing, damaged, foreign, sound };

// Reads the whole file. Throws base::InternalError if it is there and cannot be read.
ChunkState examine_chunk(const std::string& path, std::uint64_t sweep);

}  // namespace gaiter::archive
