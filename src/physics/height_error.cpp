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

inline double larger(double a, double b) {
  return a < b ? b : a;
}

}  // namespace

GAITER_MULTIVERSION
void height_error(const Quadrature& gauss, std::span<const SliceOutcomes> slices,
                  Pack SliceOutcomes::*pressure, const Pack& roughness, Pack& error, Pack& mean) {
  constexpr double caution = 2, smooth = 0.3, rounding = 1e-15;
  const int count = static_cast<int>(gauss.nodes.size()), degree = count - 1;
  Pack last[coefficients]{}, log_fall, size, rate;
  GAITER_EACH mean[i] = 0;
  for (int k = 0; k < count; ++k) {
    const auto polynomials = last_legendre(count, 2 * gauss.nodes[k] - 1);
    const Pack& here = slices[k].*pressure;
    GAITER_EACH {
      const double share = gauss.weights[k] * here[i];
      mean[i] += share;
      for (int place = 0; place < coefficients; ++place) last[place][i] += polynomials[place] * share;
    }
  }
  // Upper bound where the pressure is smooth: the slowest fall that any of them shows.
  GAITER_EACH log_fall[i] = -std::numeric_limits<double>::infinity();
  for (int place = 0; place < coefficients; ++place) {
    const double power = count - coefficients + place;
    GAITER_EACH {
      const double relative = mean[i] > 0 ? std::fabs(last[place][i]) / mean[i] : 0;
      const double here = log(relative) / power;
      log_fall[i] = here > log_fall[i] ? here : log_fall[i];
    }
  }
  // Rounding fills up what is smaller. The size of the last coefficient, which may be small by chance, is at
  // least half of what its two forerunners would have it.
  const double falling = (2.0 * degree - 3) / (2.0 * degree - 1);
  GAITER_EACH {
    const double floor = rounding * mean[i];
    const double before = larger(std::fabs(last[0][i]), floor), middle = larger(std::fabs(last[1][i]), floor),
                 end = larger(std::fabs(last[2][i]), floor);
    const double expected = middle < before ? falling * middle * middle / before : falling * middle;
    size[i] = larger(end, 0.5 * expected);
    rate[i] = size[i] < middle ? size[i] / middle * (2 * degree - 1) : 2 * degree - 1;
  }
  for (int k = degree + 1; k <= 2 * count; ++k) GAITER_EACH {
      const double ratio = (rate[i] + (k - degree) * std::fabs(roughness[i])) / (2 * k - 1);
      size[i] *= ratio < 1 ? ratio : 1;
    }
  GAITER_EACH {
    const double carried = exp(2.0 * count * log_fall[i]);
    const double bound = std::fabs(roughness[i]) < smooth && carried < 1 ? carried : 1;
    // The rule gives at most half for the mean of the Legendre polynomial of degree 2n, which is 0.
    const double tail = 0.5 * caution * size[i];
    const double found = tail < bound * mean[i] ? tail : bound * mean[i];
    error[i] = mean[i] > 0 ? found : 0;
  }
}

}  // namespace gaiter::physics
