// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gaiter/archive/layout.hpp"
#include "gaiter/archive/provenance.hpp"

namespace gaiter::archive {

// What tells one sweep from another, of an archive that is there already or of one that is asked for.
struct Identity {
  int schema = 0;
  std::string gaiter_version;
  std::string petsc_version;
  std::string options;  // lines `name: value`
  std::size_t cases = 0;
  std::size_t chunk_cases = 0;
  std::vector<std::string> segments;
  std::vector<std::string> variables;  // sorted names, dimensions left out

  bool operator==(const Identity&) const = default;
};

struct ExistingArchive {
  bool finished = false;
  Identity identity;
};

Identity identity_of(const Layout& layout, const Provenance& provenance, std::size_t chunk_cases);

// Nothing if there is no such file. Throws base::InputError if it is no archive. Serial.
std::optional<ExistingArchive> look_at(const std::string& path);

// What differs, as one line for the user, with both values; empty if nothing does. The size of chunks does
// not count once an archive is finished.
std::string difference(const ExistingArchive& there, const Identity& asked);

// A number in which different identities differ (FNV-1a, 64 bits).
std::uint64_t number_of(const Identity& identity);

}  // namespace gaiter::archive
