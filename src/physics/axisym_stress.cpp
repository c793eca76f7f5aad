// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/axisym_stress.hpp"

#include "gaiter/physics/axisym_point.hpp"

namespace gaiter::physics {

namespace {

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
                             const TubeMaterial& material, const typename AxisymElement<P>::WallField& field,
                             bool charged, const double* unknowns) {
  ElementStress<P> stress;
  for (int point = 0; point < AxisymElement<P>::points; ++point) {
    const auto f = deformation<P>(geometry, point, unknowns);
    stress[point] = charged
                        ? cauchy(charged_tube_energy_at<P>(geometry, material, field, unknowns, point, f), f)
                        : cauchy(tube_energy_at<P>(geometry, material, field, unknowns, point, f), f);
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

#define GAITER_STRESS(P)                                                                             \
  template ElementStress<P> tube_stress<P>(const AxisymElement<P>::Geometry&, const TubeMaterial&,   \
                                           const AxisymElement<P>::WallField&, bool, const double*); \
  template ElementStress<P> leg_stress<P>(const AxisymElement<P>::Geometry&, const LegMaterialLaw&,  \
                                          const double*);
GAITER_STRESS(2)
GAITER_STRESS(3)
GAITER_STRESS(4)

}  // namespace gaiter::physics
