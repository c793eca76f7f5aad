// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/axisym_stress.hpp"

namespace gaiter::physics {

namespace {

constexpr int components = 5;  // of the deformation gradient: rR, rZ, zR, zZ, t

template <int P>
std::array<double, components> deformation(const typename AxisymElement<P>::Geometry& geometry, int point,
                                           const double* u) {
  std::array<double, components> f{1, 0, 0, 1, 1};
  for (int a = 0; a < AxisymElement<P>::nodes; ++a) {
    f[0] += geometry.d_R[point][a] * u[2 * a];
    f[1] += geometry.d_Z[point][a] * u[2 * a];
    f[2] += geometry.d_R[point][a] * u[2 * a + 1];
    f[3] += geometry.d_Z[point][a] * u[2 * a + 1];
    f[4] += geometry.over_R[point][a] * u[2 * a];
  }
  return f;
}

template <int N>
Deformation<N> as_jets(const std::array<double, components>& f) {
  return {Jet<N>::variable(f[0], 0), Jet<N>::variable(f[1], 1), Jet<N>::variable(f[2], 2),
          Jet<N>::variable(f[3], 3), Jet<N>::variable(f[4], 4)};
}

template <int N>
CauchyStress cauchy(const Jet<N>& energy, const std::array<double, components>& f) {
  const auto& piola = energy.gradient;  // dW/dF
  const double volume = (f[0] * f[3] - f[1] * f[2]) * f[4];
  return {(piola[0] * f[0] + piola[1] * f[1]) / volume, (piola[2] * f[2] + piola[3] * f[3]) / volume,
          (piola[0] * f[2] + piola[1] * f[3]) / volume, piola[4] * f[4] / volume};
}

}  // namespace

template <int P>
ElementStress<P> tube_stress(const typename AxisymElement<P>::Geometry& geometry,
                             const TubeMaterial& material, const double* unknowns,
                             const typename AxisymElement<P>::Field* field) {
  using Element = AxisymElement<P>;
  constexpr int N = components + 1;  // the pressure is the last variable
  ElementStress<P> stress;
  for (int point = 0; point < Element::points; ++point) {
    const auto f = deformation<P>(geometry, point, unknowns);
    double pressure = 0;
    for (int q = 0; q < Element::pressures; ++q)
      pressure += geometry.pressure[point][q] * unknowns[2 * Element::nodes + q];
    const auto jets = as_jets<N>(f);
    Jet<N> energy = tube_energy(material, jets, Jet<N>::variable(pressure, components));
    if (field)
      energy += electric_energy(material.permittivity, jets, Jet<N>((*field)[point][0]),
                                Jet<N>((*field)[point][1]));
    stress[point] = cauchy(energy, f);
  }
  return stress;
}

template <int P>
ElementStress<P> leg_stress(const typename AxisymElement<P>::Geometry& geometry, const LegMaterialLaw& law,
                            const double* unknowns) {
  ElementStress<P> stress;
  for (int point = 0; point < AxisymElement<P>::points; ++point) {
    const auto f = deformation<P>(geometry, point, unknowns);
    stress[point] = cauchy(leg_energy(law, as_jets<components>(f)), f);
  }
  return stress;
}

#define GAITER_STRESS(P)                                                                            \
  template ElementStress<P> tube_stress<P>(const AxisymElement<P>::Geometry&, const TubeMaterial&,  \
                                           const double*, const AxisymElement<P>::Field*);          \
  template ElementStress<P> leg_stress<P>(const AxisymElement<P>::Geometry&, const LegMaterialLaw&, \
                                          const double*);
GAITER_STRESS(2)
GAITER_STRESS(3)
GAITER_STRESS(4)

}  // namespace gaiter::physics
