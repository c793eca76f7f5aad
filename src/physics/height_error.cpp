// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/height_error.hpp"

#include <array>
#include <limits>

namespace gaiter::physics {

namespace {

constexpr double volume_caution = 2;  // of an estimate of the leading order
constexpr int coefficients = 3;       // the last ones tell

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
                  Pack SliceOutcomes::*quantity, const Pack& roughness, Pack& error, Pack& mean) {
  constexpr double caution = 2, smooth = 0.3, rounding = 1e-15;
  const int count = static_cast<int>(gauss.nodes.size()), degree = count - 1;
  Pack last[coefficients]{}, log_fall, size, rate;
  GAITER_EACH mean[i] = 0;
  for (int k = 0; k < count; ++k) {
    const auto polynomials = last_legendre(count, 2 * gauss.nodes[k] - 1);
    const Pack& here = slices[k].*quantity;
    GAITER_EACH {
      const double share = gauss.weights[k] * here[i];
      mean[i] += share;
      for (int place = 0; place < coefficients; ++place) last[place][i] += polynomials[place] * share;
    }
  }
  Pack level;
  GAITER_EACH level[i] = std::fabs(mean[i]);
  // Upper bound where the pressure is smooth: the slowest fall that any of them shows.
  GAITER_EACH log_fall[i] = -std::numeric_limits<double>::infinity();
  for (int place = 0; place < coefficients; ++place) {
    const double power = count - coefficients + place;
    GAITER_EACH {
      const double relative = level[i] > 0 ? std::fabs(last[place][i]) / level[i] : 0;
      const double here = log(relative) / power;
      log_fall[i] = here > log_fall[i] ? here : log_fall[i];
    }
  }
  // Rounding fills up what is smaller. The size of the last coefficient, which may be small by chance, is at
  // least half of what its two forerunners would have it.
  const double falling = (2.0 * degree - 3) / (2.0 * degree - 1);
  GAITER_EACH {
    const double floor = rounding * level[i];
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
    const double found = tail < bound * level[i] ? tail : bound * level[i];
    error[i] = level[i] > 0 ? found : 0;
  }
}

double volume_height_error(const model::Leg& leg, const model::Segment& segment, const LoadedLeg& loaded,
                           double taper, int points) {
  if (taper == 0 || loaded.strain == 0) return 0;
  const double span = 2 * std::fabs(taper), constant = volume_caution * gauss_error_constant(points);
  // With the square of the radius; no factor of the derivative is trusted to be small.
  const double power = std::fabs(loaded.response * loaded.give / loaded.strain) + 2;
  double error = constant;
  for (int j = 0; j < 2 * points; ++j) error *= span * std::fmax(std::fabs(power - j), 0.5);
  if (leg.material != model::LegMaterial::compliance) return error;
  const model::Compliance& law = segment.compliance;
  const double decaying = leg.variant == model::ComplianceVariant::anchored ? -law.a : law.c;
  // The pressure is no straight line over the height either, nor is the square of the radius.
  const double bent = std::fabs(loaded.give / loaded.pressure) + 2;
  const auto of_exponential = [&](double size, double rate) {
    const double part = std::fabs(size * std::exp(rate * loaded.pressure) / loaded.strain);
    return constant * part * std::pow((std::fabs(rate * loaded.give) + bent) * span, 2 * points);
  };
  return error + of_exponential(law.a, law.b) + of_exponential(decaying, law.d);
}

}  // namespace gaiter::physics
