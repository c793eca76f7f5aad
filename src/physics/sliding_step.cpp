// SPDX-License-Identifier: BSD-2-Clause
#include <cmath>
#include <utility>

#include "gaiter/physics/sliding_basis.hpp"
#include "gaiter/physics/sliding_newton.hpp"

namespace gaiter::physics {

namespace {

using namespace sliding;

#define GAITER_EACH for (int i = 0; i < pack_width; ++i)

constexpr int shortest_try = 12;  // powers of 0.4

// Sum over the pack's lanes of flags.
double count(const Pack& flags) {
  double sum = 0;
  GAITER_EACH sum += flags[i];
  return sum;
}

// Size of the Newton step, the longest part of it that the tube stands, and the energy's slope along it.
struct Step {
  Pack size, longest, slope;
};

GAITER_MULTIVERSION
void measure(const SlidingShape& shape, const Pack& element_height, const SlidingState& state,
             const std::vector<Pack>& direction, Step& step) {
  const int slices = shape.slices();
  Pack contact_size, contact_step;
  GAITER_EACH {
    step.size[i] = step.slope[i] = contact_step[i] = 0;
    step.longest[i] = 1;
    contact_size[i] = 1e-12;
  }
  for (int row = 0; row + 1 < slices; ++row) {
    const Pack &residual = state.tangent.residual[row], &move = direction[row];
    GAITER_EACH step.slope[i] += residual[i] * move[i];
  }
  for (int slice = 0; slice < slices; ++slice) {
    const int element = slice / degree, g = slice % degree;
    Pack zeta;
    GAITER_EACH zeta[i] = 0;
    for (int a = 0; a <= degree; ++a) {
      const int row = slip_row(element, a);
      if (row < 0 || row == slices - 1) continue;
      const Pack& slip = direction[row];
      const double slope = basis.slope[g][a];
      GAITER_EACH zeta[i] += slope * slip[i];
    }
    const Pack &advance = state.tangent.advance[slice], &strain_slope = state.tangent.strain_slope[slice],
               &residual = state.tangent.residual[slices + slice], &move = direction[slices + slice],
               &contact = state.unknown[slices + slice];
    const double weight = basis.weight[g];
    GAITER_EACH {
      const double relative = zeta[i] / element_height[i] / (1 + advance[i]);
      const double strain = std::fabs(strain_slope[i] * move[i]);
      const double by_zeta = relative > 0 ? 0.5 / (relative + 1e-300) : 1 / (1e-300 - relative);
      const double by_strain = 0.3 / (strain + 1e-300);
      const double shorter = by_zeta < by_strain ? by_zeta : by_strain;
      step.longest[i] = shorter < step.longest[i] ? shorter : step.longest[i];
      const double size = std::fabs(relative), change = std::fabs(move[i]);
      const double now = std::fabs(contact[i]), then = std::fabs(contact[i] - move[i]);
      const double pressure = now > then ? now : then;
      step.size[i] = size > step.size[i] ? size : step.size[i];
      contact_size[i] = pressure > contact_size[i] ? pressure : contact_size[i];
      contact_step[i] = change > contact_step[i] ? change : contact_step[i];
      step.slope[i] += weight * element_height[i] * residual[i] * strain_slope[i] * move[i];
    }
  }
  GAITER_EACH {
    const double size = contact_step[i] / contact_size[i];
    step.size[i] = size > step.size[i] ? size : step.size[i];
  }
}

}  // namespace

void step_size(const SlidingSystem& system, std::size_t pack, const SlidingState& state,
               const std::vector<Pack>& direction, Pack& size) {
  Step step;
  measure(system.shape(), system.pack(pack)[SlidingSystem::element_height], state, direction, step);
  size = step.size;
}

void advance_sliding(const SlidingSystem& system, std::size_t pack, const std::vector<Pack>& direction,
                     double tolerance, SlidingState& state) {
  Step step;
  measure(system.shape(), system.pack(pack)[SlidingSystem::element_height], state, direction, step);
  Pack part, refused;
  GAITER_EACH {
    // A step that is not finite is no step.
    const bool sound = step.size[i] < 1e200;
    part[i] = state.open[i] > 0 && sound ? step.longest[i] : 0;
    state.failed[i] = state.open[i] > 0 && !sound ? 1 : state.failed[i];
  }
  for (int attempt = 0; attempt <= shortest_try; ++attempt) {
    for (std::size_t row = 0; row < state.unknown.size(); ++row) GAITER_EACH {
        const double move = part[i] * direction[row][i];
        state.trial_unknown[row][i] = state.unknown[row][i] - (part[i] > 0 ? move : 0);
      }
    evaluate_sliding(system, pack, state.trial_unknown, state.trial);
    GAITER_EACH {
      // Energies are known to rounding only, and a small step of a quadratic iteration needs no test.
      const double rounding = 1e-13 * state.trial.energy_size[i];
      const double wanted = state.tangent.energy[i] - 1e-4 * part[i] * step.slope[i] + rounding;
      const bool good = state.trial.admissible[i] > 0 && state.trial.energy[i] <= wanted;
      refused[i] = part[i] > 0 && !good ? 1 : 0;
    }
    if (count(refused) == 0) break;
    GAITER_EACH {
      const bool last = attempt + 1 >= shortest_try;
      state.failed[i] = refused[i] > 0 && last ? 1 : state.failed[i];
      part[i] = refused[i] > 0 ? (last ? 0 : 0.4 * part[i]) : part[i];
    }
  }
  std::swap(state.unknown, state.trial_unknown);
  std::swap(state.tangent, state.trial);
  GAITER_EACH {
    const bool open = state.open[i] > 0, full = part[i] == 1;
    const double size = step.size[i], before = state.last_step[i];
    // Only a step that is small already can tell how small the next one will be.
    const bool converging = before > 0 && before < 0.5 && size < 0.1 * before;
    const double ratio = converging ? size / before : 1;
    const double next = size * ratio * ratio;
    const bool stalled = before > 0 && size < 1e-8 && size > 0.2 * before;
    const bool closing = full && (next <= tolerance || stalled);
    state.failed[i] = open && closing && state.negative[i] > 0 ? 1 : state.failed[i];
    state.iterations[i] += state.open[i];
    state.last_step[i] = open ? (full ? size : 0) : before;
    state.open[i] = open && !closing && !(state.failed[i] > 0) ? 1 : 0;
  }
}

}  // namespace gaiter::physics
