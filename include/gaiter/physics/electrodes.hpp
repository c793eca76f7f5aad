// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <span>

#include "gaiter/physics/contact.hpp"

// The electric field across the wall of a deformed tube in closed form: an ideal dielectric between coaxial
// electrodes, seen locally. Tests: tests/axisym_electrodes.cpp.
namespace gaiter::physics {

// Variables: r then z of the inner face's nodes, r then z of the outer face's.
template <int P>
using ElectrodeJet = Jet<4 * (P + 1)>;

// - C/2 of a stretch of wall between two edges whose nodes lie opposite each other, C its capacitance: the
// potential energy under a voltage of 1. With x the places of the faces, t their mean slope along the edge
// and g the vector across the wall,
//   C = 2 pi permittivity int |t|^2 / |t x g| (r_outer - r_inner) sum_k 1 / ln(r_k+1 / r_k) d(edge),
// exact for a cylinder, with the wall's tilt and shear to first order in its thickness. r_k are the radii of
// the electrodes: r_k^2 = r_inner^2 + shares[k] (r_outer^2 - r_inner^2), shares from 0 to 1; the layers
// between them are electrically in parallel. The edge's ends need not be at equal heights. The value is not
// finite where the wall is turned inside out [J/V^2].
template <int P>
ElectrodeJet<P> electrode_energy(double permittivity, const ContactEdge<P>& inner,
                                 const ContactEdge<P>& outer, std::span<const double> shares);

}  // namespace gaiter::physics
