// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstddef>
#include <string>

#include "gaiter/archive/layout.hpp"
#include "gaiter/archive/provenance.hpp"
#include "gaiter/archive/run_folder.hpp"

namespace gaiter::archive {

// Writes the archive of all chunks to `path`, a new file. Compressed values are copied as they are, so that
// it takes little more than the time of copying the files, and memory for one variable of one chunk. Serial.
// Throws base::InternalError; then the file is of no use.
void merge_chunks(const std::string& path, const RunFolder& folder, const Layout& layout,
                  const Provenance& provenance, std::size_t chunk_cases);

}  // namespace gaiter::archive
