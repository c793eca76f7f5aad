// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/quadrature.hpp"

#include <algorithm>
#include <array>
#include <boost/math/special_functions/legendre.hpp>
#include <cmath>

namespace gaiter::physics {

Quadrature gauss_legendre(int points) {
  // Boost gives the zeros that are not negative, ascending.
  const std::vector<double> zeros = boost::math::legendre_p_zeros<double>(points);
  Quadrature rule{std::vector<double>(points), std::vector<double>(points)};
  for (std::size_t k = 0; k < zeros.size(); ++k) {
    const double x = zeros[k];
    const double slope = boost::math::legendre_p_prime(points, x);
    const double weight = 1 / ((1 - x) * (1 + x) * slope * slope);
    const std::size_t upper = points / 2 + k;  // with an odd count, zeros[0] = 0 is the middle node
    const std::size_t lower = points - 1 - upper;
    rule.nodes[upper] = 0.5 + 0.5 * x;
    rule.nodes[lower] = 0.5 - 0.5 * x;
    rule.weights[upper] = rule.weights[lower] = weight;
  }
  return rule;
}

Quadrature slice_quadrature(model::SliceRule rule, int slices) {
  if (rule == model::SliceRule::gauss) return gauss_legendre(slices);
  Quadrature midpoints{std::vector<double>(slices), std::vector<double>(slices, 1.0 / slices)};
  for (int k = 0; k < slices; ++k) midpoints.nodes[k] = (k + 0.5) / slices;
  return midpoints;
}

namespace {

double log_error_constant(int points) {
  // A sweep asks for every design: the logarithms of the factorials are kept.
  constexpr int most_kept = 128;
  const auto log_factorials = [](double n) {
    return 4 * std::lgamma(n + 1) - std::log(2 * n + 1) - 3 * std::lgamma(2 * n + 1);
  };
  static const std::array<double, most_kept> kept = [&] {
    std::array<double, most_kept> values{};
    for (int n = 0; n < most_kept; ++n) values[n] = log_factorials(n);
    return values;
  }();
  return points < most_kept ? kept[points] : log_factorials(points);
}

}  // namespace

double gauss_error_constant(int points) {
  return std::exp(log_error_constant(points));
}

double gauss_error_of_exponential(int points, double rate) {
  // |error| = rate^(2n) (n!)^4 / ((2n+1) ((2n)!)^3) exp(rate x) at some x of the interval; the integral
  // itself is at least exp(rate x) (1 - exp(-rate)) / rate for the largest of these.
  if (rate == 0) return 0;
  const double log_error = 2.0 * points * std::log(rate) + log_error_constant(points);
  return std::min(1.0, std::exp(log_error) * rate / -std::expm1(-rate));
}

}  // namespace gaiter::physics
