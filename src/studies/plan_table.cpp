// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/plan_table.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "gaiter/archive/schema.hpp"
#include "gaiter/base/error.hpp"
#include "gaiter/solvers/auto_model.hpp"
#include "gaiter/studies/scene_checks.hpp"

namespace gaiter::studies {

namespace {

using solvers::SlicePlan;

std::string error_text(double error) {
  return std::isnan(error) ? "when solved" : fmt::format("{:.1e}", error);
}

std::string slices_text(std::size_t slices, int wall_points) {
  return fmt::format("{} x {}", slices, wall_points);
}

// As planned; what was solved has rows of its own.
std::string resolution(const SlicePlan& plan) {
  if (plan.fidelity == model::Fidelity::axisym) return fmt::format("refine {}", plan.slice_count);
  return slices_text(static_cast<std::size_t>(plan.slice_count) * (plan.cuts.size() + 1), plan.wall_points);
}

std::string head() {
  return fmt::format("{:<10}{:<12}{:>14}{:>16}{:>13}{:>11}\n{:<10}{:<12}{:>14}{:>16}{:>13}{:>11}\n",
                     "segment", "model", "resolution", "discretisation", "model", "time", "", "",
                     "height x wall", "error", "error", "us");
}

std::string line(const model::Segment& segment, model::Fidelity fidelity, const std::string& resolution,
                 double discretisation_error, double model_error, double cost) {
  return fmt::format("{:<10}{:<12}{:>14}{:>16}{:>13}{:>11.3g}\n", segment.name, archive::word(fidelity),
                     resolution, error_text(discretisation_error), error_text(model_error), 1e6 * cost);
}

std::string one_design(const model::Scene& scene) {
  std::string text = head();
  for (std::size_t i = 0; i < scene.leg.segments.size(); ++i) {
    if (!scene.wants(i)) continue;
    const SlicePlan plan = solvers::plan_segment(scene, i);
    text += line(scene.leg.segments[i], plan.fidelity, resolution(plan), plan.expected_discretisation_error(),
                 plan.expected_model_error(), plan.cost);
  }
  return text;
}

}  // namespace

std::string plan_text(const Request& request, const Designs& designs) {
  if (request.scene.fidelity != model::Fidelity::automatic)
    throw base::InputError("-plan: needs -fidelity 'auto', for with any other there is nothing to choose");
  if (request.axes.empty()) return one_design(request.scene);
  struct Share {
    std::int64_t segments = 0;
    double cost = 0;
  };
  std::map<model::Fidelity, Share> shares;
  model::Scene scene = request.scene;
  std::int64_t invalid = 0;
  for (std::int64_t design = 0; design < designs.size(); ++design) {
    if (!put_design(designs, design, scene).empty()) {
      ++invalid;
      continue;
    }
    for (std::size_t i = 0; i < scene.leg.segments.size(); ++i) {
      if (!scene.wants(i)) continue;
      const SlicePlan plan = solvers::plan_segment(scene, i);
      ++shares[plan.fidelity].segments;
      shares[plan.fidelity].cost += plan.cost;
    }
  }
  std::string text;
  for (const auto& [fidelity, share] : shares)
    text += fmt::format("{:<12}{:>10} segments{:>11.3g} s\n", archive::word(fidelity), share.segments,
                        share.cost);
  if (invalid > 0) text += fmt::format("{} designs are invalid\n", invalid);
  return text;
}

std::string taken_text(const model::Scene& scene, std::span<const model::SegmentResult> results) {
  std::string text = "taken, with the errors and the time that were expected:\n" + head();
  for (std::size_t i = 0; i < results.size(); ++i) {
    const model::SegmentResult& result = results[i];
    if (std::isnan(result.planned_cost)) continue;  // not planned, or not in the archive
    const std::string found =
        result.fidelity == model::Fidelity::axisym
            ? fmt::format("{} unknowns", result.unknowns)
            : slices_text(static_cast<std::size_t>(result.slice_count), result.wall_points);
    text += line(scene.leg.segments[i], result.fidelity, found, result.planned_discretisation_error,
                 result.planned_model_error, result.planned_cost);
  }
  return text;
}

}  // namespace gaiter::studies
