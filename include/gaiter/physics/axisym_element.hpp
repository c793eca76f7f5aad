// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <array>

#include "gaiter/physics/axisym_energy.hpp"
#include "gaiter/physics/contact.hpp"

// Elements of the axisymmetric bodies: total Lagrangian quadrilaterals with straight sides in the (R, Z) half
// plane. Displacement: tensor Lagrange of order P on Gauss-Lobatto nodes; pressure, for the tube:
// discontinuous, products of Legendre polynomials of degree up to P - 1 in all (inf-sup stable). All
// integrals over the reference volume 2 pi R dR dZ. Lengths and stresses may be in any unit, as long as it is
// one.
namespace gaiter::physics {

template <int P>
struct AxisymElement {
  static constexpr int nodes = (P + 1) * (P + 1);  // node (i, j) at i + (P + 1) j, i along R, j along Z
  static constexpr int pressures = P * (P + 1) / 2;
  static constexpr int points = (P + 1) * (P + 1);  // Gauss points
  static constexpr int leg_unknowns = 2 * nodes;    // u_r, u_z of each node in turn
  static constexpr int tube_unknowns = 2 * nodes + pressures;
  static constexpr int charged_unknowns = tube_unknowns + nodes;  // and the electric potential at each node

  // Corners in the order (0,0), (1,0), (1,1), (0,1) of the local coordinates; R >= 0, counterclockwise.
  struct Geometry {
    std::array<std::array<double, nodes>, points> d_R{}, d_Z{}, over_R{};  // dN/dR, dN/dZ, N/R at each point
    std::array<std::array<double, pressures>, points> pressure{};
    std::array<double, points> weight{};                  // 2 pi R |Jacobian| x Gauss weight
    std::array<double, points> radius{};                  // R of the points
    std::array<std::array<double, 2>, nodes> position{};  // (R, Z) of the nodes
    std::array<std::array<double, 2>, points> place{};    // local coordinates of the points
    std::array<double, points> share{};                   // Gauss weights, sum 1
  };
  static Geometry geometry(const std::array<std::array<double, 2>, 4>& corners);

  // The share of the field's energy that acts on a wall, and its reference radii.
  struct WallField {
    double share = 0;
    double inner_radius = 0, outer_radius = 0;
  };

  // Potential energy, residual and tangent (row by row, symmetric) of an element. False where the element is
  // inverted or its numbers are not finite: the trial is inadmissible. The tube's electric field is the
  // closed form across the wall.
  static bool tube(const Geometry& geometry, const TubeMaterial& material, const WallField& field,
                   const double* unknowns, double& energy, double* residual, double* tangent);
  // The same with the electric potential, over the voltage, as an unknown. Without a share of the field the
  // potential is that of the undeformed wall, so that its rows never vanish.
  static bool charged_tube(const Geometry& geometry, const TubeMaterial& material, const WallField& field,
                           const double* unknowns, double& energy, double* residual, double* tangent);
  static bool leg(const Geometry& geometry, const LegMaterialLaw& law, const double* unknowns, double& energy,
                  double* residual, double* tangent);
};

}  // namespace gaiter::physics
