// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/result_table.hpp"

#include <fmt/format.h>

#include <cmath>

#include "gaiter/archive/schema.hpp"
#include "gaiter/studies/plan_table.hpp"

namespace gaiter::studies {

namespace {

constexpr double mmhg = 133.322387415;  // [Pa]
constexpr double loud_error = 1e-3;

double applied_stretch(const model::Segment& segment, const model::Module& module) {
  return module.length > 0 ? segment.mean_radius() * 2 * M_PI / module.length : module.stretch;
}

// Why a status stands in the table.
std::string_view meaning(model::Status status) {
  switch (status) {
    case model::Status::contact:
      return "the bandage presses on the leg";
    case model::Status::slack:
      return "at some height the bandage is too wide to touch the leg";
    case model::Status::lifted:
      return "the voltage lifts the bandage off at some height; the pressure is 0 there";
    case model::Status::extrapolated:
      return "at some height the pressure is beyond the measured compliance data";
    case model::Status::pulled_in:
      return "the voltage is more than the bandage can balance: it expands without end";
    case model::Status::no_equilibrium:
      return "no stable equilibrium exists, or none that can be reached from rest";
    case model::Status::diverged:
      return "the solver did not converge";
    case model::Status::invalid:
      return "the values of the design make no possible scene; it was not solved";
    case model::Status::not_wanted:
      return "no output of the segment is among -outputs; it was not solved";
  }
  return "";
}

// The errors of the pressures, the worst of all segments.
std::string error_note(std::span<const model::SegmentResult> results) {
  double own = -1, beyond = -1;
  std::size_t unknown = 0;
  for (const model::SegmentResult& result : results) {
    own = std::fmax(own, result.discretisation_error);
    beyond = std::fmax(beyond, result.model_error);
    if (model::trustworthy(result.status) && std::isnan(result.model_error)) ++unknown;
  }
  std::string text;
  if (own >= 0) text += fmt::format("error of the pressures by the discretisation: up to {:.1e}", own);
  if (beyond > 0)
    text += fmt::format("{} up to {:.1e}",
                        text.empty() ? "what finer models would change in the pressures:"
                                     : "; what finer models would change:",
                        beyond);
  if (text.empty()) return text;
  text += " (relative, estimated)\n";
  if (unknown > 0)
    text += fmt::format("what finer models would change is not known of {} of {} segments\n", unknown,
                        results.size());
  return text;
}

}  // namespace

std::string result_table(const model::Scene& scene, std::span<const model::SegmentResult> results) {
  std::string text =
      fmt::format("{:<10}{:>8}{:>20}{:>20}{:>10}{:>12}{:>10}{:>8}  {}\n", "segment", "stretch",
                  "pressure at rest", "actuated", "drop", "rigid leg", "volume", "steps", "status");
  text += fmt::format("{:<10}{:>8}{:>20}{:>20}{:>10}{:>12}{:>10}\n", "", "", "kPa (mmHg)", "kPa (mmHg)", "Pa",
                      "kPa, rest", "change %");
  std::array<bool, model::status_count> seen{};
  std::string notes;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const model::SegmentResult& r = results[i];
    const model::Segment& segment = scene.leg.segments[i];
    const auto pressure = [](double p) { return fmt::format("{:.4f} ({:.2f})", p / 1000, p / mmhg); };
    text += fmt::format("{:<10}{:>8.3f}{:>20}{:>20}{:>10.2f}{:>12.4f}{:>10.3f}{:>8}  {}\n", segment.name,
                        applied_stretch(segment, scene.bandage.modules[i]), pressure(r.pressure_rest),
                        pressure(r.pressure_actuated), r.actuation_drop, r.pressure_rest_rigid / 1000,
                        100 * r.volume_change, r.iterations, archive::word(r.status));
    seen[static_cast<std::size_t>(r.status)] = true;
    const bool at_rest_alone = model::trustworthy(r.status) && std::isnan(r.pressure_actuated);
    if (r.voltage_stable < scene.bandage.modules[i].voltage && !at_rest_alone)
      notes += fmt::format("{}: stable up to {:.3g} kV\n", segment.name, r.voltage_stable * 1e-3);
    if (r.electric_field_max > scene.bandage.breakdown_field)
      notes +=
          fmt::format("{}: the electric field, {:.1f} kV/mm, exceeds the breakdown field, {:.1f} kV/mm\n",
                      segment.name, r.electric_field_max * 1e-6, scene.bandage.breakdown_field * 1e-6);
    if (r.discretisation_error > loud_error && scene.fidelity != model::Fidelity::automatic)
      notes += fmt::format(
          "{}: estimated relative error of the pressure {:.1e}; more -slice_count or -wall_points\n",
          segment.name, r.discretisation_error);
  }
  notes += error_note(results);
  if (scene.fidelity == model::Fidelity::automatic) notes += taken_text(scene, results);
  for (std::size_t status = 1; status < seen.size(); ++status)
    if (seen[status])
      notes += fmt::format("{}: {}\n", archive::word(static_cast<model::Status>(status)),
                           meaning(static_cast<model::Status>(status)));
  return text + notes;
}

std::string status_summary(std::span<const std::int64_t> counts, const std::string& archive) {
  std::int64_t failed = 0, rows = 0;
  std::string text;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const auto status = static_cast<model::Status>(i);
    rows += counts[i];
    if (counts[i] > 0)
      text += fmt::format("  {:>10} segments {}: {}\n", counts[i], archive::word(status), meaning(status));
    if (model::failed(status)) failed += counts[i];
  }
  if (failed > 0)
    text += fmt::format(
        "{} of {} segments have no trustworthy result; list case, segment and status of each with\n"
        "  /usr/bin/python3 -c \"import h5py; s = h5py.File('{}')['status'][:]; "
        "[print(*i, s[tuple(i)]) for i in zip(*(s >= {}).nonzero())]\"\n",
        failed, rows, archive, static_cast<int>(model::Status::no_equilibrium));
  return text;
}

}  // namespace gaiter::studies
