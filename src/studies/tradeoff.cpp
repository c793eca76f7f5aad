// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/tradeoff.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "gaiter/archive/chunk_file.hpp"
#include "gaiter/archive/schema.hpp"
#include "gaiter/petsc/session.hpp"
#include "gaiter/studies/solve.hpp"

namespace gaiter::studies {

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr double shortest_timing = 0.05;    // [s]
constexpr std::size_t most_segments = 512;  // solved at once to be timed
constexpr int timings = 3;

using Output = double model::SegmentResult::*;

std::vector<Output> wanted_outputs(const model::Wanted& goal) {
  std::vector<Output> outputs;
  if (goal.pressure_rest) outputs.push_back(&model::SegmentResult::pressure_rest);
  if (goal.pressure_actuated) outputs.push_back(&model::SegmentResult::pressure_actuated);
  if (goal.actuation_drop) outputs.push_back(&model::SegmentResult::actuation_drop);
  if (goal.volume_change) outputs.push_back(&model::SegmentResult::volume_change);
  return outputs;
}

// NaN where no segment has a result here and in the reference.
double largest_difference(const model::Goal& goal, const std::vector<model::SegmentResult>& rows,
                          const std::vector<model::SegmentResult>& reference) {
  double largest = none;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!model::trustworthy(reference[i].status)) continue;
    for (const Output output : wanted_outputs(goal.of(i))) {
      const double value = rows[i].*output, exact = reference[i].*output;
      if (exact == 0 && value == 0) continue;
      largest = std::fmax(largest, std::fabs(value - exact) / std::fabs(exact));
    }
  }
  return largest;
}

model::Scene repeated(const model::Scene& scene, std::size_t times) {
  model::Scene wide = scene;
  auto& wanted = wide.goal.of_segment;
  const std::vector<model::Wanted> once = wanted;
  for (std::size_t k = 1; k < times; ++k) {
    wanted.insert(wanted.end(), once.begin(), once.end());
    wide.leg.segments.insert(wide.leg.segments.end(), scene.leg.segments.begin(), scene.leg.segments.end());
    wide.bandage.modules.insert(wide.bandage.modules.end(), scene.bandage.modules.begin(),
                                scene.bandage.modules.end());
  }
  return wide;
}

// Of a segment and processor; `seconds`: what the scene by itself took.
double segment_time(MPI_Comm comm, const model::Scene& scene, double seconds) {
  const std::size_t segments = scene.leg.segments.size();
  double solved = 0;
  for (std::size_t i = 0; i < segments; ++i) solved += scene.wants(i) ? 1 : 0;
  const double processors = std::min<double>(petsc::size(comm), static_cast<double>(segments));
  if (seconds > shortest_timing) return seconds * processors / solved;
  const std::size_t times = std::max<std::size_t>(1, most_segments / segments);
  const model::Scene wide = repeated(scene, times);
  double shortest = std::numeric_limits<double>::infinity();
  for (int k = 0; k < timings; ++k) shortest = std::min(shortest, solve_scene(comm, wide).seconds);
  return shortest * petsc::size(comm) / (static_cast<double>(times) * solved);
}

// Of all segments.
double largest(const RungResult& rung, double model::SegmentResult::*error) {
  double most = none;
  for (const model::SegmentResult& row : rung.rows)
    if (model::trustworthy(row.status)) most = std::fmax(most, row.*error);
  return most;
}

double mean_unknowns(const RungResult& rung) {
  double sum = 0;
  for (const model::SegmentResult& row : rung.rows) sum += row.unknowns;
  return sum / static_cast<double>(rung.rows.size());
}

bool is_auto(const RungResult& rung) {
  return rung.name.starts_with("auto_");
}

// What auto took, the segments in turn.
std::string taken_by(const RungResult& rung) {
  std::string text, last;
  for (const model::SegmentResult& row : rung.rows) {
    if (row.status == model::Status::not_wanted) continue;
    std::string taken(archive::word(row.fidelity));
    taken += row.slice_count > 0 ? fmt::format(" {} x {}", row.slice_count, row.wall_points)
                                 : fmt::format(" {}", row.unknowns);
    if (taken != last) text += (text.empty() ? "" : ", ") + taken;
    last = taken;
  }
  return text;
}

// Whether auto would call a segment solved like this the same: it leaves the points through the wall open,
// and the slices where these are no system.
bool same_model(const RungResult& rung, const model::SegmentResult& row, const model::SegmentResult& taken) {
  if (row.fidelity != taken.fidelity) return false;
  switch (row.fidelity) {
    case model::Fidelity::slice:
      return row.slice_count == taken.slice_count && rung.name == fmt::format("slices_{}", row.slice_count);
    case model::Fidelity::sliding:
      return row.slice_count == taken.slice_count;
    case model::Fidelity::axisym:
      return row.unknowns == taken.unknowns && rung.name.starts_with("axisym_") &&
             rung.name.find("_r") == std::string::npos;
    default:
      return true;
  }
}

