// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/archive/existing_archive.hpp"

#include <hdf5.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <sstream>

#include "gaiter/archive/attributes.hpp"
#include "gaiter/archive/table_file.hpp"
#include "gaiter/base/error.hpp"

namespace gaiter::archive {
namespace {

constexpr std::size_t most_named = 6;     // differences that one message names
constexpr std::size_t most_letters = 60;  // of a value in a message

[[noreturn]] void refuse() {
  throw base::InputError("this file is there already and is no archive of gaiter; choose another name");
}

std::vector<std::string> names_in(hid_t file) {
  H5G_info_t root;
  check(H5Gget_info(file, &root), "list the variables");
  std::vector<std::string> names;
  for (hsize_t i = 0; i < root.nlinks; ++i) {
    std::array<char, 256> name{};
    const ssize_t length =
        H5Lget_name_by_idx(file, ".", H5_INDEX_NAME, H5_ITER_INC, i, name.data(), name.size(), H5P_DEFAULT);
    check(length < 0 ? -1 : 0, "list the variables");
    if (name.data() != std::string("case") && name.data() != std::string("segment")) {
      names.emplace_back(name.data());
    }
  }
  return names;
}

void read_cases(hid_t file, Identity& identity) {
  const Id cases = own(H5Dopen2(file, "case", H5P_DEFAULT), "open variable case");
  const Id space = own(H5Dget_space(cases.get()), "read variable case");
  const Id properties = own(H5Dget_create_plist(cases.get()), "read variable case");
  identity.cases = static_cast<std::size_t>(H5Sget_simple_extent_npoints(space.get()));
  hsize_t chunk = 0;
  if (H5Pget_chunk(properties.get(), 1, &chunk) == 1) {
    identity.chunk_cases = chunk;
  }
}

void read_segments(hid_t file, Identity& identity) {
  const Id segments = own(H5Dopen2(file, "segment", H5P_DEFAULT), "open variable segment");
  const Id space = own(H5Dget_space(segments.get()), "read variable segment");
  const Id type = text_type();
  std::vector<char*> pointers(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space.get())), nullptr);
  check(H5Dread(segments.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, pointers.data()),
        "read variable segment");
  for (const char* pointer : pointers) {
    identity.segments.emplace_back(pointer == nullptr ? "" : pointer);
  }
  check(H5Dvlen_reclaim(type.get(), space.get(), H5P_DEFAULT, pointers.data()), "read variable segment");
}

int read_schema(hid_t file) {
  const Id attribute = own(H5Aopen(file, "schema_version", H5P_DEFAULT), "open attribute schema_version");
  int value = 0;
  check(H5Aread(attribute.get(), H5T_NATIVE_INT, &value), "read attribute schema_version");
  return value;
}

std::map<std::string, std::string> lines_of(const std::string& options) {
  std::map<std::string, std::string> lines;
  std::istringstream text(options);
  for (std::string line; std::getline(text, line);) {
    const std::size_t colon = line.find(": ");
    const std::string name = line.substr(0, colon);
    if (!name.empty()) {
      lines[name] = colon == std::string::npos ? "" : line.substr(colon + 2);
    }
  }
  return lines;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) {
    text.append(text.empty() ? "" : ",").append(word);
  }
  return text;
}

// Where the two begin to differ is always shown.
std::string shortened(const std::string& value, const std::string& other) {
  if (value.size() <= most_letters) {
    return value;
  }
  const auto same = static_cast<std::size_t>(
      std::mismatch(value.begin(), value.end(), other.begin(), other.end()).first - value.begin());
  const std::size_t from = same < most_letters / 2 ? 0 : same - most_letters / 2;
  return (from > 0 ? "..." : "") + value.substr(from, most_letters) +
         (from + most_letters < value.size() ? "..." : "");
}

std::string pair_of(const std::string& name, const std::string& there, const std::string& asked) {
  return name + " " + shortened(there, asked) + " (now " + shortened(asked, there) + ")";
}

