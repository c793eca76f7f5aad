// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "gaiter/physics/quadrature.hpp"
#include "gaiter/solvers/axisym_system.hpp"

// Integrals of the contact pressure over a deformed segment, in the problem's units.
namespace gaiter::axisym {

struct ContactIntegrals {
  double mean = 0;           // (1/H) int p dz
  double interior_mean = 0;  // the same over the middle 80 % of the height
  double area_mean = 0;      // normal force over the area of the tube's whole inner face
  double radial_force = 0;   // int 2 pi r p dz
  double axial_force = 0;    // int 2 pi r p dr: what pushes the tube towards its narrow end
  double slip = 0;           // largest change of height of a node of the tube
  int open = 0;              // vertices without contact
};

template <int P>
ContactIntegrals contact_integrals(const solvers::AxisymSystem<P>& system) {
  using Surface = typename solvers::AxisymSystem<P>::SurfaceState;
  static const physics::Quadrature rule = physics::gauss_legendre(P + 3);
  const auto& lagrange = physics::lagrange_coefficients<P>();
  // Value and slope of a nodal quantity at a place of an edge.
  const auto at = [&](const std::vector<double>& values, std::size_t edge, double place) {
    double value = 0, slope = 0;
    for (int k = P; k >= 0; --k) {
      double coefficient = 0;
      for (int i = 0; i <= P; ++i) coefficient += lagrange[i][k] * values[P * edge + i];
      slope = slope * place + value;
      value = value * place + coefficient;
    }
    return std::array<double, 2>{value, slope};
  };
  // Where on an edge a height is; its ends for heights beyond them.
  const auto place_of = [&](const Surface& surface, std::size_t edge, double height) {
    double low = 0, high = 1;
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (low + high);
      (at(surface.height, edge, middle)[0] < height ? low : high) = middle;
    }
    return 0.5 * (low + high);
  };
  const auto integrate = [&](const Surface& surface, double from, double to, auto&& integrand) {
    double total = 0;
    for (std::size_t edge = 0; P * edge + P < surface.radius.size(); ++edge) {
      const double begin = place_of(surface, edge, from), end = place_of(surface, edge, to);
      for (std::size_t g = 0; g < rule.nodes.size(); ++g) {
        const double x = begin + rule.nodes[g] * (end - begin);
        const double pressure =
            (1 - x) * surface.multiplier[P * edge] + x * surface.multiplier[P * (edge + 1)];
        total += rule.weights[g] * (end - begin) *
                 integrand(pressure, at(surface.radius, edge, x), at(surface.height, edge, x));
      }
    }
    return total;
  };
  using Pair = std::array<double, 2>;
  const Surface& tube = system.tubes()[0];
  const Surface& carrier = system.space().choice.multipliers_on_tube ? tube : system.leg();
  const double height = tube.height.back();
  const auto along_height = [](double p, Pair, Pair z) { return p * z[1]; };
  ContactIntegrals sum;
  sum.mean = integrate(carrier, 0, height, along_height) / height;
  sum.interior_mean = integrate(carrier, 0.1 * height, 0.9 * height, along_height) / (0.8 * height);
  sum.radial_force =
      integrate(carrier, 0, height, [](double p, Pair r, Pair z) { return 2 * M_PI * r[0] * p * z[1]; });
  sum.axial_force =
      integrate(carrier, 0, height, [](double p, Pair r, Pair) { return 2 * M_PI * r[0] * p * r[1]; });
  const double normal_force = integrate(carrier, 0, height, [](double p, Pair r, Pair z) {
    return 2 * M_PI * r[0] * p * std::hypot(r[1], z[1]);
  });
  sum.area_mean = normal_force / integrate(tube, 0, height, [](double, Pair r, Pair z) {
                    return 2 * M_PI * r[0] * std::hypot(r[1], z[1]);
                  });
  const auto& nodes = system.space().tubes[0].nodes;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    sum.slip = std::max(sum.slip, std::fabs(tube.height[i] - nodes[i].height));
  for (std::size_t i = 0; i < carrier.active.size(); i += P) sum.open += !carrier.active[i];
  return sum;
}

// The pressure at current heights over the whole height, linear between the vertices that carry it.
template <int P>
std::vector<double> contact_pressures(const solvers::AxisymSystem<P>& system,
                                      const std::vector<double>& relative_heights) {
  const auto& carrier = system.space().choice.multipliers_on_tube ? system.tubes()[0] : system.leg();
  std::vector<double> result;
  for (double relative : relative_heights) {
    const double height = relative * system.tubes()[0].height.back();
    std::size_t above = P;
    while (above + P < carrier.height.size() && carrier.height[above] < height) above += P;
    const double below = carrier.height[above - P];
    const double place = (height - below) / (carrier.height[above] - below);
    result.push_back((1 - place) * carrier.multiplier[above - P] + place * carrier.multiplier[above]);
  }
  return result;
}

}  // namespace gaiter::axisym
