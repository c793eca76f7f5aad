// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/program.hpp"

#include <fmt/core.h>
#include <petscsys.h>

#include <algorithm>

#include "gaiter/archive/agree.hpp"
#include "gaiter/archive/chunk_file.hpp"
#include "gaiter/archive/durable_file.hpp"
#include "gaiter/base/error.hpp"
#include "gaiter/base/version.hpp"
#include "gaiter/studies/help.hpp"
#include "gaiter/studies/paper_comparison.hpp"
#include "gaiter/studies/result_table.hpp"
#include "gaiter/studies/scene_options.hpp"
#include "gaiter/studies/solve.hpp"
#include "gaiter/studies/solver_options.hpp"

namespace gaiter::studies {

namespace {

constexpr std::size_t most_tables = 10;  // designs of a sweep that are printed one by one

// Every rank looks, for each may sit on a machine of its own; all refuse together.
void check_writable(const std::string& output) {
  std::string refusal;
  try {
    archive::check_writable(output);
  } catch (const base::InputError& error) {
    refusal = error.what();
  }
  if (petsc::agree(PETSC_COMM_WORLD, refusal.empty())) return;
  throw base::InputError(!refusal.empty() ? refusal
                                          : "-output " + output + ": some ranks cannot write there");
}

// All designs at once, from the first rank.
void write_archive(const Request& request, const Designs& designs, const CommandLine& line,
                   const Solution& solution) {
  archive::Layout layout{static_cast<std::size_t>(designs.size()), {}, {}, {}};
  for (const model::Segment& segment : request.scene.leg.segments) layout.segments.push_back(segment.name);
  std::vector<std::vector<double>> values;
  for (std::size_t axis = 0; axis < designs.axes().size(); ++axis) {
    const SweepAxis& swept = designs.axes()[axis];
    layout.swept.push_back({swept.name, std::string(swept.option->unit()), std::string(swept.option->doc)});
    for (std::int64_t design = 0; design < designs.size(); ++design) {
      if (design == 0) values.emplace_back();
      values.back().push_back(designs.value(axis, design));
    }
  }
  const archive::Provenance provenance =
      archive::describe_run(PETSC_COMM_WORLD, base::version, request.text, line.typed);
  const std::vector<model::SegmentResult> rows = gather(PETSC_COMM_WORLD, solution);
  // The designs are solved together: each took its share.
  const std::vector<double> share(layout.cases, solution.seconds / static_cast<double>(layout.cases));
  archive::Failure failure;
  try {
    if (petsc::rank(PETSC_COMM_WORLD) == 0)
      archive::write_archive(request.output, layout, provenance, {rows, share, values});
  } catch (const base::InternalError& error) {
    failure.message = error.what();
  }
  archive::throw_if_any_failed(PETSC_COMM_WORLD, failure);
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
  if (line.help) {
    if (printing) fmt::print("{}", line.help == "markdown" ? help_markdown() : help_text());
    return success;
  }
  const Command command = parse_command(line.command);
  for (const std::string& file : line.options_files) session.insert_options_file(file);
  const auto given = session.unused_options();
  Request request = parse_request(command, given);
  ForeignOptions foreign;
  for (const std::string& name : request.unknown) foreign[name] = given.at(name);
  for (const auto& [name, text] : given)
    if (!foreign.contains(name)) session.mark_used(name);
  check_foreign_options(session, request.scene, foreign);
  request.text += solver_settings(foreign);
  const Designs designs(request.axes);
  if (request.comparison == Comparison::paper) require_paper_segments(request.scene);
  if (request.dry_run) {
    if (printing)
      fmt::print("{}# {} designs of {} segments\n", request.text, designs.size(),
                 request.scene.leg.segments.size());
    return success;
  }
  check_writable(request.output);

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
