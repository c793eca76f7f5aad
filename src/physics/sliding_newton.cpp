// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/sliding_newton.hpp"

#include <cmath>

#include "gaiter/physics/slice_newton.hpp"
#include "gaiter/physics/sliding_basis.hpp"

namespace gaiter::physics {

namespace {

using namespace sliding;

#define GAITER_EACH for (int i = 0; i < pack_width; ++i)

inline __attribute__((always_inline)) void interpolate(const SlidingShape& shape, const Pack& element_height,
                                                       const std::vector<Pack>& unknown, int slice,
                                                       SlidingPlace& place) {
  const int element = slice / degree, g = slice % degree;
  const double reference = element + basis.point[g] - 0.5 * shape.elements;
  GAITER_EACH {
    place.height[i] = reference * element_height[i];
    place.advance[i] = 0;
  }
  for (int a = 0; a <= degree; ++a) {
    const int row = slip_row(element, a);
    if (row < 0) continue;
    const Pack& slip = unknown[row];
    const double value = basis.value[g][a], slope = basis.slope[g][a];
    GAITER_EACH {
      place.height[i] += value * slip[i];
      place.advance[i] += slope * slip[i];
    }
  }
  const Pack& contact = unknown[shape.slices() + slice];
  GAITER_EACH {
    place.advance[i] /= element_height[i];
    place.contact[i] = contact[i];
  }
}

// Pivots that are not positive are counted, and replaced by their sizes.
inline __attribute__((always_inline)) double sound_pivot(double pivot, double scale, double& negative) {
  const double size = std::fabs(pivot), floor = 1e-14 * std::fabs(scale) + 1e-300;
  negative += pivot > 0 ? 0 : 1;
  return size > floor ? size : floor;
}

// An element's equations with its two inner nodes eliminated: [k00 k03; k03 k33] of its ends, loads f0 and
// f3, and the inner slips back: slip = load - lower x0 - upper x3.
struct ElementBlock {
  Pack k00, k03, k33, f0, f3;
  Pack load[2], lower[2], upper[2];
};

GAITER_MULTIVERSION
void condense(int element, int slices, const Pack& element_height, const SlidingTangent& tangent,
              const std::vector<Pack>& y, ElementBlock& block, Pack& negative) {
  Pack K[10], f[4];  // upper triangle by rows
  for (Pack& k : K) GAITER_EACH k[i] = 0;
  for (int a = 0; a <= degree; ++a) GAITER_EACH f[a][i] = 0;
  for (int g = 0; g < degree; ++g) {
    const int slice = degree * element + g;
    const Pack &zz = tangent.z_z[slice], &zs = tangent.z_zeta[slice], &ss = tangent.zeta_zeta[slice],
               &ze = tangent.z_strain[slice], &se = tangent.zeta_strain[slice],
               &slope = tangent.strain_slope[slice], &stiffness = tangent.strain_stiffness[slice],
               &right = y[slices + slice];
    Pack c00, c01, c11, f0, f1;
    GAITER_EACH {
      const double h = element_height[i], weight = basis.weight[g];
      double bad = 0;
      const double k = sound_pivot(stiffness[i], ze[i] * ze[i] + 1, bad);
      // A slice that is not stable by itself: its own strain, not one that adheres to the leg.
      negative[i] += bad;
      const double share = slope[i] / k;
      c00[i] = weight * h * (zz[i] - ze[i] * ze[i] * share);
      c01[i] = weight * (zs[i] - ze[i] * se[i] * share);
      c11[i] = weight / h * (ss[i] - se[i] * se[i] * share);
      f0[i] = -weight * h * ze[i] * share * right[i];
      f1[i] = -weight * se[i] * share * right[i];
    }
    int entry = 0;
    for (int a = 0; a <= degree; ++a) {
      const double Na = basis.value[g][a], Sa = basis.slope[g][a];
      GAITER_EACH f[a][i] += Na * f0[i] + Sa * f1[i];
      for (int b = a; b <= degree; ++b, ++entry) {
        const double NN = Na * basis.value[g][b], SS = Sa * basis.slope[g][b];
        const double NS = Na * basis.slope[g][b] + Sa * basis.value[g][b];
        Pack& k = K[entry];
        GAITER_EACH k[i] += NN * c00[i] + NS * c01[i] + SS * c11[i];
      }
    }
  }
  const Pack &right1 = y[slip_row(element, 1)], &right2 = y[slip_row(element, 2)];
  GAITER_EACH {
    const double k00 = K[0][i], k01 = K[1][i], k02 = K[2][i], k03 = K[3][i], k11 = K[4][i], k12 = K[5][i],
                 k13 = K[6][i], k22 = K[7][i], k23 = K[8][i], k33 = K[9][i];
    double bad = 0;
    const double first = 1 / sound_pivot(k11, k11, bad);
    const double factor = k12 * first;
    const double second = 1 / sound_pivot(k22 - factor * k12, k22, bad);
    negative[i] += bad;
    const auto inner = [&](double one, double two, double& x1, double& x2) {
      x2 = (two - factor * one) * second;
      x1 = one * first - factor * x2;
    };
    double l1, l2, u1, u2, q1, q2;
    inner(k01, k02, l1, l2);
    inner(k13, k23, u1, u2);
    inner(f[1][i] + right1[i], f[2][i] + right2[i], q1, q2);
    block.lower[0][i] = l1;
    block.lower[1][i] = l2;
    block.upper[0][i] = u1;
    block.upper[1][i] = u2;
    block.load[0][i] = q1;
    block.load[1][i] = q2;
    block.k00[i] = k00 - k01 * l1 - k02 * l2;
    block.k03[i] = k03 - k01 * u1 - k02 * u2;
    block.k33[i] = k33 - k13 * u1 - k23 * u2;
    block.f0[i] = f[0][i] - k01 * q1 - k02 * q2;
    block.f3[i] = f[3][i] - k13 * q1 - k23 * q2;
  }
}

}  // namespace

SlidingTangent::SlidingTangent(int slices)
    : z_z(slices),
      z_zeta(slices),
      zeta_zeta(slices),
      z_strain(slices),
      zeta_strain(slices),
      strain_slope(slices),
      strain_stiffness(slices),
      residual(2 * slices),
      advance(slices) {}

SlidingState::SlidingState(int slices)
    : unknown(2 * slices), tangent(slices), trial(slices), trial_unknown(2 * slices) {}

void sliding_place(const SlidingSystem& system, std::size_t pack, const std::vector<Pack>& unknown, int slice,
                   SlidingPlace& place) {
  interpolate(system.shape(), system.pack(pack)[SlidingSystem::element_height], unknown, slice, place);
}

double slice_height(const SlidingShape& shape, int slice) {
  return (slice / degree + basis.point[slice % degree]) / shape.elements;
}

double slice_share(const SlidingShape& shape, int slice) {
  return basis.weight[slice % degree] / shape.elements;
}

void start_sliding(const SlidingSystem& system, std::size_t pack, SlidingState& state) {
  const SlidingShape& shape = system.shape();
  const SliceShape& slice_shape = system.slice_shape();
  const int slices = shape.slices();
  // The slices' constants differ from those of the slice at mean radius in two rows.
  const Pack* section = system.section(pack);
  std::vector<Pack> rows(section, section + slice_shape.layer_row(slice_shape.layers));
  const Pack *more = system.pack(pack), &gap = section[SliceShape::gap],
             &radius = section[SliceShape::leg_radius];
  PackState start;
  Pack rigid_pressure;
  for (int row = 0; row < slices; ++row) GAITER_EACH state.unknown[row][i] = 0;
  for (int slice = 0; slice < slices; ++slice) {
    const double height = shape.elements * (slice_height(shape, slice) - 0.5);
    GAITER_EACH {
      const double rise = more[SlidingSystem::slope][i] * height * more[SlidingSystem::element_height][i];
      rows[SliceShape::gap][i] = gap[i] + rise;
      rows[SliceShape::leg_radius][i] = radius[i] + rise;
    }
    start_at_rest(slice_shape, rows.data(), start, rigid_pressure);
    Pack& contact = state.unknown[slices + slice];
    const bool neo_hookean = slice_shape.material == model::LegMaterial::neo_hookean;
    GAITER_EACH contact[i] = shape.rigid   ? (rigid_pressure[i] > 0 ? rigid_pressure[i] : 0)
                             : neo_hookean ? 2 * start.strain[i]
                                           : start.pressure[i];
  }
  GAITER_EACH {
    state.iterations[i] = state.failed[i] = state.last_step[i] = state.negative[i] = 0;
    state.open[i] = 1;
  }
}

GAITER_MULTIVERSION
void evaluate_sliding(const SlidingSystem& system, std::size_t pack, const std::vector<Pack>& unknown,
                      SlidingTangent& tangent) {
  const SlidingShape& shape = system.shape();
  const int slices = shape.slices();
  const Pack& element_height = system.pack(pack)[SlidingSystem::element_height];
  SlidingPlace place;
  SlidingTerms terms;
  GAITER_EACH {
    tangent.energy[i] = tangent.energy_size[i] = 0;
    tangent.admissible[i] = 1;
  }
  for (int row = 0; row < slices; ++row) GAITER_EACH tangent.residual[row][i] = 0;
  for (int slice = 0; slice < slices; ++slice) {
    const int element = slice / degree, g = slice % degree;
    interpolate(shape, element_height, unknown, slice, place);
    sliding_terms(shape, system.slice_shape(), system.section(pack), system.pack(pack), place, terms);
    tangent.advance[slice] = place.advance;
    tangent.z_z[slice] = terms.z_z;
    tangent.z_zeta[slice] = terms.z_zeta;
    tangent.zeta_zeta[slice] = terms.zeta_zeta;
    tangent.z_strain[slice] = terms.z_strain;
    tangent.zeta_strain[slice] = terms.zeta_strain;
    tangent.strain_slope[slice] = terms.strain_slope;
    tangent.strain_stiffness[slice] = terms.strain_stiffness;
    tangent.residual[slices + slice] = terms.strain;
    const double weight = basis.weight[g];
    for (int a = 0; a <= degree; ++a) {
      const int row = slip_row(element, a);
      if (row < 0 || row == slices - 1) continue;
      const double value = weight * basis.value[g][a], slope = weight * basis.slope[g][a];
      Pack& residual = tangent.residual[row];
      GAITER_EACH residual[i] += value * element_height[i] * terms.z[i] + slope * terms.zeta[i];
    }
    GAITER_EACH {
      tangent.energy[i] += weight * element_height[i] * terms.energy[i];
      tangent.energy_size[i] += weight * element_height[i] * terms.energy_size[i];
      tangent.admissible[i] *= terms.admissible[i];
    }
  }
}

void multiply_sliding(const SlidingSystem& system, std::size_t pack, const SlidingTangent& tangent,
                      const std::vector<Pack>& x, std::vector<Pack>& y) {
  const SlidingShape& shape = system.shape();
  const int slices = shape.slices();
  const Pack& element_height = system.pack(pack)[SlidingSystem::element_height];
  for (int row = 0; row < slices; ++row) GAITER_EACH y[row][i] = 0;
  for (int slice = 0; slice < slices; ++slice) {
    const int element = slice / degree, g = slice % degree;
    Pack z, zeta;
    GAITER_EACH z[i] = zeta[i] = 0;
    for (int a = 0; a <= degree; ++a) {
      const int row = slip_row(element, a);
      if (row < 0 || row == slices - 1) continue;
      GAITER_EACH {
        z[i] += basis.value[g][a] * x[row][i];
        zeta[i] += basis.slope[g][a] * x[row][i] / element_height[i];
      }
    }
    Pack by_z, by_zeta;
    GAITER_EACH {
      const double contact = x[slices + slice][i], strain = tangent.strain_slope[slice][i] * contact;
      by_z[i] = tangent.z_z[slice][i] * z[i] + tangent.z_zeta[slice][i] * zeta[i] +
                tangent.z_strain[slice][i] * strain;
      by_zeta[i] = tangent.z_zeta[slice][i] * z[i] + tangent.zeta_zeta[slice][i] * zeta[i] +
                   tangent.zeta_strain[slice][i] * strain;
      y[slices + slice][i] = tangent.z_strain[slice][i] * z[i] + tangent.zeta_strain[slice][i] * zeta[i] +
                             tangent.strain_stiffness[slice][i] * contact;
    }
    const double weight = basis.weight[g];
    for (int a = 0; a <= degree; ++a) {
      const int row = slip_row(element, a);
      if (row < 0 || row == slices - 1) continue;
      GAITER_EACH y[row][i] +=
          weight * (basis.value[g][a] * element_height[i] * by_z[i] + basis.slope[g][a] * by_zeta[i]);
    }
  }
  y[slices - 1] = x[slices - 1];
}

GAITER_MULTIVERSION
void solve_sliding_tangent(const SlidingSystem& system, std::size_t pack, const SlidingTangent& tangent,
                           const std::vector<Pack>& y, std::vector<Pack>& x, Pack& negative) {
  const SlidingShape& shape = system.shape();
  const int slices = shape.slices(), elements = shape.elements;
  const Pack& element_height = system.pack(pack)[SlidingSystem::element_height];
  GAITER_EACH negative[i] = 0;
  std::vector<ElementBlock> blocks(elements);
  for (int e = 0; e < elements; ++e) condense(e, slices, element_height, tangent, y, blocks[e], negative);

  // The ends of the elements between the fixed two, upwards; the ratio of each to its upper neighbour and the
  // reduced load stay in k33 and f3 of the element below.
  for (int e = 0; e + 1 < elements; ++e) {
    ElementBlock &below = blocks[e], &above = blocks[e + 1];
    const Pack& right = y[slip_row(e, degree)];
    GAITER_EACH {
      double bad = 0;
      const double diagonal = below.k33[i] + above.k00[i];
      const double inverse = 1 / sound_pivot(diagonal, diagonal, bad);
      negative[i] += bad;
      const double load = (below.f3[i] + above.f0[i] + right[i]) * inverse;
      const double ratio = above.k03[i] * inverse;
      below.f3[i] = load;
      below.k33[i] = ratio;
      above.f3[i] -= above.k03[i] * load;
      above.k33[i] -= above.k03[i] * ratio;
    }
  }
  x[slices - 1] = y[slices - 1];
  Pack lower_end, upper_end;
  GAITER_EACH upper_end[i] = 0;
  for (int e = elements - 1; e >= 0; --e) {
    ElementBlock& block = blocks[e];
    if (e > 0) {
      Pack& slip = x[slip_row(e, 0)];
      GAITER_EACH slip[i] = lower_end[i] = blocks[e - 1].f3[i] - blocks[e - 1].k33[i] * upper_end[i];
    } else {
      GAITER_EACH lower_end[i] = 0;
    }
    for (int k = 0; k < 2; ++k) {
      Pack& slip = x[slip_row(e, k + 1)];
      GAITER_EACH slip[i] =
          block.load[k][i] - block.lower[k][i] * lower_end[i] - block.upper[k][i] * upper_end[i];
    }
    upper_end = lower_end;
  }
  for (int slice = 0; slice < slices; ++slice) {
    const int element = slice / degree, g = slice % degree;
    Pack z, zeta;
    GAITER_EACH z[i] = zeta[i] = 0;
    for (int a = 0; a <= degree; ++a) {
      const int row = slip_row(element, a);
      if (row < 0 || row == slices - 1) continue;
      const Pack& slip = x[row];
      const double value = basis.value[g][a], slope = basis.slope[g][a];
      GAITER_EACH {
        z[i] += value * slip[i];
        zeta[i] += slope * slip[i];
      }
    }
    const Pack &ze = tangent.z_strain[slice], &se = tangent.zeta_strain[slice],
               &stiffness = tangent.strain_stiffness[slice], &right = y[slices + slice];
    Pack& contact = x[slices + slice];
    GAITER_EACH {
      double bad = 0;
      const double k = sound_pivot(stiffness[i], ze[i] * ze[i] + 1, bad);
      contact[i] = (right[i] - ze[i] * z[i] - se[i] * zeta[i] / element_height[i]) / k;
    }
  }
}

}  // namespace gaiter::physics
