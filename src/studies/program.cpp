// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/program.hpp"

#include <fmt/core.h>
#include <petscsys.h>

#include <algorithm>

#include "gaiter/archive/writer.hpp"
#include "gaiter/base/error.hpp"
#include "gaiter/base/version.hpp"
#include "gaiter/petsc/check.hpp"
#include "gaiter/petsc/error_capture.hpp"
#include "gaiter/solvers/slice_solver.hpp"
#include "gaiter/studies/help.hpp"
#include "gaiter/studies/paper_comparison.hpp"
#include "gaiter/studies/result_table.hpp"
#include "gaiter/studies/scene_options.hpp"
#include "gaiter/studies/solve.hpp"

namespace gaiter::studies {

namespace {

constexpr std::size_t most_tables = 10;  // designs of a sweep that are printed one by one

bool starts(const std::string& text, std::string_view with) {
  return text.rfind(with, 0) == 0;
}

bool ends(const std::string& text, std::string_view with) {
  return text.size() >= with.size() && text.compare(text.size() - with.size(), with.size(), with) == 0;
}

// Options that PETSc asks for only while it solves, or when it ends.
bool asked_for_later(const std::string& name) {
  const bool of_solver = starts(name, "slice_snes_") || starts(name, "slice_ksp_") ||
                         starts(name, "slice_pc_") || starts(name, "slice_mat_");
  if (of_solver)
    return ends(name, "_view") || ends(name, "_converged_reason") || name.find("_view_") != std::string::npos;
  for (const char* prefix : {"log_", "options_", "malloc_", "objects_", "info", "memory_"})
    if (starts(name, prefix)) return true;
  return false;
}

// Options that neither our table nor PETSc knows are misspelt. PETSc's are known by setting a solver up with
// them.
void refuse_unknown_options(const petsc::Session& session, const Request& request) {
  petsc::ErrorCapture quiet;
  try {
    solvers::SliceSolver(PETSC_COMM_WORLD, 1, request.scene.discretisation.slice_solver, 1);
  } catch (const base::InternalError&) {
    std::string given;
    for (const std::string& name : request.unknown)
      if (starts(name, "slice_")) given += " -" + name;
    throw base::InputError("the solver options" + given +
                           " are refused by PETSc: " + quiet.message().substr(0, quiet.message().find('\n')));
  }
  const auto unused = session.unused_options();
  for (const std::string& name : request.unknown)
    if (unused.count(name) && !asked_for_later(name)) throw unknown_option(name, request.scene.leg.segments);
}

archive::Layout layout_of(const Request& request, const Designs& designs) {
  archive::Layout layout{static_cast<std::size_t>(designs.size()), {}, {}};
  for (const model::Segment& segment : request.scene.leg.segments) layout.segments.push_back(segment.name);
  for (std::size_t axis = 0; axis < designs.axes().size(); ++axis) {
    const SweepAxis& swept = designs.axes()[axis];
    archive::SweptVariable variable{
        swept.name, std::string(swept.option->unit()), std::string(swept.option->doc), {}};
    for (std::int64_t design = 0; design < designs.size(); ++design)
      variable.values.push_back(designs.value(axis, design));
    layout.swept.push_back(std::move(variable));
  }
  return layout;
}

void write_archive(const Request& request, const Designs& designs, const CommandLine& line,
                   const Solution& solution) {
  const archive::Provenance provenance =
      archive::describe_run(PETSC_COMM_WORLD, base::version, request.text, line.typed);
  archive::Writer writer(PETSC_COMM_WORLD, request.output, layout_of(request, designs), provenance);
  writer.write(solution.first_row, solution.rows);
  // The designs are solved together: each took its share.
  const std::vector<double> share(petsc::rank(PETSC_COMM_WORLD) == 0 ? designs.size() : 0,
                                  solution.seconds / static_cast<double>(designs.size()));
  writer.write_wall_times(0, share);
  writer.close();
}

void print_results(const Request& request, const Designs& designs, const Solution& solution,
                   const std::array<double, 7>& counts) {
  const bool printing = petsc::rank(PETSC_COMM_WORLD) == 0;
  const auto count = static_cast<std::size_t>(designs.size());
  if (count <= most_tables) {
    const std::vector<model::SegmentResult> all = gather(PETSC_COMM_WORLD, solution);
    const std::size_t segments = request.scene.leg.segments.size();
    model::Scene scene = request.scene;
    for (std::size_t design = 0; printing && design < count; ++design) {
      designs.apply(static_cast<std::int64_t>(design), scene);
      for (std::size_t axis = 0; axis < designs.axes().size(); ++axis)
        fmt::print("{} = {:.6g} {}\n", designs.axes()[axis].name, designs.value(axis, design),
                   designs.axes()[axis].option->unit());
      fmt::print("{}\n", result_table(scene, std::span(all).subspan(design * segments, segments)));
    }
  }
  if (!printing) return;
  const double failed = counts[static_cast<std::size_t>(model::Status::no_equilibrium)] +
                        counts[static_cast<std::size_t>(model::Status::diverged)];
  if (count > 1 || failed > 0)
    fmt::print("{}", status_summary(counts, count, solution.seconds, request.output));
  if (request.comparison == Comparison::paper) fmt::print("{}\n", paper_comparison(request.scene));
  fmt::print("wrote {}\n", request.output);
}

}  // namespace

ExitCode run_program(petsc::Session& session, const CommandLine& line) {
  const bool printing = petsc::rank(PETSC_COMM_WORLD) == 0;
  if (line.help || line.command.empty()) {
    if (printing) fmt::print("{}", line.help == "markdown" ? help_markdown() : help_text());
    return line.help ? success : wrong_input;
  }
  const Command command = parse_command(line.command);
  for (const std::string& file : line.options_files) session.insert_options_file(file);
  const Request request = parse_request(command, session.unused_options());
  refuse_unknown_options(session, request);
  const Designs designs(request.axes);
  if (request.comparison == Comparison::paper) require_paper_segments(request.scene);
  if (request.dry_run) {
    if (printing)
      fmt::print("{}# {} designs of {} segments\n", request.text, designs.size(),
                 request.scene.leg.segments.size());
    return success;
  }
  archive::check_writable(request.output);

  const Solution solution = solve_designs(PETSC_COMM_WORLD, request.scene, designs);
  const std::array<double, 7> counts = count_status(PETSC_COMM_WORLD, solution);
  write_archive(request, designs, line, solution);
  print_results(request, designs, solution, counts);
  const bool trustworthy = counts[static_cast<std::size_t>(model::Status::no_equilibrium)] +
                               counts[static_cast<std::size_t>(model::Status::diverged)] ==
                           0;
  return trustworthy ? success : untrustworthy;
}

}  // namespace gaiter::studies
