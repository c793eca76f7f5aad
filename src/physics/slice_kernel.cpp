// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/slice_kernel.hpp"

namespace gaiter::physics {

namespace {

constexpr double largest_exponent = 300;  // of lambda^alpha; products of two such stay finite
constexpr double largest_pressure = 1e100;
constexpr double smallest_radius = 1e-6;  // over A; its square is still told from 0 beside 1

// The fixed-count loops below are the vectorised ones.
#define GAITER_EACH for (int i = 0; i < pack_width; ++i)

// Exponentials and logarithms in double or single precision: of the latter twice as many fit a register, and
// each needs fewer terms. What they are made of, and what is made of them, stays in double: the gap, which
// cancels, keeps its digits, and no product leaves the range of a float. Each in a loop by itself, for a call
// among other work would have all registers saved around it.
template <bool single>
inline __attribute__((always_inline)) void log1p_each(const Pack& x, Pack& out) {
  if constexpr (single)
    GAITER_EACH out[i] = static_cast<double>(log1pf(static_cast<float>(x[i])));
  else
    GAITER_EACH out[i] = log1p(x[i]);
}

template <bool single>
inline __attribute__((always_inline)) void expm1_each(const Pack& x, Pack& out) {
  if constexpr (single) {
    // Of a quarter where a float would not hold it.
    constexpr double largest = 80;
    Pack grown;
    GAITER_EACH grown[i] =
        static_cast<double>(expm1f(static_cast<float>(x[i] > largest ? 0.25 * x[i] : x[i])));
    GAITER_EACH {
      const double square = grown[i] * (2 + grown[i]);
      out[i] = x[i] > largest ? square * (2 + square) : grown[i];
    }
  } else {
    GAITER_EACH out[i] = expm1(x[i]);
  }
}

// Divisions take as long as exponentials.
template <bool single>
inline __attribute__((always_inline)) double inverse_of(double x) {
  if constexpr (single) return static_cast<double>(1 / static_cast<float>(x));
  return 1 / x;
}

// y = (r/R_c)^2 from P = (1 - y)(K + G y^{-5/3}): decreasing and convex in y, so that Newton's method climbs
// monotonically from any y at which the pressure is too large.
inline __attribute__((always_inline)) void neo_hookean_strain(const Pack& bulk, const Pack& shear,
                                                              const Pack& pressure, Pack& strain,
                                                              Pack& slope) {
  Pack y;
  GAITER_EACH {
    // Both lie below the root: 1 - P/(K+G), and (G/2P)^{3/5} where that is at most 1/2.
    const double linear = 1 - pressure[i] / (bulk[i] + shear[i]);
    const double positive = pressure[i] > 1e-3 * shear[i] ? pressure[i] : 1e-3 * shear[i];
    const double root = std::exp(0.6 * std::log(0.5 * shear[i] / positive));
    const double carried = root < 0.5 ? root : 0.5;
    y[i] = linear > carried ? linear : carried;
  }
  for (int iteration = 0; iteration < 60; ++iteration) {
    double change = 0;
    GAITER_EACH {
      const double power = std::exp(-5.0 / 3 * std::log(y[i]));
      const double value = (1 - y[i]) * (bulk[i] + shear[i] * power) - pressure[i];
      const double derivative = -(bulk[i] + shear[i] * power) - (1 - y[i]) * shear[i] * 5 / 3 * power / y[i];
      const double step = -value / derivative;
      y[i] += step;
      const double size = std::fabs(step) - 4e-16 * y[i];
      change = size > change ? size : change;
    }
    if (!(change > 0)) break;
  }
  GAITER_EACH {
    const double power = std::exp(-5.0 / 3 * std::log(y[i]));
    const double derivative = -(bulk[i] + shear[i] * power) - (1 - y[i]) * shear[i] * 5 / 3 * power / y[i];
    const double ratio = std::sqrt(y[i]);
    strain[i] = pressure[i] / (bulk[i] + shear[i] * power) / (1 + ratio);  // (1 - y)/(1 + sqrt y)
    slope[i] = -0.5 / (ratio * derivative);
  }
}

template <bool single>
inline __attribute__((always_inline)) void add_actuation(const SliceShape& shape, const Pack* layers,
                                                         const Pack& swell, const Pack& swell_slope,
                                                         double sign, Pack& pressure, Pack& slope) {
  for (int k = 0; k < shape.layers; ++k) {
    const Pack &ratio = layers[3 * k], &area = layers[3 * k + 1], &drive = layers[3 * k + 2];
    Pack log_area;
    GAITER_EACH log_area[i] = area[i] / (1 + ratio[i] * swell[i]);
    log1p_each<single>(log_area, log_area);
    GAITER_EACH {
      const double inner = 1 + ratio[i] * swell[i];  // (a/A)^2 of the layer
      const double outer = inner + area[i];          // (b/A)^2
      const double log_wall = log_area[i];
      const double maxwell = drive[i] * area[i] / (inner * outer * log_wall * log_wall);
      const double relative = -1 / inner - 1 / outer + 2 * area[i] / (inner * outer * log_wall);
      pressure[i] += sign * maxwell;
      slope[i] += sign * maxwell * relative * ratio[i] * swell_slope[i];
    }
  }
}

// u = (r^2 - A^2)/A^2 and its derivative with respect to the leg's strain.
inline __attribute__((always_inline)) void inner_swell(const Pack* rows, const Pack& strain, Pack& swell,
                                                       Pack& swell_slope) {
  const Pack &gap = rows[SliceShape::gap], &leg = rows[SliceShape::leg_radius];
  GAITER_EACH {
    const double wanted = gap[i] - leg[i] * strain[i];
    const double excess = wanted > smallest_radius - 1 ? wanted : smallest_radius - 1;
    swell[i] = excess * (2 + excess);
    swell_slope[i] = -2 * leg[i] * (1 + excess);
  }
}

template <bool single>
inline __attribute__((always_inline)) void strain_of_leg(const SliceShape& shape, const Pack* rows,
                                                         const Pack& pressure, Pack& strain, Pack& slope) {
  if (shape.material == model::LegMaterial::neo_hookean) {
    neo_hookean_strain(rows[SliceShape::leg_0], rows[SliceShape::leg_1], pressure, strain, slope);
    return;
  }
  const Pack &a = rows[SliceShape::leg_0], &c = rows[SliceShape::leg_1], &sum = rows[SliceShape::leg_2],
             &decay = rows[SliceShape::leg_3];
  Pack grown, decayed;
  GAITER_EACH decayed[i] = decay[i] * pressure[i];
  expm1_each<single>(pressure, grown);
  expm1_each<single>(decayed, decayed);
  GAITER_EACH {
    strain[i] = sum[i] + a[i] * grown[i] + c[i] * decayed[i];
    slope[i] = a[i] * (1 + grown[i]) + c[i] * decay[i] * (1 + decayed[i]);
  }
}

template <bool single>
inline __attribute__((always_inline)) void pressure_of_bandage(const SliceShape& shape, const Pack* rows,
                                                               const Pack& strain, Pack& pressure,
                                                               Pack& slope) {
  const int terms = shape.ogden_terms;
  const Pack *mu = rows + shape.mu_row(0), *alpha = rows + shape.alpha_row(0),
             *wall = rows + shape.wall_row(0), *weight = rows + shape.weight_row(0);
  const int points = static_cast<int>(shape.wall.nodes.size());

  Pack swell, swell_slope, log_stretch, power, stress, stress_slope, inverse;
  inner_swell(rows, strain, swell, swell_slope);
  GAITER_EACH pressure[i] = slope[i] = 0;
  for (int j = 0; j < points; ++j) {
    const Pack& ratio = wall[j];  // A^2/s
    // Thin walls need fewer points than the thickest of the system.
    int weighted = 0;
    GAITER_EACH weighted |= weight[j][i] != 0;
    if (weighted == 0) break;
    GAITER_EACH log_stretch[i] = swell[i] * ratio[i];  // lambda^2 - 1
    GAITER_EACH {
      inverse[i] = inverse_of<single>(1 + log_stretch[i]);
      stress[i] = stress_slope[i] = 0;
    }
    log1p_each<single>(log_stretch, log_stretch);
    for (int term = 0; term < terms; ++term) {
      const Pack &modulus = mu[term], &exponent = alpha[term];
      // Of the magnitude: 1 + expm1 of a negative number would lose the digits of a small exponential.
      GAITER_EACH {
        const double size = std::fabs(0.5 * (exponent[i] * log_stretch[i]));
        power[i] = size < largest_exponent ? size : largest_exponent;
      }
      expm1_each<single>(power, power);
      GAITER_EACH {
        const double reciprocal = inverse_of<single>(1 + power[i]);
        const double sine_of_size = 0.5 * (power[i] + power[i] * reciprocal);
        const double hyperbolic_sine = std::copysign(sine_of_size, exponent[i] * log_stretch[i]);
        const double hyperbolic_cosine = sine_of_size + reciprocal;
        stress[i] += modulus[i] * hyperbolic_sine;
        stress_slope[i] += modulus[i] * (exponent[i] * hyperbolic_cosine - 2 * hyperbolic_sine);
      }
    }
    GAITER_EACH {
      const double share = weight[j][i] * inverse[i];
      pressure[i] += share * stress[i];
      slope[i] += share * inverse[i] * ratio[i] * stress_slope[i];
    }
  }
  const Pack& log_wall = rows[SliceShape::log_wall];
  GAITER_EACH {
    pressure[i] *= log_wall[i];
    slope[i] *= 0.5 * log_wall[i] * swell_slope[i];
  }
  add_actuation<single>(shape, rows + shape.layer_row(0), swell, swell_slope, -1, pressure, slope);
  GAITER_EACH pressure[i] = pressure[i] < largest_pressure ? pressure[i] : largest_pressure;
}

GAITER_MULTIVERSION
void strain_in_double(const SliceShape& shape, const Pack* rows, const Pack& pressure, Pack& strain,
                      Pack& slope) {
  strain_of_leg<false>(shape, rows, pressure, strain, slope);
}

GAITER_MULTIVERSION
void strain_in_single(const SliceShape& shape, const Pack* rows, const Pack& pressure, Pack& strain,
                      Pack& slope) {
  strain_of_leg<true>(shape, rows, pressure, strain, slope);
}

GAITER_MULTIVERSION
void pressure_in_double(const SliceShape& shape, const Pack* rows, const Pack& strain, Pack& pressure,
                        Pack& slope) {
  pressure_of_bandage<false>(shape, rows, strain, pressure, slope);
}

GAITER_MULTIVERSION
void pressure_in_single(const SliceShape& shape, const Pack* rows, const Pack& strain, Pack& pressure,
                        Pack& slope) {
  pressure_of_bandage<true>(shape, rows, strain, pressure, slope);
}

}  // namespace

void leg_strain(const SliceShape& shape, const Pack* rows, const Pack& pressure, Pack& strain, Pack& slope) {
  (shape.single ? strain_in_single : strain_in_double)(shape, rows, pressure, strain, slope);
}

void bandage_pressure(const SliceShape& shape, const Pack* rows, const Pack& strain, Pack& pressure,
                      Pack& slope) {
  (shape.single ? pressure_in_single : pressure_in_double)(shape, rows, strain, pressure, slope);
}

GAITER_MULTIVERSION
void largest_field(const SliceShape& shape, const Pack* rows, const Pack& strain, Pack& field) {
  Pack swell, swell_slope;
  inner_swell(rows, strain, swell, swell_slope);
  GAITER_EACH field[i] = 0;
  for (int k = 0; k < shape.layers; ++k) {
    const Pack* layer = rows + shape.layer_row(k);
    GAITER_EACH {
      const double inner = 1 + layer[0][i] * swell[i];
      const double log_wall = std::log1p(layer[1][i] / inner);
      const double here = layer[2][i] > 0 ? 2 / (std::sqrt(inner / layer[0][i]) * log_wall) : 0;
      field[i] = here > field[i] ? here : field[i];
    }
  }
}

GAITER_MULTIVERSION
void actuation_pressure(const SliceShape& shape, const Pack* rows, const Pack& strain, Pack& pressure,
                        Pack& slope) {
  Pack swell, swell_slope;
  inner_swell(rows, strain, swell, swell_slope);
  GAITER_EACH pressure[i] = slope[i] = 0;
  add_actuation<false>(shape, rows + shape.layer_row(0), swell, swell_slope, 1, pressure, slope);
}

}  // namespace gaiter::physics
