// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/archive/schema.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "gaiter/base/error.hpp"
#include "gaiter/base/text.hpp"

namespace gaiter::archive {
namespace {

using Row = model::SegmentResult;

constexpr std::array table{
    Column{"pressure_rest", "Pa",
           "interface pressure between bandage and leg at rest, mean over the height of the segment",
           &Row::pressure_rest},
    Column{"pressure_actuated", "Pa",
           "interface pressure between bandage and leg under voltage, mean over the height of the segment",
           &Row::pressure_actuated},
    Column{"pressure_rest_rigid", "Pa",
           "interface pressure at rest on a leg that does not give way, mean over the height of the segment",
           &Row::pressure_rest_rigid},
    Column{"pressure_actuated_rigid", "Pa",
           "interface pressure under voltage on a leg that does not give way, mean over the height of the "
           "segment",
           &Row::pressure_actuated_rigid},
    Column{
        "pressure_rest_area_mean", "Pa",
        "normal force of the bandage at rest over the deformed area of its whole inner face, parts that do "
        "not touch the leg included",
        &Row::pressure_rest_area_mean},
    Column{"pressure_actuated_area_mean", "Pa",
           "normal force of the bandage under voltage over the deformed area of its whole inner face, parts "
           "that do not touch the leg included",
           &Row::pressure_actuated_area_mean},
    Column{
        "pressure_rest_change", "1",
        "relative fall of pressure_rest because the leg gives way: 1 - pressure_rest / pressure_rest_rigid",
        &Row::pressure_rest_change},
    Column{"pressure_actuated_change", "1",
           "relative fall of pressure_actuated because the leg gives way: 1 - pressure_actuated / "
           "pressure_actuated_rigid",
           &Row::pressure_actuated_change},
    Column{"actuation_drop", "Pa",
           "fall of the interface pressure by the voltage, pressure_rest minus pressure_actuated",
           &Row::actuation_drop},
    Column{
        "actuation_pressure", "Pa",
        "pressure by which the voltage relieves the bandage at its actuated radius, mean over the height of "
        "the segment",
        &Row::actuation_pressure},
    Column{"volume_initial", "m3", "volume of the segment of leg without bandage", &Row::volume_initial},
    Column{"volume_rest", "m3", "volume of the segment of leg under the bandage at rest", &Row::volume_rest},
    Column{"volume_actuated", "m3", "volume of the segment of leg under the bandage with voltage",
           &Row::volume_actuated},
    Column{"volume_change", "1",
           "part of its initial volume that the segment of leg has lost under the bandage with voltage",
           &Row::volume_change},
    Column{"radius_actuated", "m", "radius of the leg under voltage, mean over the height of the segment",
           &Row::radius_actuated},
    Column{"stretch_actual", "1",
           "stretch of the bandage at rest, once the leg has given way, mean over the height of the segment",
           &Row::stretch_actual},
    Column{"slip_max", "m",
           "largest distance that a point of the bandage has slid along the leg, at rest or under voltage",
           &Row::slip_max},
    Column{"electric_field_max", "V m-1", "largest true electric field in the wall of the bandage",
           &Row::electric_field_max},
    Column{
        "voltage_stable", "V",
        "largest voltage reached on the branch of stable states that starts at rest; the module's own where "
        "the state under voltage was found",
        &Row::voltage_stable},
    Column{"error_estimate", "1",
           "estimated relative error of the pressures (by -fidelity auto: of the wanted output where it is "
           "largest): "
           "discretisation_error, plus model_error where it is known",
           &Row::error_estimate},
    Column{"discretisation_error", "1",
           "estimated relative error, of what error_estimate is of, against the same model fully resolved",
           &Row::discretisation_error},
    Column{"model_error", "1",
           "estimated relative change of the same by the models beyond this one, as far as known: the leg "
           "that gives way, the bandage that slides; NaN where unknown",
           &Row::model_error},
    Column{
        "planned_discretisation_error", "1",
        "what -fidelity auto expected of discretisation_error when it chose the model; NaN where that shows "
        "only when solved",
        &Row::planned_discretisation_error, true},
    Column{"planned_model_error", "1",
           "relative error, against the finest model allowed, that -fidelity auto expected of "
           "the model when it chose it",
           &Row::planned_model_error, true},
    Column{"planned_cost", "s",
           "processor time that -fidelity auto expected of the segment when it chose the model",
           &Row::planned_cost, true},
    Column{"slices_used", "1", "slices over the height of the segment; 0 for finite elements",
           &Row::slice_count},
    Column{"wall_points_used", "1", "Gauss points through the wall; 0 for finite elements",
           &Row::wall_points},
    Column{"unknowns", "1", "unknowns of the system of equations; 0 for closed forms", &Row::unknowns},
    Column{"iterations", "1", "iterations of the solver, the most that any slice of the segment took",
           &Row::iterations},
    Column{"status", "", "state of the bandage on the segment, the gravest of its slices", &Row::status},
    Column{"fidelity", "", "model that gave the results of the segment", &Row::fidelity},
};

constexpr std::array status_words{"contact",        "slack",    "lifted",  "extrapolated", "pulled_in",
                                  "no_equilibrium", "diverged", "invalid", "not_wanted"};
static_assert(status_words.size() == model::status_count);

constexpr std::array fidelity_words{"rigid", "slice", "sliding", "axisym", "first_order"};
static_assert(fidelity_words.size() == static_cast<std::size_t>(model::Fidelity::first_order) + 1);

std::int8_t stored(model::Status value) {
  return static_cast<std::int8_t>(value);
}
std::int8_t stored(model::Fidelity value) {
  return static_cast<std::int8_t>(value);
}
std::int32_t stored(int value) {
  return value;
}
double stored(double value) {
  return value;
}

}  // namespace

std::span<const Column> columns() {
  return table;
}

std::vector<const Column*> choose_columns(std::span<const std::string> names) {
  std::vector<std::string> known;
  for (const Column& column : table) {
    known.emplace_back(column.name);
  }
  for (const std::string& name : names) {
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      const std::string near = base::nearest(name, known);
      throw base::InputError("'" + name + "' is no variable of an archive" +
                             (near.empty() ? "" : "; did you mean '" + near + "'?"));
    }
  }
  std::vector<const Column*> chosen;
  for (const Column& column : table) {
    if (names.empty() || column.name == "status" ||
        std::find(names.begin(), names.end(), column.name) != names.end()) {
      chosen.push_back(&column);
    }
  }
  return chosen;
}

