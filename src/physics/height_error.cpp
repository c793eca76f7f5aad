// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/height_error.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace gaiter::physics {

double height_error(const Quadrature& gauss, std::span<const double> pressure) {
  constexpr int coefficients = 3;  // the last ones tell
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
  // The slowest fall that any of them shows, for one alone may be small by chance.
  double fall = 0;
  for (int place = 0; place < coefficients; ++place)
    fall = std::max(fall, std::pow(std::fabs(last[place]) / mean, 1.0 / (count - coefficients + place)));
  return std::min(1.0, std::pow(fall, 2 * count));
}

}  // namespace gaiter::physics
