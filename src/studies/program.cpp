// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/program.hpp"

#include <fmt/core.h>
#include <petscsys.h>

#include <algorithm>
#include <array>
#include <type_traits>
#include <variant>

#include "gaiter/archive/agree.hpp"
#include "gaiter/archive/chunk_file.hpp"
#include "gaiter/archive/durable_file.hpp"
#include "gaiter/archive/reader.hpp"
#include "gaiter/archive/schema.hpp"
#include "gaiter/archive/status_count.hpp"
#include "gaiter/base/error.hpp"
#include "gaiter/base/version.hpp"
#include "gaiter/studies/axisym_view.hpp"
#include "gaiter/studies/help.hpp"
#include "gaiter/studies/paper_comparison.hpp"
#include "gaiter/studies/plan_table.hpp"
#include "gaiter/studies/report.hpp"
#include "gaiter/studies/result_table.hpp"
#include "gaiter/studies/scene_checks.hpp"
#include "gaiter/studies/scene_options.hpp"
#include "gaiter/studies/solve.hpp"
#include "gaiter/studies/solver_options.hpp"
#include "gaiter/studies/sweep.hpp"
#include "gaiter/studies/tradeoff.hpp"

namespace gaiter::studies {

namespace {

constexpr std::int64_t most_tables = 10;  // designs of a sweep that are printed one by one

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

archive::Provenance provenance_of(const Request& request, const CommandLine& line) {
  return archive::describe_run(PETSC_COMM_WORLD, base::version, request.text, line.typed);
}

// Values of one column of a small archive, back to the rows they came from.
void put_column(const archive::Column& column, const archive::Archive& archive,
                std::vector<model::SegmentResult>& rows) {
  const auto found = archive.variables.find(std::string(column.name));
  for (std::size_t i = 0; found != archive.variables.end() && i < rows.size(); ++i)
    std::visit(
        [&](auto field) {
          using Value = std::remove_reference_t<decltype(rows[i].*field)>;
          rows[i].*field = static_cast<Value>(found->second.numbers.at(i));
        },
        column.field);
}

// The designs of a short sweep, a table each, from its archive: some may have been solved by an earlier run.
void print_tables(const Request& request, const Designs& designs) {
  const archive::Archive archive = archive::read_archive(request.output);
  const std::size_t segments = request.scene.leg.segments.size();
  std::vector<model::SegmentResult> rows(
      static_cast<std::size_t>(designs.size()) * segments,
      model::without_numbers(model::Status::invalid, model::Fidelity::slice));
  for (const archive::Column& column : archive::columns()) put_column(column, archive, rows);
  model::Scene scene = request.scene;
  std::vector<double> values(designs.axes().size());
  for (std::int64_t design = 0; design < designs.size(); ++design) {
    designs.values(design, values);
    designs.apply(values, scene);
    for (std::size_t axis = 0; axis < values.size(); ++axis)
      fmt::print("{} = {:.6g} {}\n", designs.axes()[axis].name, values[axis], designs.axes()[axis].unit());
    fmt::print("{}\n", result_table(scene, std::span(rows).subspan(
                                               static_cast<std::size_t>(design) * segments, segments)));
  }
}

void print_sweep(const Request& request, const Designs& designs, const archive::StatusCount& counts) {
  if (designs.size() <= most_tables) print_tables(request, designs);
  fmt::print("{} designs\n{}", designs.size(), status_summary(counts.rows, request.output));
  if (counts.rows[static_cast<std::size_t>(model::Status::invalid)] > 0) {
    model::Scene scene = request.scene;
    fmt::print("  invalid, for example case {}: {}\n", counts.first_invalid_case,
               put_design(designs, static_cast<std::int64_t>(counts.first_invalid_case), scene));
  }
}

ExitCode exit_code(std::span<const std::int64_t> counts) {
  std::int64_t failed = 0;
  for (std::size_t i = 0; i < counts.size(); ++i)
    if (model::failed(static_cast<model::Status>(i))) failed += counts[i];
  return failed == 0 ? success : untrustworthy;
}

// Changes the `outcome` that is to be printed last if it is another than usual.
int sweep(const Request& request, const Designs& designs, const CommandLine& line, std::string& outcome) {
  const bool printing = petsc::rank(PETSC_COMM_WORLD) == 0;
  const SweepReport report = run_sweep(PETSC_COMM_WORLD, request, designs, provenance_of(request, line));
  const std::string speed =
      request.progress != Progress::off ? speed_summary(PETSC_COMM_WORLD, report) : std::string();
  if (report.signal > 0) {
    if (printing)
      fmt::print("{}stopped by signal {}; {} of {} designs are stored; the same command goes on from there\n",
                 speed, report.signal, designs.size() - report.missing, designs.size());
    return 128 + report.signal;
  }
  archive::StatusCount counts;
  archive::agreed(PETSC_COMM_WORLD, "-output " + request.output, [&] {
    if (printing) counts = archive::count_status(request.output);
  });
  MPI_Bcast(counts.rows.data(), static_cast<int>(counts.rows.size()), MPI_INT64_T, 0, PETSC_COMM_WORLD);
  if (printing) {
    print_sweep(request, designs, counts);
    if (report.already_complete)
      outcome = request.output + " is complete already; nothing was done";
    else if (report.taken_up > 0)
      fmt::print("{} designs were in {} from earlier runs\n", report.taken_up, request.output);
    fmt::print("{}", speed);
  }
  return exit_code(counts.rows);
}

int solve(const Request& request, const CommandLine& line) {
  const bool printing = petsc::rank(PETSC_COMM_WORLD) == 0;
  check_writable(request);
  std::vector<solvers::AxisymFields> fields;
  solvers::AxisymObserver observer;
  if (!request.axisym_view.empty())
    observer = [&](solvers::AxisymFields found) { fields.push_back(std::move(found)); };
  const Solution solution = solve_scene(PETSC_COMM_WORLD, request.scene, observer);
  archive::Layout layout{1, {}, {}, request.columns};
  for (const model::Segment& segment : request.scene.leg.segments) layout.segments.push_back(segment.name);
  const archive::Provenance provenance = provenance_of(request, line);
  const std::vector<model::SegmentResult> rows = gather(PETSC_COMM_WORLD, solution);
  archive::Failure failure;
  try {
    if (printing)
      archive::write_archive(request.output, layout, provenance, {rows, {&solution.seconds, 1}, {}});
  } catch (const base::InternalError& error) {
    failure.message = error.what();
  }
  archive::throw_if_any_failed(PETSC_COMM_WORLD, failure);
  const std::string views = write_views(PETSC_COMM_WORLD, request, fields);

  std::array<std::int64_t, model::status_count> counts{};
  for (const model::SegmentResult& row : rows) ++counts[static_cast<std::size_t>(row.status)];
  const ExitCode code = exit_code(counts);
  if (printing) {
    fmt::print("{}\n", result_table(request.scene, rows));
    if (code != success) fmt::print("{}", status_summary(counts, request.output));
    fmt::print("{}", views);
  }
  return code;
}

int tradeoff(const Request& request, const CommandLine& line) {
  const bool printing = petsc::rank(PETSC_COMM_WORLD) == 0;
  check_writable(request);
  const std::vector<RungResult> rungs = climb(PETSC_COMM_WORLD, rungs_of(request.scene));
  const archive::Provenance provenance = provenance_of(request, line);
  archive::agreed(PETSC_COMM_WORLD, "-output " + request.output, [&] {
    if (printing) write_tradeoff(request.output, tradeoff_layout(request.scene, rungs), provenance, rungs);
  });
  if (printing) fmt::print("{}\n", tradeoff_table(request.scene, rungs));
  return std::ranges::all_of(rungs.back().rows,
                             [](const auto& row) { return model::trustworthy(row.status); })
             ? success
             : untrustworthy;
}

}  // namespace

int run_program(petsc::Session& session, const CommandLine& line) {
  const bool printing = petsc::rank(PETSC_COMM_WORLD) == 0;
  if (line.help) {
    if (printing) fmt::print("{}", line.help == "markdown" ? help_markdown() : help_text());
    return success;
  }
  const Command command = parse_command(line.command);
  for (const std::string& file : line.options_files) session.insert_options_file(file);
  const auto given = session.unused_options();
  if (command == Command::report) {
    for (const auto& [name, text] : given) session.mark_used(name);
    const std::string page = write_report(PETSC_COMM_WORLD, given);
    if (printing) fmt::print("wrote {}\n", page);
    return success;
  }
  Request request = parse_request(command, given);
  check_views(command, request);
  ForeignOptions foreign;
  for (const std::string& name : request.unknown) foreign[name] = given.at(name);
  for (const auto& [name, text] : given)
    if (!foreign.contains(name)) session.mark_used(name);
  check_foreign_options(session, request.scene, foreign);
  request.text += solver_settings(foreign);
  const Designs designs(request.axes, request.sampling);
  if (request.comparison == Comparison::paper) require_paper_segments(request.scene);
  if (request.dry_run) {
    if (printing)
      fmt::print("{}# {} designs of {} segments\n", request.text, designs.size(),
                 request.scene.leg.segments.size());
    return success;
  }
  if (request.plan) {
    if (printing) fmt::print("{}", plan_text(request, designs));
    return success;
  }
  std::string outcome = "wrote " + request.output;
  const int code = command == Command::sweep      ? sweep(request, designs, line, outcome)
                   : command == Command::tradeoff ? tradeoff(request, line)
                                                  : solve(request, line);
  if (printing && code <= untrustworthy) {
    if (request.comparison == Comparison::paper) fmt::print("{}\n", paper_comparison(request.scene));
    fmt::print("{}\n", outcome);
  }
  return code;
}

}  // namespace gaiter::studies
