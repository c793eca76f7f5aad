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

std::string resolution(const SlicePlan& plan) {
  if (plan.fidelity == model::Fidelity::axisym) return fmt::format("refine {}", plan.slice_count);
  return fmt::format("{} x {}", static_cast<std::size_t>(plan.slice_count) * (plan.cuts.size() + 1),
                     plan.wall_points);
}

std::string one_design(const model::Scene& scene) {
  std::string text = fmt::format(
      "{:<10}{:<12}{:>14}{:>16}{:>13}{:>11}\n{:<10}{:<12}{:>14}{:>16}{:>13}{:>11}\n", "segment", "model",
      "resolution", "discretisation", "model", "time", "", "", "height x wall", "error", "error", "us");
  for (std::size_t i = 0; i < scene.leg.segments.size(); ++i) {
    const SlicePlan plan = solvers::plan_segment(scene, i);
    text += fmt::format("{:<10}{:<12}{:>14}{:>16}{:>13}{:>11.3g}\n", scene.leg.segments[i].name,
                        archive::word(plan.fidelity), resolution(plan),
                        error_text(plan.height_error + plan.wall_error), error_text(plan.model_error),
                        1e6 * plan.cost);
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

}  // namespace gaiter::studies
