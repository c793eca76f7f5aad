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
// Variables whose values are taken out of the rows together, and of so many cases at a time: what a row holds
// is then still at hand for the next variable.
constexpr std::size_t variables_at_once = 8, cases_at_once = 64;

// Bytes of a variable's values in a whole chunk.
std::size_t bytes_in_chunk(const FileVariable& variable, const CaseRange& range, std::size_t segments) {
  return range.chunk * (variable.per_segment ? segments : 1) * bytes_of(variable.stored);
}

// The values of some variables, one after the other, each for a whole chunk; cases that the range has not are
// 0.
void gather(std::span<const FileVariable> variables, const CaseRange& range, std::size_t segments,
            const CaseResults& results, std::vector<std::byte>& values) {
  std::vector<std::size_t> begin{0};
  for (const FileVariable& variable : variables) {
    begin.push_back(begin.back() + bytes_in_chunk(variable, range, segments));
  }
  if (values.size() < begin.back()) {
    values.resize(begin.back());
  }
  for (std::size_t i = 0; i < variables.size(); ++i) {
    const std::size_t filled = (begin[i + 1] - begin[i]) / range.chunk * range.count;
    std::fill(values.data() + begin[i] + filled, values.data() + begin[i + 1], std::byte{0});
    if (!variables[i].per_segment) {
      gather(variables[i], results, values.data() + begin[i]);
    }
  }
  for (std::size_t first = 0; first < range.count; first += cases_at_once) {
    const std::size_t cases = std::min(cases_at_once, range.count - first);
    const CaseResults some{results.rows.subspan(first * segments, cases * segments), {}, {}};
    for (std::size_t i = 0; i < variables.size(); ++i) {
      if (variables[i].per_segment) {
        const std::size_t before = (begin[i + 1] - begin[i]) / range.chunk * first;
        gather(variables[i], some, values.data() + begin[i] + before);
      }
    }
  }
}

}  // namespace

FileOfCases::FileOfCases(const Layout& layout, const Provenance& provenance, const CaseRange& range,
                         const CaseResults& results, bool newest_format, Workspace& workspace)
    : file_(newest_format, workspace.file_bytes, &workspace.spare) {
  const QuietErrors quiet;
  require_complete(layout, range.count, results);
  {
    const std::vector<Id> made = fill_file(file_.get(), layout, provenance, range);
    const std::vector<FileVariable> variables = variables_of(layout);
    const std::size_t segments = layout.segments.size();
    std::size_t begin = 0;
    for (std::size_t i = 0; i < variables.size(); ++i) {
      if (i % variables_at_once == 0) {
        const auto some = std::span(variables).subspan(i);
        gather(some.first(std::min(variables_at_once, some.size())), range, segments, results,
               workspace.values);
        begin = 0;
      }
      const std::size_t bytes = bytes_in_chunk(variables[i], range, segments);
      const auto values = std::span(workspace.values).subspan(begin, bytes);
      begin += bytes;
      put_chunk(made[i].get(), 0, workspace.compressor.compress(values, bytes_of(variables[i].stored)));
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
