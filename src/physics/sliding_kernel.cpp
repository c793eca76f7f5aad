// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/sliding_kernel.hpp"

namespace gaiter::physics {

namespace {

constexpr double largest_exponent = 300;  // of lambda^alpha; products of two such stay finite
constexpr double smallest_radius = 0.02;  // of the tube, over A
constexpr double largest_strain = 0.98;   // of the leg
constexpr double smallest_advance = 0.02;

#define GAITER_EACH for (int i = 0; i < pack_width; ++i)
#define GAITER_INLINE inline __attribute__((always_inline))

// The leg under the contact variable: strain of the tube's inner face, pressure, Phi, and the slopes.
struct LegTerms {
  Pack strain, strain_slope, pressure, pressure_slope, phi;
};

GAITER_INLINE void neo_hookean_leg(const Pack* section, const Pack& contact, LegTerms& leg) {
  const Pack &bulk = section[SliceShape::leg_0], &shear = section[SliceShape::leg_1];
  GAITER_EACH {
    const double strain = 0.5 * contact[i];
    const bool pressing = contact[i] > 0;
    const double on_leg = pressing ? (strain < largest_strain ? strain : largest_strain) : 0;
    const double ratio = 1 - on_leg;
    const double y = ratio * ratio, loss = on_leg * (2 - on_leg);  // 1 - y
    const double root = std::exp(std::log(ratio) * (2.0 / 3));     // y^(1/3)
    const double power = shear[i] / (y * root * root);             // G y^(-5/3)
    leg.strain[i] = strain;
    leg.strain_slope[i] = 0.5;
    leg.pressure[i] = loss * (bulk[i] + power);
    // d P / d y = -(K + G y^(-5/3)) - 5/3 (1 - y) G y^(-8/3), d y / d contact = -ratio.
    leg.pressure_slope[i] = pressing ? ratio * (bulk[i] + power * (1 + 5.0 / 3 * loss / y)) : 0;
    // Half the integral of P over y: K (1 - y)^2/2 + 3/2 G (1 - v)^2 (1 + 2 v)/v^2 with v = y^(1/3).
    const double root_loss = loss / (1 + root + root * root);
    leg.phi[i] = 0.25 * bulk[i] * loss * loss +
                 0.75 * shear[i] * root_loss * root_loss * (1 + 2 * root) / (root * root);
  }
}

GAITER_INLINE void strain_law_leg(const Pack* section, const Pack& contact, LegTerms& leg) {
  const Pack &a = section[SliceShape::leg_0], &c = section[SliceShape::leg_1],
             &none = section[SliceShape::leg_2], &decay = section[SliceShape::leg_3];
  GAITER_EACH {
    const bool pressing = contact[i] > 0;
    const double p = pressing ? contact[i] : 0;
    const double grown = expm1(p), decayed = expm1(decay[i] * p);
    const double slope = a[i] * (1 + grown) + c[i] * decay[i] * (1 + decayed);
    const double lifted = pressing ? 0 : contact[i];
    const double more = a[i] * grown + c[i] * decayed;  // strain beyond that of no pressure
    leg.strain[i] = none[i] + more + slope * lifted;
    leg.strain_slope[i] = slope;
    leg.pressure[i] = p;
    leg.pressure_slope[i] = pressing ? 1 : 0;
    // Phi = P (more (1 - none) - more^2/2) - int (more (1 - none) - more^2/2) dP.
    const double inverse = 1 / decay[i];
    const double grown_integral = grown - p, decayed_integral = decayed * inverse - p;
    const double rate = 1 + decay[i];
    const double mixed = std::fabs(rate) > 1e-9 ? (grown + decayed + grown * decayed) / rate : p;
    const double squares = a[i] * a[i] * (0.5 * grown * grown - grown_integral) +
                           2 * a[i] * c[i] * (mixed - grown - decayed_integral) +
                           c[i] * c[i] * (0.5 * decayed * decayed * inverse - decayed_integral);
    const double line = a[i] * grown_integral + c[i] * decayed_integral;
    leg.phi[i] = p * more * ((1 - none[i]) - 0.5 * more) - ((1 - none[i]) * line - 0.5 * squares);
  }
}

GAITER_INLINE void rigid_leg(const Pack* rows, const Pack& contact, LegTerms& leg) {
  const Pack& lifted_slope = rows[SlidingSystem::lifted_slope];
  GAITER_EACH {
    const bool pressing = contact[i] > 0;
    leg.strain[i] = pressing ? 0 : lifted_slope[i] * contact[i];
    leg.strain_slope[i] = pressing ? 0 : lifted_slope[i];
    leg.pressure[i] = pressing ? contact[i] : 0;
    leg.pressure_slope[i] = pressing ? 1 : 0;
    leg.phi[i] = 0;
  }
}

GAITER_INLINE void leg_terms(const SlidingShape& shape, const SliceShape& slice, const Pack* section,
                             const Pack* rows, const Pack& contact, LegTerms& leg) {
  if (shape.rigid)
    rigid_leg(rows, contact, leg);
  else if (slice.material == model::LegMaterial::neo_hookean)
    neo_hookean_leg(section, contact, leg);
  else
    strain_law_leg(section, contact, leg);
}

// w(r, zeta) of the tube over 2 pi, and what its terms need of the place: r, u = r^2 - 1, g and g - 1.
struct TubeTerms {
  Pack r, zeta, log_meridian, swell, narrow, narrow_less;  // r, zeta, ln lambda, u, g, g - 1
  Pack w, size, w_r, w_zeta, w_rr, w_rzeta, w_zetazeta;
};

GAITER_INLINE void tube_place(const Pack* section, const Pack* rows, const SlidingPlace& place,
                              const Pack& strain, TubeTerms& tube) {
  const Pack &gap = section[SliceShape::gap], &leg = section[SliceShape::leg_radius];
  const Pack &slope = rows[SlidingSystem::slope], &log_slope = rows[SlidingSystem::log_slope];
  GAITER_EACH {
    const double rise = slope[i] * place.height[i];
    const double excess = (gap[i] + rise) - (leg[i] + rise) * strain[i];
    tube.swell[i] = excess * (2 + excess);
    tube.r[i] = 1 + excess;
    tube.zeta[i] = 1 + place.advance[i];
    tube.log_meridian[i] = log1p(place.advance[i]) + log_slope[i];
    const double squared_slope = slope[i] * slope[i];
    tube.narrow[i] = 1 / (tube.zeta[i] * (1 + squared_slope));
    tube.narrow_less[i] = -(place.advance[i] + tube.zeta[i] * squared_slope) * tube.narrow[i];
  }
}

// lambda^alpha, lambda^-alpha, and both less 1, each with all its digits.
struct Powers {
  double up, down, up_less, down_less;
};

GAITER_INLINE Powers powers(double exponent) {
  const double size = std::fabs(exponent);
  const double large_less = expm1(size < largest_exponent ? size : largest_exponent);
  const double large = 1 + large_less, small = 1 / large, small_less = -large_less * small;
  const bool positive = exponent >= 0;
  return {positive ? large : small, positive ? small : large, positive ? large_less : small_less,
          positive ? small_less : large_less};
}

// Elastic part. With x = ln lambda_theta and y = ln lambda, W = sum mu/alpha (e^{alpha x} + e^{alpha y} +
// e^{-alpha (x + y)} - 3); x depends on r and zeta, y on zeta.
GAITER_INLINE void add_elastic(const SliceShape& slice, const Pack* section, TubeTerms& tube) {
  const int terms = slice.ogden_terms, points = static_cast<int>(slice.wall.nodes.size());
  const Pack *mu = section + slice.mu_row(0), *alpha = section + slice.alpha_row(0),
             *wall = section + slice.wall_row(0), *weights = section + slice.weight_row(0);
  const Pack& log_wall = section[SliceShape::log_wall];
  Pack log_hoop, inverse, W, Wx, Wy, Wxx, Wxy, Wyy;
  // The meridian's powers are the same at all wall points.
  constexpr int kept_terms = 8;
  Pack kept[kept_terms][4];
  const auto meridian_powers = [&](int term, Pack* out) __attribute__((always_inline)) {
    const Pack& exponent = alpha[term];
    GAITER_EACH {
      const Powers meridian = powers(exponent[i] * tube.log_meridian[i]);
      out[0][i] = meridian.up;
      out[1][i] = meridian.down;
      out[2][i] = meridian.up_less;
      out[3][i] = meridian.down_less;
    }
  };
  for (int term = 0; term < terms && term < kept_terms; ++term) meridian_powers(term, kept[term]);
  for (int j = 0; j < points; ++j) {
    const Pack& ratio = wall[j];  // A^2/s
    GAITER_EACH {
      const double square = tube.swell[i] * ratio[i] + tube.narrow_less[i] * (1 - ratio[i]);
      log_hoop[i] = 0.5 * log1p(square);
      inverse[i] = 1 / (1 + square);
      W[i] = Wx[i] = Wy[i] = Wxx[i] = Wxy[i] = Wyy[i] = 0;
    }
    for (int term = 0; term < terms; ++term) {
      const Pack &modulus = mu[term], &exponent = alpha[term];
      Pack own[4];
      if (term >= kept_terms) meridian_powers(term, own);
      const Pack* meridian = term < kept_terms ? kept[term] : own;
      const Pack &up = meridian[0], &down = meridian[1], &up_less = meridian[2], &down_less = meridian[3];
      GAITER_EACH {
        const Powers hoop = powers(exponent[i] * log_hoop[i]);
        const double radial = hoop.down * down[i];
        const double radial_less = hoop.down_less + down_less[i] + hoop.down_less * down_less[i];
        const double stiffness = modulus[i] * exponent[i];
        W[i] += modulus[i] / exponent[i] * (hoop.up_less + up_less[i] + radial_less);
        Wx[i] += modulus[i] * (hoop.up_less - radial_less);
        Wy[i] += modulus[i] * (up_less[i] - radial_less);
        Wxx[i] += stiffness * (hoop.up + radial);
        Wxy[i] += stiffness * radial;
        Wyy[i] += stiffness * (up[i] + radial);
      }
    }
    const Pack& weight = weights[j];
    GAITER_EACH {
      const double share = 0.5 * weight[i] * log_wall[i] / ratio[i];
      const double along = 1 / tube.zeta[i];
      const double x_r = tube.r[i] * ratio[i] * inverse[i];
      const double x_zeta = -0.5 * tube.narrow[i] * along * (1 - ratio[i]) * inverse[i];
      const double x_rr = ratio[i] * inverse[i] - 2 * x_r * x_r;
      tube.w[i] += share * W[i];
      tube.size[i] += share * std::fabs(W[i]);
      tube.w_r[i] += share * Wx[i] * x_r;
      tube.w_zeta[i] += share * (Wx[i] * x_zeta + Wy[i] * along);
      tube.w_rr[i] += share * (Wxx[i] * x_r * x_r + Wx[i] * x_rr);
      tube.w_rzeta[i] += share * x_r * ((Wxx[i] - 2 * Wx[i]) * x_zeta + Wxy[i] * along);
      tube.w_zetazeta[i] +=
          share * (x_zeta * (Wxx[i] * x_zeta + 2 * Wxy[i] * along) + (Wyy[i] - Wy[i]) * along * along -
                   2 * Wx[i] * x_zeta * (along + x_zeta));
    }
  }
}

// Of each layer -D zeta/L with L = log1p(q), q = g (B^2 - A^2)/a^2 of the layer in the deformed wall.
GAITER_INLINE void add_electric(const SliceShape& slice, const Pack* section, TubeTerms& tube) {
  for (int k = 0; k < slice.layers; ++k) {
    const Pack* layer = section + slice.layer_row(k);
    const Pack &ratio = layer[0], &area = layer[1], &drive = layer[2];
    GAITER_EACH {
      const double r = tube.r[i], zeta = tube.zeta[i], along = 1 / zeta;
      const double inner = 1 + ratio[i] * tube.swell[i] + tube.narrow_less[i] * (1 - ratio[i]);
      const double q = tube.narrow[i] * area[i] / inner;
      const double inverse = 1 / std::log1p(q);
      // inner and ln q, their derivatives.
      const double i_r = 2 * r * ratio[i] / inner;
      const double i_zeta = -tube.narrow[i] * along * (1 - ratio[i]) / inner;
      const double a_r = -i_r, a_zeta = -along - i_zeta;
      const double a_rr = i_r * i_r - 2 * ratio[i] / inner, a_rzeta = i_r * i_zeta;
      const double a_zetazeta = along * along + 2 * along * i_zeta + i_zeta * i_zeta;
      // L'/L and L''/L with respect to ln q.
      const double first = q / (1 + q) * inverse, second = first / (1 + q);
      const double l_r = first * a_r, l_zeta = first * a_zeta;
      const double l_rr = second * a_r * a_r + first * a_rr;
      const double l_rzeta = second * a_r * a_zeta + first * a_rzeta;
      const double l_zetazeta = second * a_zeta * a_zeta + first * a_zetazeta;
      const double scale = -0.5 * drive[i] / ratio[i] * inverse;
      tube.w[i] += scale * zeta;
      tube.size[i] -= scale * zeta;
      tube.w_r[i] -= scale * zeta * l_r;
      tube.w_zeta[i] += scale * (1 - zeta * l_zeta);
      tube.w_rr[i] += scale * zeta * (2 * l_r * l_r - l_rr);
      tube.w_rzeta[i] += scale * (zeta * (2 * l_r * l_zeta - l_rzeta) - l_r);
      tube.w_zetazeta[i] += scale * (zeta * (2 * l_zeta * l_zeta - l_zetazeta) - 2 * l_zeta);
    }
  }
}

GAITER_INLINE void clear(TubeTerms& tube) {
  GAITER_EACH {
    tube.w[i] = tube.size[i] = tube.w_r[i] = tube.w_zeta[i] = 0;
    tube.w_rr[i] = tube.w_rzeta[i] = tube.w_zetazeta[i] = 0;
  }
}

}  // namespace

GAITER_MULTIVERSION
void sliding_terms(const SlidingShape& shape, const SliceShape& slice, const Pack* section, const Pack* rows,
                   const SlidingPlace& place, SlidingTerms& terms) {
  LegTerms leg;
  leg_terms(shape, slice, section, rows, place.contact, leg);
  TubeTerms tube;
  tube_place(section, rows, place, leg.strain, tube);
  clear(tube);
  add_elastic(slice, section, tube);
  add_electric(slice, section, tube);
  const Pack &slope = rows[SlidingSystem::slope], &free = rows[SlidingSystem::free];
  GAITER_EACH {
    const double m = slope[i], zeta = tube.zeta[i], strain = leg.strain[i];
    const double radius = section[SliceShape::leg_radius][i] + m * place.height[i];
    const double squared = radius * radius, rise = m * (1 - strain);
    const double phi = leg.phi[i], phi_strain = leg.pressure[i] * (1 - strain);
    const double phi_contact = leg.pressure_slope[i] * (1 - strain) - leg.pressure[i] * leg.strain_slope[i];
    terms.energy[i] = tube.w[i] + squared * phi * zeta;
    terms.energy_size[i] = tube.size[i] + squared * std::fabs(phi) * zeta;
    terms.strain[i] = -radius * tube.w_r[i] + squared * zeta * phi_strain;
    terms.strain_slope[i] = leg.strain_slope[i];
    terms.strain_stiffness[i] = squared * (tube.w_rr[i] * leg.strain_slope[i] + zeta * phi_contact);
    const double z = tube.w_r[i] * rise + 2 * radius * m * phi * zeta;
    const double along = tube.w_zeta[i] + squared * phi;
    const double z_z = tube.w_rr[i] * rise * rise + 2 * m * m * phi * zeta;
    const double z_zeta = tube.w_rzeta[i] * rise + 2 * radius * m * phi;
    const double z_strain =
        -radius * tube.w_rr[i] * rise - m * tube.w_r[i] + 2 * radius * m * zeta * phi_strain;
    const double zeta_strain = -radius * tube.w_rzeta[i] + squared * phi_strain;
    // A segment that is held keeps z = Z: its equation in z is replaced by that of a bar without load.
    const bool slides = free[i] > 0;
    terms.z[i] = slides ? z : 0;
    terms.zeta[i] = slides ? along : 0;
    terms.z_z[i] = slides ? z_z : 0;
    terms.z_zeta[i] = slides ? z_zeta : 0;
    terms.zeta_zeta[i] = slides ? tube.w_zetazeta[i] : 1;
    terms.z_strain[i] = slides ? z_strain : 0;
    terms.zeta_strain[i] = slides ? zeta_strain : 0;
    const bool sound = tube.r[i] > smallest_radius && strain < largest_strain && zeta > smallest_advance &&
                       std::fabs(terms.energy[i]) < 1e200 && std::fabs(terms.strain[i]) < 1e200 &&
                       std::fabs(z_z) < 1e200 && std::fabs(tube.w_zetazeta[i]) < 1e200 &&
                       std::fabs(terms.strain_stiffness[i]) < 1e200;
    terms.admissible[i] = sound ? 1 : 0;
  }
}

GAITER_MULTIVERSION
void describe_circle(const SlidingShape& shape, const SliceShape& slice, const Pack* section,
                     const Pack* rows, const SlidingPlace& place, SlidingCircle& circle) {
  LegTerms leg;
  leg_terms(shape, slice, section, rows, place.contact, leg);
  TubeTerms tube;
  tube_place(section, rows, place, leg.strain, tube);
  clear(tube);
  add_electric(slice, section, tube);
  const Pack& log_slope = rows[SlidingSystem::log_slope];
  GAITER_EACH {
    const double none =
        shape.rigid || slice.material == model::LegMaterial::neo_hookean ? 0 : section[SliceShape::leg_2][i];
    circle.pressure[i] = leg.pressure[i];
    circle.leg_strain[i] = place.contact[i] > 0 ? leg.strain[i] : none;
    circle.leg_radius[i] =
        section[SliceShape::leg_radius][i] + rows[SlidingSystem::slope][i] * place.height[i];
    circle.tube_radius[i] = tube.r[i];
    circle.actuation_pressure[i] = -tube.w_r[i] / (tube.r[i] * tube.zeta[i]);
    circle.field[i] = 0;
  }
  for (int k = 0; k < slice.layers; ++k) {
    const Pack* layer = section + slice.layer_row(k);
    GAITER_EACH {
      const double inner = 1 + layer[0][i] * tube.swell[i] + tube.narrow_less[i] * (1 - layer[0][i]);
      const double thickness = std::log1p(tube.narrow[i] * layer[1][i] / inner);
      const double here = 2 * std::exp(-log_slope[i]) / (std::sqrt(inner / layer[0][i]) * thickness);
      const double field = layer[2][i] > 0 ? here : 0;
      circle.field[i] = field > circle.field[i] ? field : circle.field[i];
    }
  }
}

}  // namespace gaiter::physics
