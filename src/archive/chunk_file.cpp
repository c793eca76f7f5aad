// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/archive/chunk_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>

#include "gaiter/archive/compression.hpp"
#include "gaiter/archive/durable_file.hpp"
#include "gaiter/archive/table_file.hpp"
#include "gaiter/base/error.hpp"

namespace gaiter::archive {
namespace {

constexpr char mark[8] = {'g', 'a', 'i', 't', 'e', 'r', ' ', '2'};

}  // namespace

FileOfCases::FileOfCases(const Layout& layout, const Provenance& provenance, const CaseRange& range,
                         const CaseResults& results, bool newest_format, Workspace& workspace)
    : file_(newest_format, workspace.file_bytes) {
  const QuietErrors quiet;
  require_complete(layout, range.count, results);
  {
    const std::vector<Id> made = fill_file(file_.get(), layout, provenance, range);
    const std::vector<FileVariable> variables = variables_of(layout);
    std::vector<std::byte>& values = workspace.values;
    for (std::size_t i = 0; i < variables.size(); ++i) {
      const std::size_t item = bytes_of(variables[i].stored);
      const std::size_t rows = variables[i].per_segment ? layout.segments.size() : 1;
      const std::size_t filled = range.count * rows * item, all = range.chunk * rows * item;
      if (values.size() < all) {
        values.resize(all);
      }
      std::fill_n(values.begin() + static_cast<std::ptrdiff_t>(filled), all - filled, std::byte{0});
      gather(variables[i], results, values.data());
      put_chunk(made[i].get(), 0, workspace.compressor.compress(std::span(values).first(all), item));
      places_.push_back(place_of_first_chunk(made[i].get()));
    }
  }
  bytes_ = file_.close();
  workspace.file_bytes = std::max(workspace.file_bytes, bytes_.size() + bytes_.size() / 32);
}

void write_archive(const std::string& path, const Layout& layout, const Provenance& provenance,
                   const CaseResults& results) {
  try {
    const CaseRange all{0, layout.cases, layout.cases};
    Workspace workspace;
    const FileOfCases file(layout, provenance, all, results, false, workspace);
    write_durably(path, temporary_name(path), {file.bytes()});
  } catch (const std::exception& error) {
    throw base::InternalError("-output " + path + ": " + error.what());
  }
}

Seal seal_of(std::uint64_t sweep, const FileOfCases& file) {
  const auto places = std::as_bytes(file.places());
  Seal seal{};
  std::memcpy(seal.mark, mark, sizeof mark);
  seal.sweep = sweep;
  seal.bytes = file.bytes().size() + places.size();
  seal.check = adler32(adler32(1, file.bytes()), places);
  return seal;
}

std::vector<Extent> places_in(const std::string& path, std::size_t variables) {
  std::vector<Extent> places(variables);
  const auto bytes = static_cast<std::streamoff>(variables * sizeof(Extent));
  std::ifstream file(path, std::ios::binary);
  file.seekg(-bytes - static_cast<std::streamoff>(sizeof(Seal)), std::ios::end);
  if (!file.read(reinterpret_cast<char*>(places.data()), bytes)) {
    throw base::InternalError("cannot read " + path + ": " + std::strerror(errno));
  }
  return places;
}

ChunkState examine_chunk(const std::string& path, std::uint64_t sweep) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
  if (!file) {
    if (errno == ENOENT) {
      return ChunkState::missing;
    }
    throw base::InternalError("cannot open " + path + ": " + std::strerror(errno));
  }
  // The last bytes of the file are looked at as they come by.
  std::vector<std::byte> buffer(std::size_t{1} << 20);
  std::vector<std::byte> tail;
  std::uint32_t check = 1;
  std::uint64_t bytes = 0;
  while (const std::size_t got = std::fread(buffer.data(), 1, buffer.size(), file.get())) {
    tail.insert(tail.end(), buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(got));
    if (tail.size() > sizeof(Seal)) {
      const std::size_t passed = tail.size() - sizeof(Seal);
      check = adler32(check, std::span<const std::byte>(tail).first(passed));
      bytes += passed;
      tail.erase(tail.begin(), tail.begin() + static_cast<std::ptrdiff_t>(passed));
    }
  }
  if (std::ferror(file.get()) != 0) {
    throw base::InternalError("cannot read " + path + ": " + std::strerror(errno));
  }
  if (tail.size() < sizeof(Seal)) {
    return ChunkState::damaged;
  }
  Seal seal;
  std::memcpy(&seal, tail.data(), sizeof seal);
  if (std::memcmp(seal.mark, mark, sizeof mark) != 0 || seal.bytes != bytes || seal.check != check) {
    return ChunkState::damaged;
  }
  return seal.sweep == sweep ? ChunkState::sound : ChunkState::foreign;
}

}  // namespace gaiter::archive
