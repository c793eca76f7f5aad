// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <array>

#include "gaiter/physics/axisym_element.hpp"

namespace gaiter::physics {

// Cauchy stress sigma = (dW/dF) F^T / det F: rr, zz, rz, tt [unit of the materials' moduli].
using CauchyStress = std::array<double, 4>;

template <int P>
using ElementStress = std::array<CauchyStress, AxisymElement<P>::points>;

// Stress at the Gauss points of an element whose unknowns are admissible; arguments as AxisymElement's,
// `charged`: the potential is among the unknowns. In
// the tube the total stress: under voltage Maxwell's is part of it, for the energy is differentiated at a
// fixed potential. Tests: tests/axisym_view.py.
template <int P>
ElementStress<P> tube_stress(const typename AxisymElement<P>::Geometry& geometry,
                             const TubeMaterial& material, const typename AxisymElement<P>::WallField& field,
                             bool charged, const double* unknowns);
template <int P>
ElementStress<P> leg_stress(const typename AxisymElement<P>::Geometry& geometry, const LegMaterialLaw& law,
                            const double* unknowns);

}  // namespace gaiter::physics
