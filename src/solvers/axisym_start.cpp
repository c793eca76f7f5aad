// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/axisym_start.hpp"

#include <algorithm>
#include <cmath>

#include "gaiter/petsc/check.hpp"
#include "gaiter/physics/slice_kernel.hpp"
#include "gaiter/solvers/slice_solver.hpp"

namespace gaiter::solvers {

namespace {

using physics::pack_width;
using physics::PackState;
using physics::SliceShape;

constexpr int wall_points = 8;

// Radial Cauchy stress and pressure field of an incompressible tube at reference radius R, inner radius a
// pressed by P.
struct WallState {
  double inner_reference, inner, pressure;  // A, a, P; lengths and stresses in one unit each
  const std::vector<model::OgdenTerm>& ogden;
  bool compressible = false;  // the pressure field is then the mean stress

  double deformed(double R) const {
    return std::sqrt(inner * inner + (R - inner_reference) * (R + inner_reference));
  }

  double pressure_field(double R) const {
    // sigma_r(R) = -P + int (sigma_t - sigma_r) d rho / rho, d rho / rho = R dR / rho^2.
    static const physics::Quadrature rule = physics::gauss_legendre(wall_points);
    double radial = -pressure;
    for (std::size_t g = 0; g < rule.nodes.size(); ++g) {
      const double at = inner_reference + rule.nodes[g] * (R - inner_reference), rho = deformed(at);
      double difference = 0;
      for (const auto& term : ogden)
        difference += term.mu * (std::pow(rho / at, term.alpha) - std::pow(at / rho, term.alpha));
      radial += rule.weights[g] * (R - inner_reference) * difference * at / (rho * rho);
    }
    const double stretch = deformed(R) / R;
    for (const auto& term : ogden) {
      const double around = std::pow(stretch, term.alpha), across = 1 / around;
      radial -= term.mu * across;
      if (compressible) radial += term.mu * (around + across + 1) / 3;
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

RadialState slice_states(const model::Scene& scene, std::size_t segment,
                         std::span<const double> relative_heights, bool actuated) {
  const model::Segment& leg = scene.leg.segments[segment];
  const model::Module& module = scene.bandage.modules[segment];
  const std::size_t count = relative_heights.size();
  SliceShape shape{physics::gauss_legendre(wall_points), static_cast<int>(scene.bandage.ogden.size()),
                   scene.bandage.layers, scene.leg.material};
  physics::SliceSystem system(shape, count);
  RadialState result;
  for (std::size_t i = 0; i < count; ++i) {
    const double radius = leg.lower_radius + relative_heights[i] * (leg.upper_radius - leg.lower_radius);
    const physics::Wall wall = physics::reference_wall(scene.bandage, module, leg.mean_radius(), radius);
    system.set(i, scene.leg, leg, scene.bandage, wall, radius, module.voltage);
    result.leg_radius.push_back(radius);
    result.tube_radius.push_back(wall.inner_radius);
  }
  std::vector<PackState> states(system.packs());
  SliceSolver solver(PETSC_COMM_SELF, system.packs(), model::SliceSolver::newton, 0);
  system.energise(false);
  physics::Pack rigid;
  solver.solve(system, states, [&](std::size_t k) {
    physics::start_at_rest(system.shape(), system.pack(k), states[k], rigid);
  });
  if (actuated) {
    system.energise(true);
    solver.solve(system, states, [&](std::size_t k) { physics::start_actuated(states[k]); });
  }
  for (std::size_t i = 0; i < count; ++i) {
    const PackState& state = states[i / pack_width];
    const int place = static_cast<int>(i % pack_width);
    result.pressure.push_back(state.pressure[place] * system.constant(i, SliceShape::pressure_scale));
    result.leg_radius[i] *= 1 - state.strain[place];
    if (state.pressure[place] > 0 || result.leg_radius[i] > result.tube_radius[i])
      result.tube_radius[i] = result.leg_radius[i];
  }
  return result;
}

template <int P>
PetscErrorCode set_slice_start(const AxisymSystem<P>& system, const std::vector<RadialState>& states, Vec x) {
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
    for (int j = 0; j <= P; ++j)
      for (int i = 0; i <= P; ++i) {
        const int node = i + (P + 1) * j, place = P * cell.row + j;
        const double R = cell.geometry.position[node][0];
        double moved = 0;
        if (block.tube) {
          const double inner = state.tube_radius[place] / length;
          moved = std::sqrt(inner * inner + (R - inner_reference) * (R + inner_reference)) - R;
        } else {
          const ContactSurface& skin = space.leg;
          moved = R * (state.leg_radius[place] / length / skin.nodes[place].radius - 1);
        }
        put(cell.global[2 * node], moved);
        put(cell.global[2 * node + 1], 0);
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
                           interpolate<P>(state.pressure, cell.row, along_Z) / stress,
                           system.materials().tube.ogden,
                           std::isfinite(system.materials().tube.bulk_modulus)};
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
  template PetscErrorCode set_slice_start<P>(const AxisymSystem<P>&, const std::vector<RadialState>&, Vec);
GAITER_START(2)
GAITER_START(3)
GAITER_START(4)

}  // namespace gaiter::solvers
