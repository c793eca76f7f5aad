// SPDX-License-Identifier: BSD-2-Clause
#include <algorithm>

#include "gaiter/physics/sliding_basis.hpp"
#include "gaiter/physics/sliding_newton.hpp"

namespace gaiter::physics {

namespace {

using namespace sliding;

#define GAITER_EACH for (int i = 0; i < pack_width; ++i)

constexpr double doubtful_jump = 0.1;  // relative, of dz/dZ between two elements
constexpr double hopeless_jump = 1;    // the elements are too few, whatever else
constexpr int local_steps = 6;         // of a slice's own equation, between two slices

// Of the energy with the leg's strain eliminated: whether it is convex in dz/dZ.
double convex_at(double zeta_zeta, double zeta_strain, double strain_slope, double strain_stiffness) {
  return strain_stiffness > 0 && zeta_zeta * strain_stiffness > zeta_strain * zeta_strain * strain_slope ? 1
                                                                                                         : 0;
}

// Largest relative jump of dz/dZ between two elements.
void largest_jump(const SlidingShape& shape, const Pack& element_height, const std::vector<Pack>& unknown,
                  Pack& jump) {
  const auto advance = [&](int element, int side, Pack& end) {
    GAITER_EACH end[i] = 0;
    for (int a = 0; a <= degree; ++a) {
      const int row = slip_row(element, a);
      if (row < 0) continue;
      GAITER_EACH end[i] += basis.end_slope[side][a] * unknown[row][i];
    }
    GAITER_EACH end[i] = 1 + end[i] / element_height[i];
  };
  GAITER_EACH jump[i] = 0;
  Pack below, above;
  for (int element = 1; element < shape.elements; ++element) {
    advance(element - 1, 1, below);
    advance(element, 0, above);
    GAITER_EACH {
      const double smaller = std::min(above[i], below[i]);
      const double relative = smaller > 0 ? std::fabs(above[i] - below[i]) / smaller : 2 * hopeless_jump;
      jump[i] = std::max(jump[i], relative);
    }
  }
}

// Convexity at three places between each two slices, where the tube, were it smooth, would have every dz/dZ
// between theirs.
void convex_between(const SlidingSystem& system, std::size_t pack, const std::vector<Pack>& unknown,
                    Pack& convex) {
  const SlidingShape& shape = system.shape();
  SlidingPlace lower, upper, between;
  SlidingTerms terms;
  sliding_place(system, pack, unknown, 0, lower);
  for (int slice = 1; slice < shape.slices(); ++slice, lower = upper) {
    sliding_place(system, pack, unknown, slice, upper);
    for (double part : {0.25, 0.5, 0.75}) {
      GAITER_EACH {
        between.height[i] = (1 - part) * lower.height[i] + part * upper.height[i];
        between.advance[i] = (1 - part) * lower.advance[i] + part * upper.advance[i];
        between.contact[i] = (1 - part) * lower.contact[i] + part * upper.contact[i];
      }
      for (int step = 0; step <= local_steps; ++step) {
        sliding_terms(shape, system.slice_shape(), system.section(pack), system.pack(pack), between, terms);
        if (step == local_steps) break;
        GAITER_EACH {
          const double change = terms.strain[i] / terms.strain_stiffness[i];
          const bool usable = terms.admissible[i] > 0 && terms.strain_stiffness[i] > 0;
          const double most = 0.3 * std::fabs(between.contact[i]) + 0.1;
          between.contact[i] -= usable ? std::clamp(change, -most, most) : 0;
        }
      }
      GAITER_EACH convex[i] *= convex_at(terms.zeta_zeta[i], terms.zeta_strain[i], terms.strain_slope[i],
                                         terms.strain_stiffness[i]);
    }
  }
}

}  // namespace

void judge_sliding(const SlidingSystem& system, std::size_t pack, const SlidingState& state, Pack& trusted) {
  const SlidingShape& shape = system.shape();
  const SlidingTangent& tangent = state.tangent;
  Pack jump, convex;
  largest_jump(shape, system.pack(pack)[SlidingSystem::element_height], state.unknown, jump);
  double doubtful = 0;
  GAITER_EACH {
    trusted[i] = jump[i] < hopeless_jump ? 1 : 0;
    convex[i] = 1;
    doubtful = std::max(doubtful, jump[i]);
  }
  for (int slice = 0; slice < shape.slices(); ++slice)
    GAITER_EACH trusted[i] *= convex_at(tangent.zeta_zeta[slice][i], tangent.zeta_strain[slice][i],
                                        tangent.strain_slope[slice][i], tangent.strain_stiffness[slice][i]);
  if (!(doubtful > doubtful_jump)) return;
  convex_between(system, pack, state.unknown, convex);
  GAITER_EACH trusted[i] *= jump[i] > doubtful_jump ? convex[i] : 1;
}

double largest_slip(const SlidingShape& shape, const std::vector<Pack>& unknown, int lane) {
  double largest = 0;
  for (int element = 0; element < shape.elements; ++element) {
    double slip[degree + 1];
    for (int a = 0; a <= degree; ++a) {
      const int row = slip_row(element, a);
      slip[a] = row < 0 ? 0 : unknown[row][lane];
      largest = std::max(largest, std::fabs(slip[a]));
    }
    // Inside, where the slope c0 + c1 x + c2 x^2 vanishes.
    double slope[3] = {0, 0, 0};
    for (int k = 0; k < 3; ++k)
      for (int a = 0; a <= degree; ++a) slope[k] += basis.slope_at(0.5 * k, a) * slip[a];
    const double c0 = slope[0], c1 = -3 * slope[0] + 4 * slope[1] - slope[2],
                 c2 = 2 * slope[0] - 4 * slope[1] + 2 * slope[2];
    const double root = c1 * c1 - 4 * c0 * c2;
    if (root < 0) continue;
    const double q = -0.5 * (c1 + std::copysign(std::sqrt(root), c1));
    for (double x : {c2 != 0 ? q / c2 : -1.0, q != 0 ? c0 / q : -1.0}) {
      if (!(x > 0 && x < 1)) continue;
      double value = 0;
      for (int a = 0; a <= degree; ++a) value += basis.value_at(x, a) * slip[a];
      largest = std::max(largest, std::fabs(value));
    }
  }
  return largest;
}

}  // namespace gaiter::physics
