// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/contact.hpp"

#include <algorithm>
#include <cmath>

#include "gaiter/physics/quadrature.hpp"

namespace gaiter::physics {

namespace {

constexpr int points_per_segment = 3;

// Place in (0, 1) on the edge of a given height, by Newton's method from the chord.
template <int P>
double invert(const std::array<double, P + 1>& z, double height) {
  const auto& c = lagrange_coefficients<P>();
  double x = (height - z[0]) / (z[P] - z[0]);
  for (int iteration = 0; iteration < 30; ++iteration) {
    double value = -height, slope = 0, monomial = 1;
    for (int k = 0; k <= P; ++k) {
      double coefficient = 0;
      for (int i = 0; i <= P; ++i) coefficient += c[i][k] * z[i];
      value += coefficient * monomial;
      if (k + 1 <= P) {
        double next = 0;
        for (int i = 0; i <= P; ++i) next += c[i][k + 1] * z[i];
        slope += (k + 1) * next * monomial;
      }
      monomial *= x;
    }
    const double step = -value / slope;
    x += step;
    if (std::fabs(step) < 1e-15) break;
  }
  return x;
}

// A surface edge as polynomials of the place x whose coefficients are jets.
template <int P>
struct JetEdge {
  std::array<ContactJet<P>, P + 1> r, z;

  JetEdge(const ContactEdge<P>& edge, int first_variable) {
    const auto& c = lagrange_coefficients<P>();
    for (int k = 0; k <= P; ++k)
      for (int i = 0; i <= P; ++i) {
        r[k].value += c[i][k] * edge.r[i];
        r[k].gradient[first_variable + i] = c[i][k];
        z[k].value += c[i][k] * edge.z[i];
        z[k].gradient[first_variable + P + 1 + i] = c[i][k];
      }
  }

  static ContactJet<P> at(const std::array<ContactJet<P>, P + 1>& polynomial, const ContactJet<P>& x) {
    ContactJet<P> sum = polynomial[P];
    for (int k = P - 1; k >= 0; --k) sum = sum * x + polynomial[k];
    return sum;
  }

