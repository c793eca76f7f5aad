// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/height_error.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace gaiter::physics {

double height_error(const Quadrature& gauss, std::span<const double> pressure) {
  constexpr double caution = 10;
  constexpr int coefficients = 4;  // the last ones tell
  const int count = static_cast<int>(gauss.nodes.size());
  std::array<double, coefficients> last{};  // magnitudes, of the degrees count - 4 to count - 1
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
  // Where every other coefficient is small, as in an even profile, the larger one of two counts.
  for (double& coefficient : last) coefficient = std::fabs(coefficient);
  const double earlier = std::max(last[0], last[1]), later = std::max(last[2], last[3]);
  const double fall = earlier > 0 ? std::min(1.0, std::sqrt(later / earlier)) : 0;
  return caution * later * std::pow(fall, count + 1) / mean;
}

}  // namespace gaiter::physics
