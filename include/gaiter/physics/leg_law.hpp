// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <array>

#include "gaiter/model/leg.hpp"
#include "gaiter/physics/vector_math.hpp"

namespace gaiter::physics {

// How a leg's radius gives way to a uniform pressure P: radial strain eps_r(P) = 1 - r/R_c, which grows with
// P. Two laws: the strain law of paper Eq. (2), a exp(bP) + c exp(dP), with c = -a in its anchored variant;
// and the plane-strain response of a neo-Hookean cylinder W = G/2 (J^{-2/3} I1 - 3) + K/2 (J - 1)^2 at fixed
// length, P = (1 - y)(K + G/3 y^{-5/3}) with y = (r/R_c)^2. Validity: P >= 0 and eps_r < 1; the strain law
// was measured up to some 7 kPa. Tests: tests/slice_laws.cpp.
struct LegConstants {
  double pressure_scale = 0;      // S [Pa]; pressures below are in units of S
  std::array<double, 4> value{};  // strain law: a, c, a + c, d/b; neo-Hookean: K/S, G/(3S), 0, 0
};

LegConstants leg_constants(const model::Leg& leg, const model::Segment& segment);

// A pressure, in units of S, at which the leg's strain is at least `strain`, and not much more; infinite
// strains or such of 1 and beyond count as almost 1. For a strain below that of no pressure the result is not
// positive.
double pressure_bound(const model::Leg& leg, const LegConstants& constants, double strain);

// The same of either law, for loops over packs: from a and a + c; from K/S and G/(3S).
constexpr double bound_rounding = 1 + 1e-9;

template <typename Number>
inline Number strain_law_pressure_bound(Number a, Number strain_of_none, Number strain) {
  // a exp(bP) = strain - c exp(dP), where c <= 0 and the second exponential is between 0 and 1.
  const Number reached = strain < 1 ? strain : Number(1);
  const Number beyond = reached > strain_of_none ? reached - strain_of_none : Number(0);
  return std::log1p(beyond / a) * Number(bound_rounding);
}

template <typename Number>
inline Number neo_hookean_pressure_bound(Number bulk, Number shear, Number strain) {
  const Number reached = strain < Number(0.99) ? strain : Number(0.99);
  const Number power = std::exp(Number(-10.0 / 3) * std::log(1 - reached));
  return reached * (2 - reached) * (bulk + shear * power) * Number(bound_rounding);
}

}  // namespace gaiter::physics