// The auto rungs that took this one for some segment.
std::string takers_of(const RungResult& rung, const std::vector<RungResult>& rungs) {
  std::string text;
  for (const RungResult& other : rungs) {
    if (!is_auto(other) || is_auto(rung) || &rung == &rungs.back()) continue;
    std::size_t taken = 0, wanted = 0;
    for (std::size_t i = 0; i < rung.rows.size(); ++i) {
      if (other.rows[i].status == model::Status::not_wanted) continue;
      ++wanted;
      taken += same_model(rung, rung.rows[i], other.rows[i]);
    }
    if (taken > 0)
      text += fmt::format("{}{}{}", text.empty() ? "< " : ", ", other.name,
                          taken < wanted ? fmt::format(" ({} of {})", taken, wanted) : "");
  }
  return text;
}

// Whether no rung that takes less time is as good.
bool on_the_front(const RungResult& rung, const std::vector<RungResult>& rungs) {
  return rung.true_error >= 0 && std::ranges::none_of(rungs, [&](const RungResult& other) {
           return other.segment_time < rung.segment_time && other.true_error <= rung.true_error;
         });
}

std::string number(double value) {
  return std::isnan(value) ? "-" : fmt::format("{:.1e}", value);
}

}  // namespace

std::vector<RungResult> climb(MPI_Comm comm, const std::vector<Rung>& rungs) {
  std::vector<RungResult> results;
  for (const Rung& rung : rungs) {
    const Solution solution = solve_scene(comm, rung.scene);
    results.push_back({rung.name, gather(comm, solution), 0, 0, solution.seconds});
    results.back().segment_time = segment_time(comm, rung.scene, solution.seconds);
  }
  for (RungResult& result : results)
    result.true_error = largest_difference(rungs[0].scene.goal, result.rows, results.back().rows);
  return results;
}

std::string tradeoff_table(const model::Scene& scene, const std::vector<RungResult>& rungs) {
  std::string text =
      fmt::format("{:<22}{:>12}{:>12}{:>10}{:>10}{:>14}{:>12}{:>7}  {}\n", "rung", "true error", "estimated",
                  "own part", "unknowns", "s a segment", "speed", "front", "taken");
  const RungResult& finest = rungs.back();
  for (const RungResult& rung : rungs) {
    const std::string taken = is_auto(rung) ? taken_by(rung) : takers_of(rung, rungs);
    text += fmt::format("{:<22}{:>12}{:>12}{:>10}{:>10.0f}{:>14.2e}{:>12.3g}{:>7}  {}\n", rung.name,
                        &rung == &finest ? "-" : number(rung.true_error),
                        number(largest(rung, &model::SegmentResult::error_estimate)),
                        number(largest(rung, &model::SegmentResult::discretisation_error)),
                        mean_unknowns(rung), rung.segment_time, finest.segment_time / rung.segment_time,
                        on_the_front(rung, rungs) ? "*" : "", taken);
  }
  text += fmt::format(
      "true error: the largest of any segment and wanted output against {}; estimated: error_estimate, the "
      "same\nfor the rung by itself, finer models included; own part: of the discretisation and the "
      "algorithm. * no "
      "cheaper\nrung is as good. < taken by auto, with points through the wall of its own.\n",
      archive::word(finest.rows[0].fidelity));
  for (std::size_t i = 0; i < finest.rows.size(); ++i)
    if (!model::trustworthy(finest.rows[i].status))
      text += fmt::format("{}: the finest has no result ({}); the segment does not count\n",
                          scene.leg.segments[i].name, archive::word(finest.rows[i].status));
  return text;
}

archive::Layout tradeoff_layout(const model::Scene& scene, const std::vector<RungResult>& rungs) {
  archive::Layout layout{rungs.size(), {}, {}, {}};
  for (const model::Segment& segment : scene.leg.segments) layout.segments.push_back(segment.name);
  std::vector<std::string> names;
  for (const RungResult& rung : rungs) names.push_back(rung.name);
  layout.swept = {{"rung", "", "how the scene was solved", names},
                  {"true_error",
                   "1",
                   "largest relative difference of any segment and wanted output from the last case",
                   {}},
                  {"segment_time", "s", "processor time of one segment, among many such segments", {}}};
  return layout;
}

void write_tradeoff(const std::string& path, const archive::Layout& layout,
                    const archive::Provenance& provenance, const std::vector<RungResult>& rungs) {
  std::vector<model::SegmentResult> rows;
  std::vector<double> wall_times;
  std::vector<std::vector<double>> columns(3, std::vector<double>(rungs.size()));
  std::iota(columns[0].begin(), columns[0].end(), 0.0);
  for (std::size_t i = 0; i < rungs.size(); ++i) {
    rows.insert(rows.end(), rungs[i].rows.begin(), rungs[i].rows.end());
    wall_times.push_back(rungs[i].solve_time);
    columns[1][i] = rungs[i].true_error;
    columns[2][i] = rungs[i].segment_time;
  }
  archive::write_archive(path, layout, provenance, {rows, wall_times, columns});
}

}  // namespace gaiter::studies
