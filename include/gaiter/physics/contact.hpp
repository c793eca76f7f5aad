// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <array>
#include <span>
#include <vector>

#include "gaiter/physics/jet.hpp"

// Frictionless contact of two surfaces that are graphs r(z), the tube's inner face and the leg's skin, by a
// segment mortar with a weighted gap volume. The potential is - sum_k lambda_k G_k,
//   G_k = int N_k(z) pi (r_tube(z)^2 - r_leg(z)^2) dz over the current height,
// with N_k the hat functions of the vertices of one surface and lambda_k then exactly the normal Cauchy
// pressure. The integral is cut at the current height of the vertices of both surfaces, so that the integrand
// is smooth on each segment; the segments' ends and the maps from height to either surface take part in the
// derivatives. Contact: lambda_k >= 0, G_k >= 0, lambda_k G_k = 0. Tests: tests/axisym_contact.cpp.
namespace gaiter::physics {

// A stretch of surface between two vertices: Lagrange nodes of order P from the lower to the upper vertex,
// current coordinates [m].
template <int P>
struct ContactEdge {
  std::array<double, P + 1> r{}, z{};
};

// Which vertex bounds a segment.
enum class SegmentEnd { tube_lower, tube_upper, leg_lower, leg_upper };

struct ContactSegment {
  int tube_edge = 0;
  int leg_edge = 0;
  SegmentEnd lower = SegmentEnd::tube_lower;
  SegmentEnd upper = SegmentEnd::tube_upper;
};

// The segments of two rows of edges whose vertices have these current heights, ascending [m]: `tube[i]` and
// `tube[i + 1]` bound tube edge i, and so for the leg. Empty if either row folds back (no graph any more).
std::vector<ContactSegment> pair_surfaces(std::span<const double> tube, std::span<const double> leg);

// Variables of a segment's potential: r then z of the tube's nodes, r then z of the leg's, and the two
// multipliers at the vertices of the surface that carries them.
template <int P>
using ContactJet = Jet<4 * (P + 1) + 2>;

// - sum_k lambda_k G_k of one segment; its gradient with respect to the multipliers is minus the gap volumes
// [J].
template <int P>
ContactJet<P> contact_potential(const ContactEdge<P>& tube, const ContactEdge<P>& leg,
                                const std::array<double, 2>& multipliers, bool multipliers_on_tube,
                                const ContactSegment& segment);

// Lagrange polynomials of order P through the Gauss-Lobatto points of (0, 1): entry [i][k] is the coefficient
// of x^k of the one that is 1 at node i.
template <int P>
const std::array<std::array<double, P + 1>, P + 1>& lagrange_coefficients();

// The Gauss-Lobatto points of (0, 1), P + 1 of them.
template <int P>
const std::array<double, P + 1>& lobatto_points();

}  // namespace gaiter::physics
