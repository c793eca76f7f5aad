// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <algorithm>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <boost/math/tools/minima.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <optional>
#include <vector>

#include "gaiter/model/result.hpp"
#include "gaiter/model/scene.hpp"

// The slice model a second time, for tests: the paper's equations as they are printed (but for the sign of
// Eq. 4), in 50 digits, with brackets instead of Newton's method, and without a line of the program's own
// physics. Doubles are taken as exact. 50 digits because the printed forms cancel: for a wall of 1e-9 m
// stretched by 1 + 1e-12 some 20 digits go.
namespace gaiter::reference {

using Real =
    boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>, boost::multiprecision::et_off>;

// Where a path is only scanned for sign changes, long double does and is a thousand times faster.
using Quick = long double;

template <typename T>
T pi() {
  return boost::math::constants::pi<T>();
}

// The bandage tube of one segment.
struct Tube {
  Real inner = 0, thickness = 0;  // of the reference wall [m]
  std::vector<model::OgdenTerm> ogden;
  Real permittivity = 0;  // absolute [F/m]
  int layers = 1;
};

// A slice: a cylinder of leg, and the tube around it.
struct Slice {
  model::Leg leg;
  model::Compliance compliance;
  Real leg_radius = 0;  // undeformed [m]
  Tube tube;
  Real voltage = 0;  // [V]
};

inline Tube tube_of(const model::Bandage& bandage, const model::Module& module, Real mean_radius) {
  const Real reference =
      module.length > 0 ? Real(module.length) / (2 * pi<Real>()) : mean_radius / Real(module.stretch);
  const Real share = bandage.length_at == model::LengthAt::outer    ? Real(1)
                     : bandage.length_at == model::LengthAt::middle ? Real(1) / 2
                                                                    : Real(0);
  return {reference - share * Real(bandage.thickness), Real(bandage.thickness), bandage.ogden,
          Real(bandage.permittivity) * Real("8.8541878128e-12"), bandage.layers};
}

// The slice of a segment of a scene at a height between 0 and 1.
inline Slice slice_of(const model::Scene& scene, std::size_t segment, double height) {
  const model::Segment& piece = scene.leg.segments[segment];
  const model::Module& module = scene.bandage.modules[segment];
  const Real lower = piece.lower_radius, upper = piece.upper_radius;
  return {scene.leg, piece.compliance, lower + Real(height) * (upper - lower),
          tube_of(scene.bandage, module, (lower + upper) / 2), Real(module.voltage)};
}

// Eq. (4) as printed, without its sign, for a tube of inner radius `radius`.
template <typename T>
T mechanical_pressure(const Tube& tube, T radius) {
  using std::exp, std::log, std::sqrt, std::fabs;
  const T inner = T(tube.inner), outer = T(tube.inner + tube.thickness);
  const T deformed_outer = sqrt(radius * radius + outer * outer - inner * inner);
  const T from = deformed_outer / outer, to = radius / inner;
  // Over an interval of length 1, on which the tolerance is a relative one however thin the wall.
  const auto integrand = [&](const T& share) {
    const T lambda = from + share * (to - from);
    const T logarithm = log(lambda);
    T sum = 0;
    const T above = lambda * lambda - 1;
    for (const model::OgdenTerm& term : tube.ogden) {
      const T power = exp(T(term.alpha) * logarithm);
      sum += T(term.mu) * (above == 0 ? T(term.alpha) : (power - 1 / power) / above);  // limit at lambda = 1
    }
    return T(sum / lambda);
  };
  // Long double runs out of digits near lambda = 1, where no halving helps.
  const unsigned depth = std::is_same_v<T, Real> ? 12 : 3;
  const T tolerance = sqrt(std::numeric_limits<T>::epsilon()) * T(1e-3);
  return (to - from) *
         boost::math::quadrature::gauss_kronrod<T, 21>::integrate(integrand, T(0), T(1), depth, tolerance);
}

// Eq. (8) as printed, for each layer, at one volt.
template <typename T>
T unit_actuation(const Tube& tube, T radius) {
  using std::log, std::sqrt;
  const T inner = T(tube.inner), step = T(tube.thickness) / tube.layers;
  const auto deformed = [&](int k) {
    const T reference = inner + k * step;
    return T(sqrt(radius * radius + reference * reference - inner * inner));
  };
  T sum = 0;
  for (int k = 0; k < tube.layers; ++k) {
    const T a = deformed(k), b = deformed(k + 1), logarithm = log(b / a);
    sum += T(tube.permittivity) / (2 * logarithm * logarithm) * (b * b - a * a) / (a * a * b * b);
  }
  return sum;
}

// Field E = V/(r ln(b/a)) at the inner face of the layer where it is largest, at one volt.
inline Real unit_field(const Tube& tube, Real radius) {
  const Real step = tube.thickness / tube.layers;
  Real largest = 0;
  for (int k = 0; k < tube.layers; ++k) {
    const auto square = [&](int j) {
      const Real reference = tube.inner + j * step;
      return Real(radius * radius + reference * reference - tube.inner * tube.inner);
    };
    const Real a = sqrt(square(k)), b = sqrt(square(k + 1));
    largest = std::max(largest, Real(1 / (a * log(b / a))));
  }
  return largest;
}

// Eq. (9).
template <typename T>
T total_pressure(const Slice& slice, T radius, T voltage) {
  const T mechanical = mechanical_pressure<T>(slice.tube, radius);
  return voltage == 0 ? mechanical
                      : T(mechanical - voltage * voltage * unit_actuation<T>(slice.tube, radius));
}

// Pressure of the neo-Hookean cylinder, -dW/dy with y = (r/R)^2 = J and I1 = 2 y + 1.
template <typename T>
T neo_hookean_pressure(const model::Leg& leg, T strain) {
  using std::pow;
  const T shear = T(leg.young_modulus) / (2 * (1 + T(leg.poisson_ratio)));
  const T bulk = T(leg.young_modulus) / (3 * (1 - 2 * T(leg.poisson_ratio)));
  const T y = (1 - strain) * (1 - strain), third = T(1) / 3;
  return -(shear / 2 * (2 * third * pow(y, -2 * third) - 2 * third * pow(y, -5 * third)) + bulk * (y - 1));
}

// Eq. (2) as printed.
template <typename T>
T strain_law(const Slice& slice, T pressure) {
  using std::exp;
  const model::Compliance& law = slice.compliance;
  const T c = slice.leg.variant == model::ComplianceVariant::anchored ? T(-law.a) : T(law.c);
  return T(law.a) * exp(T(law.b) * pressure) + c * exp(T(law.d) * pressure);
}

// Root of a function that changes sign between two points, to 30 digits or those of T.
template <typename T, typename Function>
T root(const Function& function, T from, T to) {
  if (from > to) std::swap(from, to);
  const T at_from = function(from), at_to = function(to);
  if (at_from == 0) return from;
  if (at_to == 0) return to;
  std::uintmax_t steps = 2000;
  const int bits = std::min(100, std::numeric_limits<T>::digits - 3);
  const auto bracket = boost::math::tools::toms748_solve(function, from, to, at_from, at_to,
                                                         boost::math::tools::eps_tolerance<T>(bits), steps);
  return (bracket.first + bracket.second) / 2;
}

// The leg is followed by a parameter that both laws give explicitly: its pressure (strain law) or its strain
// (neo-Hookean); both grow together.
template <typename T>
struct Point {
  T pressure, radius;
};

template <typename T>
Point<T> leg_at(const Slice& slice, T parameter) {
  const T radius = T(slice.leg_radius);
  if (slice.leg.material == model::LegMaterial::neo_hookean)
    return {neo_hookean_pressure<T>(slice.leg, parameter), radius * (1 - parameter)};
  return {parameter, radius * (1 - strain_law<T>(slice, parameter))};
}

// Pressure of the leg less that of the bandage: 0 in equilibrium.
template <typename T>
T imbalance(const Slice& slice, T parameter, T voltage) {
  const Point<T> point = leg_at<T>(slice, parameter);
  return point.pressure - total_pressure<T>(slice, point.radius, voltage);
}

// The parameter at which the leg has shrunk to the reference radius of the bandage; 0: it is slack from the
// start.
inline Real slack_parameter(const Slice& slice) {
  const Real strain = 1 - slice.tube.inner / slice.leg_radius;
  if (slice.leg.material == model::LegMaterial::neo_hookean) return std::max(Real(0), strain);
  const auto missing = [&](const Real& p) { return Real(strain_law<Real>(slice, p) - strain); };
  if (missing(0) >= 0) return 0;
  Real high = 1 / Real(slice.compliance.b);
  while (missing(high) < 0) high *= 2;
  return root<Real>(missing, 0, high);
}

// The one equilibrium of a bandage that stiffens, at rest or on the way down from there; 0: no contact.
inline Real only_equilibrium(const Slice& slice, Real voltage) {
  const auto balance = [&](const Real& parameter) { return imbalance<Real>(slice, parameter, voltage); };
  const Real high = slack_parameter(slice);
  if (high <= 0 || balance(0) >= 0) return 0;
  return leg_at<Real>(slice, root<Real>(balance, 0, high)).pressure;
}

// Is function(x) positive? In long double where that is clear, else in 50 digits; `size` is that of its
// terms.
template <typename Function>
bool positive(const Function& function, const Real& x, Quick size) {
  const Quick quick = function(Quick(x));
  return std::fabs(quick) > 1e-7L * size ? quick > 0 : function(x) > 0;
}

// The first parameter on the way from `from`, where the leg has too much pressure (down = true) or too
// little, to `to`, at which there is equilibrium. `points` of the path are looked at, at the cubes of equal
// steps, since small pressures matter as much as large ones.
inline std::optional<Real> first_change(const Slice& slice, Real voltage, Real from, Real to, bool down,
                                        int points) {
  const auto balance = [&](const auto& parameter) {
    using T = std::decay_t<decltype(parameter)>;
    return imbalance<T>(slice, parameter, T(voltage));
  };
  const Real from_root = cbrt(from), to_root = cbrt(to);
  const auto at = [&](int k) {
    const Real q = from_root + (to_root - from_root) * k / points;
    return k == 0 ? from : k == points ? to : Real(q * q * q);
  };
  for (int k = 1; k <= points; ++k) {
    const auto size = leg_at<Quick>(slice, Quick(at(k))).pressure + 1e-3L;
    if (positive(balance, at(k), size) != down) return root<Real>(balance, at(k - 1), at(k));
  }
  return std::nullopt;
}

// The largest voltage for which the path from pressure `from` down to `to` (parameters) is in equilibrium
// somewhere, and where: V^2 = (P_m - P)/P_a(1 V) is maximised.
struct Peak {
  Real voltage, parameter;
};

inline Peak largest_voltage(const Slice& slice, Real from, Real to, int points = 400) {
  const auto square = [&](const auto& parameter) {
    using T = std::decay_t<decltype(parameter)>;
    const Point<T> point = leg_at<T>(slice, parameter);
    return T((mechanical_pressure<T>(slice.tube, point.radius) - point.pressure) /
             unit_actuation<T>(slice.tube, point.radius));
  };
  int best = 0;
  Quick largest = -1;
  for (int k = 0; k <= points; ++k) {
    const Quick value = square(Quick(from + (to - from) * k / points));
    if (value > largest) largest = value, best = k;
  }
  const Quick low = Quick(from + (to - from) * std::min(points, best + 1) / points),
              high = Quick(from + (to - from) * std::max(0, best - 1) / points);
  const auto found = boost::math::tools::brent_find_minima([&](const Quick& p) { return -square(p); },
                                                           std::min(low, high), std::max(low, high), 40);
  return {sqrt(square(Real(found.first))), Real(found.first)};
}

// The same for a bandage that floats free at radii from `start` to `end`; the parameter is the radius.
inline Peak largest_floating_voltage(const Tube& tube, Real start, Real end, int points = 400) {
  const auto square = [&](const auto& radius) {
    using T = std::decay_t<decltype(radius)>;
    return T(mechanical_pressure<T>(tube, radius) / unit_actuation<T>(tube, radius));
  };
  int best = 0;
  Quick largest = -1;
  const auto at = [&](int k) { return Quick(start + (end - start) * k / points); };
  for (int k = 0; k <= points; ++k)
    if (const Quick value = square(at(k)); value > largest) largest = value, best = k;
  const auto found =
      boost::math::tools::brent_find_minima([&](const Quick& r) { return -square(r); },
                                            at(std::max(0, best - 1)), at(std::min(points, best + 1)), 40);
  return {sqrt(square(Real(found.first))), Real(found.first)};
}

// Radius at which a bandage that presses on nothing, starting at `start` where the field overcomes it, comes
// to rest; none: it expands without end.
inline std::optional<Real> floating_radius(const Tube& tube, Real voltage, Real start, int points = 2000) {
  const auto pull = [&](const auto& radius) {
    using T = std::decay_t<decltype(radius)>;
    return T(mechanical_pressure<T>(tube, radius) -
             T(voltage) * T(voltage) * unit_actuation<T>(tube, radius));
  };
  const auto at = [&](int k) { return Real(start * exp(Real(9) * k / points)); };
  for (int k = 1; k <= points; ++k)
    if (positive(pull, at(k), mechanical_pressure<Quick>(tube, Quick(at(k)))))
      return root<Real>(pull, at(k - 1), at(k));
  return std::nullopt;
}

// What a slice should come to.
struct Expected {
  Real rest = 0, actuated = 0;             // pressures [Pa]
  Real rest_parameter = 0, parameter = 0;  // of the leg, at rest and under voltage; 0: no contact
  Real bandage_radius = 0;                 // under voltage; 0: pulled in [m]
  model::Status status = model::Status::contact;
};

// At rest the one equilibrium of a bandage that stiffens, or else the first as the pressure grows; under
// voltage the first on the way down from there.
inline Expected expectation(const Slice& slice, bool stiffens, int points) {
  Expected result;
  const auto balance = [&](const Real& parameter) { return imbalance<Real>(slice, parameter, 0); };
  const Real high = slack_parameter(slice);
  Real parameter = 0;
  if (high > 0 && balance(0) < 0)
    parameter = stiffens ? root<Real>(balance, 0, high) : *first_change(slice, 0, 0, high, false, points);
  if (parameter > 0) result.rest = leg_at<Real>(slice, parameter).pressure;
  result.rest_parameter = parameter;
  if (parameter == 0) result.status = model::Status::slack;
  if (parameter > 0 && slice.voltage > 0) {
    parameter = first_change(slice, slice.voltage, parameter, 0, true, points).value_or(0);
    if (parameter == 0) result.status = model::Status::lifted;
  }
  result.parameter = parameter;
  const Point<Real> point = leg_at<Real>(slice, parameter);
  result.actuated = parameter > 0 ? point.pressure : Real(0);
  result.bandage_radius = parameter > 0 ? point.radius : std::max(point.radius, slice.tube.inner);
  if (parameter == 0 && slice.voltage > 0) {
    result.bandage_radius =
        floating_radius(slice.tube, slice.voltage, result.bandage_radius, 2 * points).value_or(0);
    if (result.bandage_radius == 0) result.status = model::Status::pulled_in;
  }
  const Real largest = std::max(result.rest, result.actuated);
  if (slice.leg.material == model::LegMaterial::compliance && largest > slice.leg.data_limit)
    result.status = std::max(result.status, model::Status::extrapolated);
  return result;
}

}  // namespace gaiter::reference
