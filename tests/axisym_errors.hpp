// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>

#include "axisym_problem.hpp"
#include "fitted_order.hpp"
#include "gaiter/physics/quadrature.hpp"

// How far finite element solutions of cylinders are from the known ones, and the orders of that.
namespace gaiter::axisym {

// A cylinder's solution, lengths over the leg's radius, stresses over the elastomer's shear modulus.
struct Exact {
  std::function<double(double)> displacement, pressure;  // radial; pressure field; at reference radius R
  std::function<double(double)> potential{};             // over the voltage, where the space has one
  double contact = 0;                                    // contact pressure
  double leg_stretch = 1;                                // r/R of the leg
};

// Relative; the first two in L2 over the tube, then at the worst contact vertex and at the leg's worst node
// (both absolute where nothing presses), and the potential's in L2.
struct Errors {
  double displacement = 0, pressure = 0, contact = 0, leg = 0, potential = 0;
};

// Of the local Vec of the space's DM.
template <int P>
std::size_t local_size(const solvers::AxisymSpace<P>& space) {
  PetscInt largest = 0;
  for (const auto& cell : space.cells)
    for (PetscInt place : cell.local) largest = std::max(largest, place + 1);
  return static_cast<std::size_t>(largest);
}

template <int P>
Errors errors(const solvers::AxisymSpace<P>& space, const std::vector<double>& x, const Exact& exact) {
  using Element = physics::AxisymElement<P>;
  static const physics::Quadrature rule = physics::gauss_legendre(P + 4);
  const auto& lagrange = physics::lagrange_coefficients<P>();
  const auto shape = [&](int i, double place) {
    double sum = 0;
    for (int k = P; k >= 0; --k) sum = sum * place + lagrange[i][k];
    return sum;
  };
  const auto at = [&](PetscInt place) { return place < 0 ? 0.0 : x[place]; };
  Errors result;
  double displacement = 0, pressure = 0, potential = 0;  // squares of the norms
  std::vector<double> fixed(space.cells.empty() ? 0 : local_size<P>(space), 0.0);
  for (const auto& [place, value] : space.electrodes) fixed[place] = value;
  for (const auto& cell : space.cells) {
    const solvers::AxisymBlock& block = space.mesh.blocks[cell.block];
    if (!block.tube) {
      for (int a = 0; a < Element::nodes; ++a) {
        const double moved = (exact.leg_stretch - 1) * cell.geometry.position[a][0];
        result.leg = std::max(
            {result.leg, std::fabs(at(cell.global[2 * a]) - moved), std::fabs(at(cell.global[2 * a + 1]))});
      }
      continue;
    }
    const auto low = block.position(cell.column, cell.row),
               high = block.position(cell.column + 1, cell.row + 1);
    for (std::size_t gy = 0; gy < rule.nodes.size(); ++gy)
      for (std::size_t gx = 0; gx < rule.nodes.size(); ++gx) {
        const double R = low[0] + rule.nodes[gx] * (high[0] - low[0]);
        const double weight =
            rule.weights[gx] * rule.weights[gy] * R * (high[0] - low[0]) * (high[1] - low[1]);
        double u_r = -exact.displacement(R), u_z = 0, p = -exact.pressure(R);
        displacement += weight * u_r * u_r;
        pressure += weight * p * p;
        for (int j = 0; j <= P; ++j)
          for (int i = 0; i <= P; ++i) {
            const double value = shape(i, rule.nodes[gx]) * shape(j, rule.nodes[gy]);
            u_r += value * at(cell.global[2 * (i + (P + 1) * j)]);
            u_z += value * at(cell.global[2 * (i + (P + 1) * j) + 1]);
          }
        for (int degree = 0, q = 0; degree < P; ++degree)
          for (int k = 0; k <= degree; ++k, ++q)
            p += at(cell.global[2 * Element::nodes + q]) * std::legendre(degree - k, 2 * rule.nodes[gx] - 1) *
                 std::legendre(k, 2 * rule.nodes[gy] - 1);
        if (space.choice.layers) {
          double phi = -exact.potential(R);
          potential += weight * phi * phi;
          for (int a = 0; a < Element::nodes; ++a) {
            const int unknown = Element::tube_unknowns + a;
            phi += shape(a % (P + 1), rule.nodes[gx]) * shape(a / (P + 1), rule.nodes[gy]) *
                   (cell.global[unknown] < 0 ? fixed[cell.local[unknown]] : x[cell.global[unknown]]);
          }
          result.potential += weight * phi * phi;
        }
        result.displacement += weight * (u_r * u_r + u_z * u_z);
        result.pressure += weight * p * p;
      }
  }
  result.displacement = std::sqrt(result.displacement / displacement);
  result.pressure = std::sqrt(result.pressure / pressure);
  if (potential > 0) result.potential = std::sqrt(result.potential / potential);
  if (exact.leg_stretch != 1) result.leg /= std::fabs(exact.leg_stretch - 1);
  const auto& carrier = space.choice.multipliers_on_tube ? space.tubes[0] : space.leg;
  for (const auto& node : carrier.nodes)
    if (node.multiplier >= 0)
      result.contact = std::max(result.contact, std::fabs(x[node.multiplier] - exact.contact) /
                                                    (exact.contact != 0 ? exact.contact : 1));
  return result;
}

// The second solve takes what the first one's last step leaves.
template <int P>
void solve_to_rounding(Problem<P>& problem) {
  for (int k = 0; k < 2; ++k) {
    const auto report = problem.solver.solve(problem.x.get());
    EXPECT_TRUE(report.converged && report.stable);
  }
}

// The meshes of tube and leg never match.
inline solvers::AxisymResolution resolution(int refinements) {
  solvers::AxisymResolution result;
  result.tube_rows = 2;
  result.tube_columns = 1;
  result.leg_rows = 3;
  result.leg_columns = 1;
  result.end_grading = 2;
  result.refinements = refinements;
  return result;
}

struct Orders : Errors {
  Errors coarsest;
};

// Orders over the meshes 0, 1, ..., of errors above rounding; printed with the errors.
inline Orders orders(const std::string& name, const std::vector<Errors>& meshes, double rounding) {
  const auto order = [&](double Errors::*of) {
    std::vector<double> size, values;
    for (std::size_t k = 0; k < meshes.size() && meshes[k].*of > rounding; ++k) {
      size.push_back(std::ldexp(1.0, -static_cast<int>(k)));
      values.push_back(meshes[k].*of);
    }
    return fitted_order(size, values);  // of one error or none: NaN
  };
  const Orders fitted{{order(&Errors::displacement), order(&Errors::pressure), order(&Errors::contact),
                       order(&Errors::leg), order(&Errors::potential)},
                      meshes[0]};
  std::printf("%s\n  mesh  displacement  pressure field  contact pressure       leg  potential\n",
              name.c_str());
  for (std::size_t k = 0; k < meshes.size(); ++k)
    std::printf("  %4zu  %12.2e  %14.2e  %16.2e  %8.1e  %9.1e\n", k, meshes[k].displacement,
                meshes[k].pressure, meshes[k].contact, meshes[k].leg, meshes[k].potential);
  std::printf("  order %12.2f  %14.2f  %16.2f  %8.2f  %9.2f\n", fitted.displacement, fitted.pressure,
              fitted.contact, fitted.leg, fitted.potential);
  return fitted;
}

// One more than the pressure field's, whose polynomials are one degree lower.
template <int P>
void expect_orders(const Orders& fitted) {
  EXPECT_NEAR(fitted.displacement, P + 1, 0.15);
  EXPECT_NEAR(fitted.pressure, P, 0.1);
}

}  // namespace gaiter::axisym
