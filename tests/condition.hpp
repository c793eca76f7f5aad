// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "reference.hpp"

// How far a result of a slice moves with its inputs, from the 50-digit reference: the condition number of an
// output y is the sum over all inputs x of |d ln y / d ln x|. An algorithm can do no better than to return
// the right answer for inputs that are off by rounding, so its error is to be seen beside the condition
// number times the machine's epsilon. For cylinders of one slice, whose segment's results are the slice's.
namespace gaiter::reference {

// What is compared. Volumes are per length of leg.
enum Output {
  pressure_rest,
  pressure_actuated,
  rest_rigid,
  actuated_rigid,
  drop,
  volume_rest,
  volume_actuated,
  volume_change,
  radius_actuated,
  stretch_actual,
  actuation_pressure,
  field,
  output_count
};
inline const char* const output_names[] = {
    "pressure_rest",   "pressure_actuated", "pressure_rest_rigid", "pressure_actuated_rigid",
    "actuation_drop",  "volume_rest",       "volume_actuated",     "volume_change",
    "radius_actuated", "stretch_actual",    "actuation_pressure",  "electric_field_max"};
using Outputs = std::array<Real, output_count>;

// Part of the wall inside the reference radius.
inline Real share_inside(const model::Scene& scene) {
  return Real(scene.bandage.length_at == model::LengthAt::outer    ? 1.0
              : scene.bandage.length_at == model::LengthAt::middle ? 0.5
                                                                   : 0.0);
}

// The slice of a one-slice cylinder with input number `input` larger by the part `change`; -1: as it is. The
// inputs: radius, stretch, wall, voltage, permittivity, the leg's constants, then mu and alpha of each term.
// `step` takes the change that was possible, of an input that the scene holds as a double.
inline Slice changed_slice(const model::Scene& scene, int input, Real change, Real& step) {
  model::Scene moved = scene;
  step = change;
  const auto move = [&](double& value) {
    const double before = value;
    value *= 1 + static_cast<double>(change);
    step = before != 0 ? Real((Real(value) - Real(before)) / Real(before)) : Real(0);
  };
  auto& leg = moved.leg;
  const bool law = leg.material == model::LegMaterial::compliance;
  auto& compliance = leg.segments[0].compliance;
  double* const constants[] = {law ? &compliance.a : &leg.young_modulus,
                               law ? &compliance.b : &leg.poisson_ratio, &compliance.c, &compliance.d};
  if (input >= 5 && input < 9) move(*constants[input - 5]);
  if (input >= 9) {
    model::OgdenTerm& term = moved.bandage.ogden[(input - 9) / 2];
    move((input - 9) % 2 == 0 ? term.mu : term.alpha);
  }
  Slice slice = slice_of(moved, 0, 0.5);
  const Real more = 1 + change;
  const Real share = share_inside(scene);
  const auto rebuild = [&](Real radius, Real stretch, Real wall) {
    slice.leg_radius = radius;
    slice.tube.thickness = wall;
    slice.tube.inner = radius / stretch - share * wall;
  };
  const Real radius = slice.leg_radius, stretch = moved.bandage.modules[0].stretch,
             wall = moved.bandage.thickness;
  if (input == 0) rebuild(radius * more, stretch, wall);
  if (input == 1) rebuild(radius, stretch * more, wall);
  if (input == 2) rebuild(radius, stretch, wall * more);
  if (input == 3) slice.voltage *= more;
  if (input == 4) slice.tube.permittivity *= more;
  return slice;
}

inline int input_count(const model::Scene& scene) {
  return 9 + 2 * static_cast<int>(scene.bandage.ogden.size());
}

// All outputs for given states of the leg (parameters; 0: no contact) and of a bandage that floats free.
// `share` of the wall lies inside the reference radius.
inline Outputs outputs(const Slice& slice, const Real& share, const Real& at_rest, const Real& actuated,
                       const Real& floating) {
  const Point<Real> rest = leg_at<Real>(slice, at_rest), later = leg_at<Real>(slice, actuated);
  const Real free = slice.leg_radius, square = slice.voltage * slice.voltage;
  const auto touching = [&](const Real& parameter, const Real& radius) {
    return parameter > 0 ? radius : std::max(radius, slice.tube.inner);
  };
  Outputs y;
  y.fill(0);
  y[pressure_rest] = at_rest > 0 ? rest.pressure : Real(0);
  y[pressure_actuated] = actuated > 0 ? later.pressure : Real(0);
  const Real rigid = mechanical_pressure<Real>(slice.tube, free);
  y[rest_rigid] = std::max(Real(0), rigid);
  y[actuated_rigid] = std::max(Real(0), Real(rigid - square * unit_actuation<Real>(slice.tube, free)));
  y[drop] = y[pressure_rest] - y[pressure_actuated];
  y[volume_rest] = rest.radius * rest.radius;
  y[volume_actuated] = later.radius * later.radius;
  y[volume_change] = (free - later.radius) * (free + later.radius) / (free * free);
  y[radius_actuated] = later.radius;
  y[stretch_actual] = touching(at_rest, rest.radius) / (slice.tube.inner + share * slice.tube.thickness);
  const Real around = actuated > 0 ? later.radius : floating;
  if (square > 0 && around > 0) {
    y[actuation_pressure] = square * unit_actuation<Real>(slice.tube, around);
    y[field] = slice.voltage * unit_field(slice.tube, around);
  }
  return y;
}

struct Conditioned {
  Outputs value, condition;
};

// Outputs and their condition numbers in the equilibrium found: the states follow a changed input by the
// linearised equations.
inline Conditioned conditioned(const model::Scene& scene, const Expected& found) {
  Real step;
  const Slice slice = changed_slice(scene, -1, 0, step);
  const bool floats = found.parameter == 0 && found.bandage_radius > 0;
  const Real floating = floats ? found.bandage_radius : Real(0);
  const bool own = floats && slice.voltage > 0 &&
                   found.bandage_radius > std::max(leg_at<Real>(slice, 0).radius, slice.tube.inner);
  const auto balance = [](const Slice& s, const Real& parameter, bool on) {
    return imbalance<Real>(s, parameter, on ? s.voltage : Real(0));
  };
  const auto pull = [](const Slice& s, const Real& radius) {
    return Real(mechanical_pressure<Real>(s.tube, radius) -
                s.voltage * s.voltage * unit_actuation<Real>(s.tube, radius));
  };
  const Real small("1e-16");
  struct Equation {
    Real at, value, slope;
  };
  const auto equation = [&](const auto& function, const Real& at) {
    const Real value = function(slice, at);
    return Equation{at, value, Real((function(slice, Real(at * (1 + small))) - value) / (at * small))};
  };
  const auto at_rest = [&](const Slice& s, const Real& p) { return balance(s, p, false); };
  const auto actuated = [&](const Slice& s, const Real& p) { return balance(s, p, true); };
  const bool driven = slice.voltage > 0 && found.parameter > 0;
  const Equation one = found.rest_parameter > 0 ? equation(at_rest, found.rest_parameter) : Equation{};
  const Equation two = driven ? equation(actuated, found.parameter) : Equation{};
  const Equation three = own ? equation(pull, floating) : Equation{};

  Conditioned result;
  result.value = outputs(slice, share_inside(scene), found.rest_parameter, found.parameter, floating);
  result.condition.fill(0);
  for (int input = 0; input < input_count(scene); ++input) {
    if (input == 3 && slice.voltage == 0) continue;
    const Slice moved =
        changed_slice(scene, input, input < 5 ? Real("1e-20") : Real(std::ldexp(1.0, -44)), step);
    if (step == 0) continue;
    const auto follow = [&](const auto& function, const Equation& from) {
      return from.at > 0 ? Real(from.at - (function(moved, from.at) - from.value) / from.slope) : Real(0);
    };
    const Real rest = follow(at_rest, one);
    const Outputs y = outputs(moved, share_inside(scene), rest,
                              driven ? follow(actuated, two) : (found.parameter > 0 ? rest : Real(0)),
                              own      ? follow(pull, three)
                              : floats ? std::max(leg_at<Real>(moved, 0).radius, moved.tube.inner)
                                       : Real(0));
    for (int k = 0; k < output_count; ++k)
      if (result.value[k] != 0)
        result.condition[k] += fabs((y[k] - result.value[k]) / (step * result.value[k]));
  }
  return result;
}

}  // namespace gaiter::reference
