// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/axisym_start.hpp"

#include <algorithm>
#include <cmath>

#include "gaiter/petsc/check.hpp"
#include "gaiter/physics/quadrature.hpp"

namespace gaiter::solvers {

namespace {

constexpr int wall_points = 8;

// The incompressible thick wall at reference inner radius A, deformed inner radius a and axial stretch l,
// pressed by P: r^2 = a^2 + (R^2 - A^2)/l. Lengths and stresses in one unit each.
struct WallState {
  double inner_reference, inner, axial_stretch, pressure;
  const physics::TubeMaterial& material;

  double deformed(double R) const {
    return std::sqrt(inner * inner + (R - inner_reference) * (R + inner_reference) / axial_stretch);
  }

  // The element's pressure p, from the radial stress
  // sigma_r(R) = -P + int (sigma_t - sigma_r) d rho / rho, d rho / rho = R dR / (l rho^2).
  double pressure_field(double R) const {
    static const physics::Quadrature rule = physics::gauss_legendre(wall_points);
    double radial = -pressure;
    for (std::size_t g = 0; g < rule.nodes.size(); ++g) {
      const double at = inner_reference + rule.nodes[g] * (R - inner_reference), rho = deformed(at);
      const double hoop = rho / at;
      double difference = 0;
      for (const auto& term : material.ogden)
        difference +=
            term.mu * (std::pow(hoop, term.alpha) - std::pow(1 / (hoop * axial_stretch), term.alpha));
      radial += rule.weights[g] * (R - inner_reference) * difference * at / (axial_stretch * rho * rho);
    }
    const double hoop = deformed(R) / R, across = 1 / (hoop * axial_stretch);
    for (const auto& term : material.ogden) {
      const double own = std::pow(across, term.alpha);
      radial -= term.mu * own;
      // With a bulk modulus p is the mean stress, without it what the plain stretches leave (TubeMaterial).
      if (std::isfinite(material.bulk_modulus))
        radial += term.mu / 3 * (std::pow(hoop, term.alpha) + std::pow(axial_stretch, term.alpha) + own);
    }
    return radial;
  }
};

// Value at a place in (0, 1) of the polynomial through P + 1 values at the nodes of a row of cells.
template <int P>
double interpolate(const std::vector<double>& values, int row, double place) {
  const auto& c = physics::lagrange_coefficients<P>();
  double sum = 0;
  for (int k = P; k >= 0; --k) {
    double coefficient = 0;
    for (int i = 0; i <= P; ++i) coefficient += c[i][k] * values[P * row + i];
    sum = sum * place + coefficient;
  }
  return sum;
}

}  // namespace

template <int P>
PetscErrorCode set_start(const AxisymSystem<P>& system, const std::vector<RadialState>& states, Vec x) {
  using Element = physics::AxisymElement<P>;
  PetscFunctionBegin;
  const AxisymSpace<P>& space = system.space();
  const double length = space.mesh.length, stress = system.materials().stress;
  std::vector<PetscInt> places;
  std::vector<PetscScalar> values;
  const auto put = [&](PetscInt place, double value) {
    if (place < 0) return;
    places.push_back(place);
    values.push_back(value);
  };
  for (const AxisymCell<P>& cell : space.cells) {
    const AxisymBlock& block = space.mesh.blocks[cell.block];
    const RadialState& state = states[cell.block];
    const double inner_reference = block.inner[0];
    const physics::TubeMaterial& tube = system.materials().tubes[block.tube ? cell.block : 0];
    for (int j = 0; j <= P; ++j)
      for (int i = 0; i <= P; ++i) {
        const int node = i + (P + 1) * j, place = P * cell.row + j;
        const double R = cell.geometry.position[node][0];
        if (block.tube) {
          const WallState wall{inner_reference, state.tube_radius[place] / length, state.axial_stretch[place],
                               0, tube};
          put(cell.global[2 * node], wall.deformed(R) - R);
          put(cell.global[2 * node + 1], state.height[place] / length - cell.geometry.position[node][1]);
        } else {
          put(cell.global[2 * node], -R * state.leg_strain[place]);
          put(cell.global[2 * node + 1], 0);
        }
      }
    if (!block.tube) continue;
    // Pressures by projection on their orthogonal polynomials.
    std::array<double, Element::pressures> moment{}, norm{};
    for (int g = 0; g < Element::points; ++g) {
      const auto [along_R, along_Z] = cell.geometry.place[g];
      const double R =
          block.inner[0] + (block.outer[0] - block.inner[0]) *
                               (block.across[cell.column] +
                                along_R * (block.across[cell.column + 1] - block.across[cell.column]));
      const WallState wall{inner_reference, interpolate<P>(state.tube_radius, cell.row, along_Z) / length,
                           interpolate<P>(state.axial_stretch, cell.row, along_Z),
                           interpolate<P>(state.pressure, cell.row, along_Z) / stress, tube};
      const double pressure = wall.pressure_field(R);
      for (int q = 0; q < Element::pressures; ++q) {
        moment[q] += cell.geometry.share[g] * pressure * cell.geometry.pressure[g][q];
        norm[q] += cell.geometry.share[g] * cell.geometry.pressure[g][q] * cell.geometry.pressure[g][q];
      }
    }
    for (int q = 0; q < Element::pressures; ++q)
      put(cell.global[2 * Element::nodes + q], moment[q] / norm[q]);
  }
  PetscCall(VecSet(x, 0));
  PetscCall(
      VecSetValues(x, static_cast<PetscInt>(places.size()), places.data(), values.data(), INSERT_VALUES));
  const auto put_multipliers = [&](const ContactSurface& surface,
                                   const RadialState& state) -> PetscErrorCode {
    PetscFunctionBegin;
    for (std::size_t i = 0; i < surface.nodes.size(); ++i)
      if (surface.nodes[i].multiplier >= 0)
        PetscCall(VecSetValue(x, surface.nodes[i].multiplier, state.pressure[i] / stress, INSERT_VALUES));
    PetscFunctionReturn(PETSC_SUCCESS);
  };
  for (const ContactSurface& tube : space.tubes) PetscCall(put_multipliers(tube, states[tube.block]));
  PetscCall(put_multipliers(space.leg, states[space.leg.block]));
  PetscCall(VecAssemblyBegin(x));
  PetscCall(VecAssemblyEnd(x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define GAITER_START(P) \
  template PetscErrorCode set_start<P>(const AxisymSystem<P>&, const std::vector<RadialState>&, Vec);
GAITER_START(2)
GAITER_START(3)
GAITER_START(4)

}  // namespace gaiter::solvers