std::vector<std::string> differing_options(const std::string& there, const std::string& asked) {
  const auto old_lines = lines_of(there);
  const auto new_lines = lines_of(asked);
  std::map<std::string, std::string> all = old_lines;
  all.insert(new_lines.begin(), new_lines.end());
  const auto value = [](const auto& lines, const std::string& name) {
    const auto found = lines.find(name);
    return found == lines.end() ? std::string("not given") : found->second;
  };
  std::vector<std::string> differing;
  for (const auto& [name, text] : all) {
    if (value(old_lines, name) != value(new_lines, name)) {
      differing.push_back(pair_of("-" + name, value(old_lines, name), value(new_lines, name)));
    }
  }
  return differing;
}

}  // namespace

Identity identity_of(const Layout& layout, const Provenance& provenance, std::size_t chunk_cases) {
  Identity identity{schema_version,
                    provenance.gaiter_version,
                    provenance.petsc_version,
                    provenance.options,
                    layout.cases,
                    chunk_cases,
                    layout.segments,
                    {}};
  for (const FileVariable& variable : variables_of(layout)) {
    identity.variables.push_back(variable.name);
  }
  std::sort(identity.variables.begin(), identity.variables.end());
  return identity;
}

std::optional<ExistingArchive> look_at(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) {
    return std::nullopt;
  }
  const QuietErrors quiet;
  const Id file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
  if (file.get() < 0 || H5Aexists(file.get(), "schema_version") <= 0) {
    refuse();
  }
  try {
    ExistingArchive archive;
    archive.finished = H5Aexists(file.get(), incomplete_attribute) <= 0;
    archive.identity.schema = read_schema(file.get());
    archive.identity.gaiter_version = get_text(file.get(), "gaiter_version");
    archive.identity.petsc_version = get_text(file.get(), "petsc_version");
    archive.identity.options = get_text(file.get(), "options");
    archive.identity.variables = names_in(file.get());
    read_cases(file.get(), archive.identity);
    read_segments(file.get(), archive.identity);
    return archive;
  } catch (const base::InternalError&) {
    refuse();
  }
}

std::string difference(const ExistingArchive& there, const Identity& asked) {
  const Identity& old = there.identity;
  const std::string kind = there.finished ? "a finished archive" : "an unfinished archive";
  if (old.schema != asked.schema || old.gaiter_version != asked.gaiter_version ||
      old.petsc_version != asked.petsc_version) {
    return kind + " of another program is there: of gaiter " + old.gaiter_version + " with PETSc " +
           old.petsc_version + " (now gaiter " + asked.gaiter_version + " with PETSc " + asked.petsc_version +
           ")" + "; choose another name or remove it";
  }
  std::vector<std::string> differing = differing_options(old.options, asked.options);
  if (differing.empty()) {
    const auto compare = [&](const std::string& name, const std::string& before, const std::string& now) {
      if (before != now) {
        differing.push_back(pair_of(name, before, now));
      }
    };
    compare("segments", joined(old.segments), joined(asked.segments));
    compare("cases", std::to_string(old.cases), std::to_string(asked.cases));
    compare("-output_variables", joined(old.variables), joined(asked.variables));
    if (!there.finished) {
      compare("cases a chunk", std::to_string(old.chunk_cases), std::to_string(asked.chunk_cases));
    }
  }
  if (differing.empty()) {
    return "";
  }
  std::string text = kind + " is there, of a sweep with other options: ";
  for (std::size_t i = 0; i < std::min(differing.size(), most_named); ++i) {
    text += (i > 0 ? ", " : "") + differing[i];
  }
  if (differing.size() > most_named) {
    text += " and " + std::to_string(differing.size() - most_named) + " more";
  }
  return text + "; choose another name or remove it";
}

std::uint64_t number_of(const Identity& identity) {
  std::ostringstream text;
  const auto add = [&](const auto& item) { text << item << '\0'; };
  add(identity.schema);
  add(identity.gaiter_version);
  add(identity.petsc_version);
  add(identity.options);
  add(identity.cases);
  add(identity.chunk_cases);
  add(joined(identity.segments));
  add(joined(identity.variables));
  std::uint64_t number = 0xcbf29ce484222325;
  for (const char letter : text.str()) {
    number = (number ^ static_cast<unsigned char>(letter)) * 0x100000001b3;
  }
  return number;
}

}  // namespace gaiter::archive
