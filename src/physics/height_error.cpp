// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/height_error.hpp"

#include <array>
#include <limits>

namespace gaiter::physics {

namespace {

constexpr int coefficients = 3;  // the last ones tell

#define GAITER_EACH for (int i = 0; i < pack_width; ++i)

// (2 k + 1) P_k(x) of the last degrees k below `count`.
std::array<double, coefficients> last_legendre(int count, double x) {
  std::array<double, coefficients> last{};
  double before = 0, legendre = 1;
  for (int degree = 0; degree < count; ++degree) {
    if (const int place = degree - (count - coefficients); place >= 0)
      last[place] = (2 * degree + 1) * legendre;
    const double next = ((2 * degree + 1) * x * legendre - degree * before) / (degree + 1);
    before = legendre;
    legendre = next;
  }
  return last;
}

}  // namespace

GAITER_MULTIVERSION
void height_error(const Quadrature& gauss, std::span<const SliceOutcomes> slices,
                  Pack SliceOutcomes::*pressure, Pack& error) {
  const int count = static_cast<int>(gauss.nodes.size());
  Pack mean{}, last[coefficients]{}, log_fall;
  for (int k = 0; k < count; ++k) {
    const auto polynomials = last_legendre(count, 2 * gauss.nodes[k] - 1);
    const Pack& here = slices[k].*pressure;
    GAITER_EACH {
      const double share = gauss.weights[k] * here[i];
      mean[i] += share;
      for (int place = 0; place < coefficients; ++place) last[place][i] += polynomials[place] * share;
    }
  }
  // The slowest fall that any of them shows, for one alone may be small by chance.
  GAITER_EACH log_fall[i] = -std::numeric_limits<double>::infinity();
  for (int place = 0; place < coefficients; ++place) {
    const double degree = count - coefficients + place;
    GAITER_EACH {
      const double relative = mean[i] > 0 ? std::fabs(last[place][i]) / mean[i] : 0;
      const double here = log(relative) / degree;
      log_fall[i] = here > log_fall[i] ? here : log_fall[i];
    }
  }
  GAITER_EACH {
    const double carried = exp(2.0 * count * log_fall[i]);
    error[i] = carried < 1 ? carried : 1;
  }
}

}  // namespace gaiter::physics
