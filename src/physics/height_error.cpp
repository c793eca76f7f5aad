// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/height_error.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "gaiter/physics/segment_forecast.hpp"

namespace gaiter::physics {

double height_error(const Quadrature& gauss, std::span<const double> pressure, double taper) {
  constexpr int coefficients = 3;  // the last ones tell
  constexpr double caution = 2;
  const int count = static_cast<int>(gauss.nodes.size());
  std::array<double, coefficients> last{};
  double mean = 0;
  for (int k = 0; k < count; ++k) {
    const double x = 2 * gauss.nodes[k] - 1, share = gauss.weights[k] * pressure[k];
    mean += share;
    double before = 0, legendre = 1;
    for (int degree = 0; degree < count; ++degree) {
      if (const int place = degree - (count - coefficients); place >= 0)
        last[place] += (2 * degree + 1) * share * legendre;
      const double next = ((2 * degree + 1) * x * legendre - degree * before) / (degree + 1);
      before = legendre;
      legendre = next;
    }
  }
  if (!(mean > 0)) return 0;
  // Upper bound where the pressure is smooth: the slowest fall that any of them shows.
  constexpr double rough = 0.3;
  double fall = 0;
  for (int place = 0; place < coefficients; ++place)
    fall = std::max(fall, std::pow(std::fabs(last[place]) / mean, 1.0 / (count - coefficients + place)));
  const double bound = std::fabs(taper) < rough ? std::pow(fall, 2 * count) : 1.0;
  // Rounding fills up what is smaller.
  constexpr double rounding = 1e-15;
  for (double& coefficient : last) coefficient = std::max(std::fabs(coefficient), rounding * mean);
  return std::min(bound, caution * gauss_tail(last, count - 1, std::fabs(taper), count) / mean);
}

}  // namespace gaiter::physics
