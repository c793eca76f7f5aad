// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <algorithm>

#include "gaiter/physics/axisym_element.hpp"

// What an element stores at one of its Gauss points, for the element's forces and for its stresses.
namespace gaiter::physics {

// Components of the deformation at a Gauss point and how they depend on the unknowns: rR, rZ and t on the u_r
// of the nodes through d_R, d_Z, over_R; zR and zZ on the u_z. The pressure, the sixth, on the pressure
// unknowns.
inline constexpr int components = 5;

template <int P>
std::array<double, components> deformation(const typename AxisymElement<P>::Geometry& geometry, int point,
                                           const double* u) {
  std::array<double, components> f{1, 0, 0, 1, 1};
  for (int a = 0; a < AxisymElement<P>::nodes; ++a) {
    const double r = u[2 * a], z = u[2 * a + 1];
    f[0] += geometry.d_R[point][a] * r;
    f[1] += geometry.d_Z[point][a] * r;
    f[2] += geometry.d_R[point][a] * z;
    f[3] += geometry.d_Z[point][a] * z;
    f[4] += geometry.over_R[point][a] * r;
  }
  return f;
}

template <int N>
Deformation<N> as_jets(const std::array<double, components>& f) {
  return {Jet<N>::variable(f[0], 0), Jet<N>::variable(f[1], 1), Jet<N>::variable(f[2], 2),
          Jet<N>::variable(f[3], 3), Jet<N>::variable(f[4], 4)};
}

// Energy per reference volume of a tube's element; variables: the components and the pressure.
template <int P>
Jet<components + 1> tube_energy_at(const typename AxisymElement<P>::Geometry& geometry,
                                   const TubeMaterial& material,
                                   const typename AxisymElement<P>::WallField& field, const double* unknowns,
                                   int point, const std::array<double, components>& f) {
  using Element = AxisymElement<P>;
  constexpr int N = components + 1;
  double pressure = 0;
  for (int q = 0; q < Element::pressures; ++q)
    pressure += geometry.pressure[point][q] * unknowns[2 * Element::nodes + q];
  const auto jets = as_jets<N>(f);
  Jet<N> stored = tube_energy(material, jets, Jet<N>::variable(pressure, components));
  if (field.share > 0) {
    const double wall = field.outer_radius - field.inner_radius, R = geometry.radius[point];
    const double depth = (R - field.inner_radius) / wall;
    const int layer = std::clamp(static_cast<int>(depth * material.layers), 0, material.layers - 1);
    const double inner = field.inner_radius + layer * wall / material.layers;
    stored += closed_form_electric_energy(field.share * material.permittivity, jets, R, inner,
                                          inner + wall / material.layers);
  }
  return stored;
}

// The same with the reference gradient of the potential, over the voltage, as the last two variables.
template <int P>
Jet<components + 3> charged_tube_energy_at(const typename AxisymElement<P>::Geometry& geometry,
                                           const TubeMaterial& material,
                                           const typename AxisymElement<P>::WallField& field,
                                           const double* unknowns, int point,
                                           const std::array<double, components>& f) {
  using Element = AxisymElement<P>;
  constexpr int N = components + 3;
  double pressure = 0, d_R = 0, d_Z = 0;
  for (int q = 0; q < Element::pressures; ++q)
    pressure += geometry.pressure[point][q] * unknowns[2 * Element::nodes + q];
  for (int a = 0; a < Element::nodes; ++a) {
    d_R += geometry.d_R[point][a] * unknowns[Element::tube_unknowns + a];
    d_Z += geometry.d_Z[point][a] * unknowns[Element::tube_unknowns + a];
  }
  const auto jets = as_jets<N>(f);
  const auto phi_R = Jet<N>::variable(d_R, components + 1), phi_Z = Jet<N>::variable(d_Z, components + 2);
  Jet<N> stored = tube_energy(material, jets, Jet<N>::variable(pressure, components));
  if (field.share > 0 && material.permittivity > 0)
    stored += electric_energy(field.share * material.permittivity, jets, phi_R, phi_Z);
  else  // any factor gives the undeformed wall's potential
    stored -=
        (0.5 * (material.permittivity > 0 ? material.permittivity : 1)) * (phi_R * phi_R + phi_Z * phi_Z);
  return stored;
}

}  // namespace gaiter::physics