  // The place of a height: two steps of Newton's method in jets, from the place itself, carry both
  // derivatives.
  ContactJet<P> place(double x0, const ContactJet<P>& height) const {
    ContactJet<P> x(x0);
    for (int iteration = 0; iteration < 2; ++iteration) {
      ContactJet<P> slope = double(P) * z[P];
      for (int k = P - 1; k >= 1; --k) slope = slope * x + double(k) * z[k];
      x -= (at(z, x) - height) / slope;
    }
    return x;
  }
};

// The variable that is the height of a segment's end.
template <int P>
int height_variable(SegmentEnd end) {
  switch (end) {
    case SegmentEnd::tube_lower:
      return P + 1;
    case SegmentEnd::tube_upper:
      return 2 * P + 1;
    case SegmentEnd::leg_lower:
      return 3 * (P + 1);
    case SegmentEnd::leg_upper:
      return 4 * P + 3;
  }
  return 0;
}

template <int P>
double height_value(const ContactEdge<P>& tube, const ContactEdge<P>& leg, SegmentEnd end) {
  switch (end) {
    case SegmentEnd::tube_lower:
      return tube.z[0];
    case SegmentEnd::tube_upper:
      return tube.z[P];
    case SegmentEnd::leg_lower:
      return leg.z[0];
    case SegmentEnd::leg_upper:
      return leg.z[P];
  }
  return 0;
}

}  // namespace

template <int P>
const std::array<double, P + 1>& lobatto_points() {
  static const std::array<double, P + 1> points = [] {
    if constexpr (P == 1) return std::array<double, 2>{0, 1};
    if constexpr (P == 2) return std::array<double, 3>{0, 0.5, 1};
    if constexpr (P == 3)
      return std::array<double, 4>{0, 0.5 - 0.5 / std::sqrt(5.0), 0.5 + 0.5 / std::sqrt(5.0), 1};
    if constexpr (P == 4)
      return std::array<double, 5>{0, 0.5 - 0.5 * std::sqrt(3.0 / 7), 0.5, 0.5 + 0.5 * std::sqrt(3.0 / 7), 1};
  }();
  return points;
}

template <int P>
const std::array<std::array<double, P + 1>, P + 1>& lagrange_coefficients() {
  static const auto table = [] {
    const auto& node = lobatto_points<P>();
    std::array<std::array<double, P + 1>, P + 1> c{};
    for (int i = 0; i <= P; ++i) {
      c[i][0] = 1;
      int degree = 0;
      for (int j = 0; j <= P; ++j) {
        if (j == i) continue;
        const double scale = 1 / (node[i] - node[j]);
        for (int k = ++degree; k >= 0; --k)
          c[i][k] = scale * ((k > 0 ? c[i][k - 1] : 0) - node[j] * (k < degree ? c[i][k] : 0));
      }
    }
    return c;
  }();
  return table;
}

std::vector<ContactSegment> pair_surfaces(std::span<const double> tube, std::span<const double> leg) {
  for (std::size_t i = 1; i < tube.size(); ++i)
    if (!(tube[i] > tube[i - 1])) return {};
  for (std::size_t i = 1; i < leg.size(); ++i)
    if (!(leg[i] > leg[i - 1])) return {};
  std::vector<ContactSegment> segments;
  std::size_t t = 0, l = 0;
  while (t + 1 < tube.size() && l + 1 < leg.size()) {
    const double low = std::max(tube[t], leg[l]), high = std::min(tube[t + 1], leg[l + 1]);
    if (high > low)
      segments.push_back({static_cast<int>(t), static_cast<int>(l),
                          tube[t] >= leg[l] ? SegmentEnd::tube_lower : SegmentEnd::leg_lower,
                          tube[t + 1] <= leg[l + 1] ? SegmentEnd::tube_upper : SegmentEnd::leg_upper});
    const bool next_tube = tube[t + 1] <= leg[l + 1], next_leg = leg[l + 1] <= tube[t + 1];
    if (next_tube) ++t;
    if (next_leg) ++l;
  }
  return segments;
}

template <int P>
ContactJet<P> contact_potential(const ContactEdge<P>& tube, const ContactEdge<P>& leg,
                                const std::array<double, 2>& multipliers, bool multipliers_on_tube,
                                const ContactSegment& segment) {
  using J = ContactJet<P>;
  static const Quadrature rule = gauss_legendre(points_per_segment + (P > 2 ? P - 2 : 0));
  const JetEdge<P> tube_edge(tube, 0), leg_edge(leg, 2 * (P + 1));
  const J low = J::variable(height_value(tube, leg, segment.lower), height_variable<P>(segment.lower));
  const J high = J::variable(height_value(tube, leg, segment.upper), height_variable<P>(segment.upper));
  const J first = J::variable(multipliers[0], 4 * (P + 1)),
          second = J::variable(multipliers[1], 4 * (P + 1) + 1);
  const J length = high - low;
  J potential;
  for (std::size_t g = 0; g < rule.nodes.size(); ++g) {
    const J height = low + rule.nodes[g] * length;
    const J on_tube = tube_edge.place(invert<P>(tube.z, height.value), height);
    const J on_leg = leg_edge.place(invert<P>(leg.z, height.value), height);
    const J tube_radius = JetEdge<P>::at(tube_edge.r, on_tube),
            leg_radius = JetEdge<P>::at(leg_edge.r, on_leg);
    const J pressure = first + (multipliers_on_tube ? on_tube : on_leg) * (second - first);
    const J gap = (tube_radius - leg_radius) * (tube_radius + leg_radius);
    potential += (-M_PI * rule.weights[g]) * (length * pressure * gap);
  }
  return potential;
}

#define GAITER_CONTACT(P)                                                                  \
  template const std::array<double, P + 1>& lobatto_points<P>();                           \
  template const std::array<std::array<double, P + 1>, P + 1>& lagrange_coefficients<P>(); \
  template ContactJet<P> contact_potential(const ContactEdge<P>&, const ContactEdge<P>&,   \
                                           const std::array<double, 2>&, bool, const ContactSegment&);
GAITER_CONTACT(1)
GAITER_CONTACT(2)
GAITER_CONTACT(3)
GAITER_CONTACT(4)

}  // namespace gaiter::physics