Stored stored_as(const Column& column) {
  return std::visit(
      [](auto member) {
        using Value = decltype(stored(Row{}.*member));
        if constexpr (std::is_same_v<Value, double>) {
          return Stored::float64;
        } else if constexpr (std::is_same_v<Value, std::int32_t>) {
          return Stored::int32;
        } else {
          return Stored::int8;
        }
      },
      column.field);
}

std::size_t bytes_of(Stored stored) {
  switch (stored) {
    case Stored::float64:
    case Stored::int64:
      return 8;
    case Stored::int32:
      return 4;
    case Stored::int8:
      return 1;
  }
  return 0;
}

std::vector<std::string_view> flag_words(const Column& column) {
  if (std::holds_alternative<model::Status Row::*>(column.field)) {
    return {status_words.begin(), status_words.end()};
  }
  if (std::holds_alternative<model::Fidelity Row::*>(column.field)) {
    return {fidelity_words.begin(), fidelity_words.end()};
  }
  return {};
}

std::string_view word(model::Status status) {
  return status_words.at(static_cast<std::size_t>(status));
}

std::string_view word(model::Fidelity fidelity) {
  return fidelity_words.at(static_cast<std::size_t>(fidelity));
}

void gather(const Column& column, std::span<const Row> rows, std::byte* out) {
  std::visit(
      [&](auto member) {
        for (const Row& row : rows) {
          const auto value = stored(row.*member);
          std::memcpy(out, &value, sizeof value);
          out += sizeof value;
        }
      },
      column.field);
}

}  // namespace gaiter::archive
