// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/axisym_energy.hpp"

#include <cmath>

namespace gaiter::physics {

namespace {

template <int N>
Jet<N> power(const Jet<N>& x, double exponent) {
  const double value = std::pow(x.value, exponent);
  const double first = exponent * value / x.value;
  return compose(x, value, first, (exponent - 1) * first / x.value);
}

// (1 + sqrt x)^alpha + (1 - sqrt x)^alpha and its derivatives, by its series where the root would lose
// digits.
template <int N>
Jet<N> twin_powers(const Jet<N>& x, double alpha) {
  double value = 0, first = 0, second = 0;
  if (x.value < 1e-3) {
    double binomial = 2, monomial = 1;  // 2 C(alpha, 2k), x^k
    std::array<double, 8> coefficient{};
    for (int k = 0; k < 8; ++k) {
      coefficient[k] = binomial;
      binomial *= (alpha - 2 * k) * (alpha - 2 * k - 1) / ((2.0 * k + 1) * (2.0 * k + 2));
    }
    for (int k = 0; k < 8; ++k, monomial *= x.value) {
      value += coefficient[k] * monomial;
      if (k + 1 < 8) first += (k + 1) * coefficient[k + 1] * monomial;
      if (k + 2 < 8) second += (k + 2.0) * (k + 1) * coefficient[k + 2] * monomial;
    }
  } else {
    const double root = std::sqrt(x.value);
    const double plus = std::pow(1 + root, alpha), minus = std::pow(1 - root, alpha);
    const double slope = alpha * (plus / (1 + root) - minus / (1 - root));
    const double curvature =
        alpha * (alpha - 1) * (plus / ((1 + root) * (1 + root)) + minus / ((1 - root) * (1 - root)));
    value = plus + minus;
    first = slope / (2 * root);
    second = (curvature - slope / root) / (4 * x.value);
  }
  return compose(x, value, first, second);
}

template <int N>
Jet<N> squares(const Deformation<N>& f) {
  return f.rR * f.rR + f.rZ * f.rZ + f.zR * f.zR + f.zZ * f.zZ;
}

// Integral of the pressure over dJ from J = 1 to (1 - strain)^2, negative: the leg's volumetric energy, less
// its shear part. By parts, int 2 (1 - e) P de = -(1 - e)^2 P + int (1 - e(P))^2 dP, and e(P) is explicit.
double volumetric_energy(const LegMaterialLaw& law, double strain, double pressure) {
  const auto integral = [](double rate, double p) { return rate == 0 ? p : std::expm1(rate * p) / rate; };
  const auto square = [&](double p) {
    return p - 2 * law.a * integral(law.b, p) - 2 * law.c * integral(law.d, p) +
           law.a * law.a * integral(2 * law.b, p) + 2 * law.a * law.c * integral(law.b + law.d, p) +
           law.c * law.c * integral(2 * law.d, p);
  };
  const double at_rest =
      pressure_of_strain(law, 0).pressure;  // of the published law, which does not pass through 0
  const double ratio = 1 - strain;
  return (at_rest - ratio * ratio * pressure) + square(pressure) - square(at_rest);
}

}  // namespace

template <int N>
Jet<N> in_plane_powers(const Deformation<N>& f, double alpha) {
  const Jet<N> sum = squares(f), twice = 2.0 * f.in_plane();
  const Jet<N> mean = 0.25 * (sum + twice);        // ((l1 + l2)/2)^2
  const Jet<N> difference = 0.25 * (sum - twice);  // ((l1 - l2)/2)^2
  return power(mean, 0.5 * alpha) * twin_powers(difference / mean, alpha);
}

template <int N>
Jet<N> tube_energy(const TubeMaterial& material, const Deformation<N>& f, const Jet<N>& pressure) {
  const Jet<N> volume = f.volume();
  const Jet<N> dilation = volume - 1.0;
  Jet<N> energy = pressure * dilation + (0.5 * material.stabilisation) * (dilation * dilation);
  const bool compressible = std::isfinite(material.bulk_modulus);
  if (compressible)
    energy -= (0.5 / (material.bulk_modulus - material.stabilisation)) * (pressure * pressure);
  for (const model::OgdenTerm& term : material.ogden) {
    const Jet<N> sum = in_plane_powers(f, term.alpha) + power(f.t, term.alpha);
    // Isochoric stretches make p the mean stress of a compressible tube. Without compressibility p takes that
    // part up,
    // and the plain stretches let Newton's method converge from much further away.
    energy += (term.mu / term.alpha) * ((compressible ? power(volume, -term.alpha / 3) * sum : sum) - 3.0);
  }
  return energy;
}

template <int N>
Jet<N> electric_energy(double permittivity, const Deformation<N>& f, const Jet<N>& phi_R,
                       const Jet<N>& phi_Z) {
  const Jet<N> r = f.zZ * phi_R - f.zR * phi_Z, z = f.rR * phi_Z - f.rZ * phi_R;
  return (-0.5 * permittivity) * ((r * r + z * z) * f.t / f.in_plane());
}

template <int N>
Jet<N> closed_form_electric_energy(double permittivity, const Deformation<N>& f, double R, double inner,
                                   double outer) {
  const Jet<N> along = sqrt(f.rZ * f.rZ + f.zZ * f.zZ), radius = R * f.t, square = radius * radius;
  const Jet<N> low = square * along - (R - inner) * (R + inner);  // rho_i^2 l
  const Jet<N> growth = ((outer - inner) * (outer + inner)) * reciprocal(low);
  const double r = 1 / (1 + growth.value);
  const Jet<N> logarithm = 0.5 * compose(growth, std::log1p(growth.value), r, -r * r);
  return (-0.5 * permittivity) * reciprocal(square * logarithm * logarithm);
}

LegMaterialLaw leg_material(const model::Leg& leg, const model::Segment& segment) {
  LegMaterialLaw law;
  law.kind = leg.material;
  if (leg.material == model::LegMaterial::neo_hookean) {
    law.shear_modulus = leg.young_modulus / (2 * (1 + leg.poisson_ratio));
    law.bulk_modulus = leg.young_modulus / (3 * (1 - 2 * leg.poisson_ratio));
    return law;
  }
  const model::Compliance& published = segment.compliance;
  const double c = leg.variant == model::ComplianceVariant::anchored ? -published.a : published.c;
  law.shear_modulus = leg.shear_modulus;
  law.a = published.a;
  law.b = published.b;
  law.c = c;
  law.d = published.d;
  return law;
}

PressureOfStrain pressure_of_strain(const LegMaterialLaw& law, double strain) {
  // f(P) = a exp(bP) + c exp(dP) - strain grows; the root lies between where one of the exponentials is 1 or
  // 0.
  const auto residual = [&](double p) {
    return law.a * std::expm1(law.b * p) + law.c * std::expm1(law.d * p) + (law.a + law.c - strain);
  };
  const auto slope = [&](double p) {
    return law.a * law.b * std::exp(law.b * p) + law.c * law.d * std::exp(law.d * p);
  };
  double low = 0, high = 0;
  if (strain >= law.a + law.c)
    high = std::log((strain - law.c) / law.a) / law.b;
  else
    low = law.c < 0 ? std::log((law.a - strain) / -law.c) / law.d : -std::numeric_limits<double>::infinity();
  if (!std::isfinite(low) || !std::isfinite(high)) return {NAN, NAN};
  double p = residual(0) / -slope(0);
  for (int iteration = 0; iteration < 100; ++iteration) {
    if (!(p > low && p < high)) p = 0.5 * (low + high);
    const double value = residual(p);
    (value < 0 ? low : high) = p;
    const double step = -value / slope(p);
    p += step;
    if (std::fabs(step) <= 4e-16 * std::fabs(p) || high - low <= 4e-16 * std::fabs(high)) break;
  }
  return {p, 1 / slope(p)};
}

template <int N>
Jet<N> leg_energy(const LegMaterialLaw& law, const Deformation<N>& f) {
  if (law.other) return law.other(law, f);
  const Jet<N> volume = f.volume();
  const Jet<N> first = squares(f) + f.t * f.t;  // I1
  if (law.kind == model::LegMaterial::neo_hookean)
    return (0.5 * law.shear_modulus) * (power(volume, -2.0 / 3) * first - 3.0) +
           (0.5 * law.bulk_modulus) * ((volume - 1.0) * (volume - 1.0));
  const double ratio = std::sqrt(volume.value), strain = 1 - ratio;
  const PressureOfStrain at = pressure_of_strain(law, strain);
  // U less its part -G (J - 1 - ln J), which joins the shear term.
  const Jet<N> compression =
      compose(volume, volumetric_energy(law, strain, at.pressure), -at.pressure, at.slope / (2 * ratio));
  return (0.5 * law.shear_modulus) * (first - 1.0 - 2.0 * volume) + compression;
}

template Jet<5> in_plane_powers(const Deformation<5>&, double);
template Jet<6> tube_energy(const TubeMaterial&, const Deformation<6>&, const Jet<6>&);
template Jet<8> tube_energy(const TubeMaterial&, const Deformation<8>&, const Jet<8>&);
template Jet<6> closed_form_electric_energy(double, const Deformation<6>&, double, double, double);
template Jet<8> electric_energy(double, const Deformation<8>&, const Jet<8>&, const Jet<8>&);
template Jet<5> leg_energy(const LegMaterialLaw&, const Deformation<5>&);

}  // namespace gaiter::physics
