// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/report.hpp"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "gaiter/archive/agree.hpp"
#include "gaiter/archive/durable_file.hpp"
#include "gaiter/archive/existing_archive.hpp"
#include "gaiter/base/error.hpp"
#include "gaiter/base/text.hpp"
#include "gaiter/petsc/session.hpp"
#include "gaiter/studies/report_script.hpp"

namespace gaiter::studies {

namespace {

struct Names {
  std::string archive, page;
};

Names names_in(const std::map<std::string, std::string>& given) {
  Names names;
  for (const auto& [name, text] : given) {
    const std::string lower_name = base::lower(name);
    if (lower_name != "archive" && lower_name != "output")
      throw base::InputError(fmt::format("-{} '{}': report takes -archive and -output alone", name, text));
    (lower_name == "archive" ? names.archive : names.page) = base::trim(text);
  }
  if (names.archive.empty())
    throw base::InputError("-archive is missing: the file to draw, e.g. -archive gaiter.h5");
  if (names.page.empty()) names.page = std::filesystem::path(names.archive).replace_extension(".html");
  return names;
}

void require_archive(const std::string& path) {
  try {
    if (archive::look_at(path)) return;
  } catch (const base::InputError&) {
  }
  throw base::InputError(fmt::format("-archive '{}': must be a file that gaiter wrote", path));
}

void draw(const Names& names) {
  const char* const words[] = {python, "-c", report_script, names.archive.c_str(), names.page.c_str(),
                               nullptr};
  pid_t child = 0;
  if (const int error =
          posix_spawn(&child, python, nullptr, nullptr, const_cast<char* const*>(words), environ))
    throw base::InternalError(fmt::format("cannot start {}: {}", python, std::strerror(error)));
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw base::InternalError(fmt::format(
        "{} has failed; it needs h5py and matplotlib (python3-h5py, python3-matplotlib)", python));
}

}  // namespace

std::string write_report(MPI_Comm comm, const std::map<std::string, std::string>& given) {
  const Names names = names_in(given);
  archive::agreed(comm, "report", [&] {
    if (petsc::rank(comm) > 0) return;
    require_archive(names.archive);
    archive::check_writable(names.page, "-output", ".html");
    draw(names);
  });
  return names.page;
}

}  // namespace gaiter::studies
