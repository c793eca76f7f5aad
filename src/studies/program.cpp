// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/program.hpp"

#include <fmt/core.h>
#include <petscsys.h>

#include <algorithm>

#include "gaiter/archive/writer.hpp"
#include "gaiter/base/error.hpp"
#include "gaiter/base/version.hpp"
#include "gaiter/studies/axisym_view.hpp"
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
void check_writable(const Request& request) {
  std::string refusal;
  try {
    archive::check_writable(request.output);
    check_views_writable(request);
  } catch (const base::InputError& error) {
    refusal = error.what();
  }
  if (petsc::agree(PETSC_COMM_WORLD, refusal.empty())) return;
  throw base::InputError(!refusal.empty() ? refusal
                                          : "-output " + request.output + ": some ranks cannot write there");
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
  if (line.help) {
    if (printing) fmt::print("{}", line.help == "markdown" ? help_markdown() : help_text());
    return success;
  }
  const Command command = parse_command(line.command);
  for (const std::string& file : line.options_files) session.insert_options_file(file);
  const auto given = session.unused_options();
  Request request = parse_request(command, given);
  check_views(command, request);
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
  check_writable(request);

  std::vector<solvers::AxisymFields> fields;
  solvers::AxisymObserver observer;
  if (!request.axisym_view.empty())
    observer = [&](solvers::AxisymFields found) { fields.push_back(std::move(found)); };
  const Solution solution = solve_designs(PETSC_COMM_WORLD, request.scene, designs, observer);
  const std::array<double, 7> counts = count_status(PETSC_COMM_WORLD, solution);
  write_archive(request, designs, line, solution);
  const std::string views = write_views(PETSC_COMM_WORLD, request, fields);
  print_results(request, designs, solution, counts);
  if (printing) fmt::print("{}", views);
  const bool trustworthy = counts[static_cast<std::size_t>(model::Status::no_equilibrium)] +
                               counts[static_cast<std::size_t>(model::Status::diverged)] ==
                           0;
  return trustworthy ? success : untrustworthy;
}

}  // namespace gaiter::studies
