// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/axisym_summary.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "gaiter/petsc/check.hpp"
#include "gaiter/petsc/session.hpp"
#include "gaiter/physics/quadrature.hpp"

namespace gaiter::solvers {

namespace {

constexpr double end_zone =
    0.1;  // of the height, at either end, where pressures are not looked at one by one

using Pair = std::array<double, 2>;  // value, and slope along an edge

// A nodal quantity at a place of an edge.
template <int P>
Pair at(const std::vector<double>& values, std::size_t edge, double place) {
  const auto& c = physics::lagrange_coefficients<P>();
  double value = 0, slope = 0;
  for (int k = P; k >= 0; --k) {
    double coefficient = 0;
    for (int i = 0; i <= P; ++i) coefficient += c[i][k] * values[P * edge + i];
    slope = slope * place + value;
    value = value * place + coefficient;
  }
  return {value, slope};
}

// Part of a contact surface: some of its edges, and of these what lies between two current heights.
struct Part {
  std::size_t first_edge = 0, last_edge = 0;  // the last is not in it any more
  double bottom = -INFINITY, top = INFINITY;
};

// The place on an edge of a height, 0 or 1 for heights beyond its ends.
template <int P>
double place_of(const std::vector<double>& heights, std::size_t edge, double height) {
  if (height <= heights[P * edge]) return 0;
  if (height >= heights[P * (edge + 1)]) return 1;
  double low = 0, high = 1;
  while (high - low > 1e-15) {
    const double middle = 0.5 * (low + high);
    (at<P>(heights, edge, middle)[0] < height ? low : high) = middle;
  }
  return low;
}

// Integral along part of a contact surface of integrand(edge, place, radius, height, pressure).
template <int P, typename Integrand>
double integrate(const typename AxisymSystem<P>::SurfaceState& surface, const Part& part,
                 Integrand&& integrand) {
  static const physics::Quadrature rule = physics::gauss_legendre(P + 2);
  double total = 0;
  for (std::size_t edge = part.first_edge; edge < part.last_edge; ++edge) {
    const double low = place_of<P>(surface.height, edge, part.bottom),
                 high = place_of<P>(surface.height, edge, part.top);
    for (std::size_t g = 0; g < rule.nodes.size() && high > low; ++g) {
      const double x = low + rule.nodes[g] * (high - low);
      const double pressure = (1 - x) * surface.multiplier[P * edge] + x * surface.multiplier[P * (edge + 1)];
      total += rule.weights[g] * (high - low) *
               integrand(edge, x, at<P>(surface.radius, edge, x), at<P>(surface.height, edge, x), pressure);
    }
  }
  return total;
}

// Eq. (8), and away from the ends the field at the inner faces of the layers, the wall thinned by its stretch
// along the taper as well. The mesh's own field is the same there to half a percent
// (tests/axisym_voltage.cpp), but at the ends of the electrodes it has a singularity that grows with
// refinement.
template <int P>
void add_actuation(const model::Bandage& bandage, const AxisymSystem<P>& system, int block, const Part& face,
                   double height, AxisymSummary& sum) {
  const auto& nodes = system.space().tubes[block].nodes;
  std::vector<double> reference;
  for (const SurfaceNode& node : nodes) reference.push_back(node.height);
  const double A = nodes[0].radius, wall = bandage.thickness / system.space().mesh.length;
  const double strength = system.materials().tubes[block].permittivity;
  const auto pressure = [&](std::size_t edge, double x, Pair r, Pair z, double) {
    const double along = std::hypot(r[1], z[1]) / at<P>(reference, edge, x)[1];
    const double place = (z[0] - reference.front()) / height;
    double total = 0;
    for (int k = 0; k < bandage.layers; ++k) {
      const double inner = A + wall * k / bandage.layers, outer = A + wall * (k + 1) / bandage.layers;
      const double low = r[0] * r[0] + (inner - A) * (inner + A) / along;
      const double high = r[0] * r[0] + (outer - A) * (outer + A) / along;
      const double q = (high - low) / low, log_q = std::log1p(q);
      total += 2 * strength * q / (high * log_q * log_q);
      if (place > end_zone && place < 1 - end_zone)
        sum.field = std::max(sum.field, 2 / (std::sqrt(low) * log_q));
    }
    return total * z[1];
  };
  sum.maxwell = integrate<P>(system.tubes()[block], face, pressure) / height;
}

}  // namespace

template <int P>
AxisymSummary summarise_axisym(const model::Scene& scene, std::size_t segment, const AxisymSystem<P>& system,
                               int block, bool energised) {
  AxisymSummary sum;
  sum.converged = true;
  const AxisymSpace<P>& space = system.space();
  const AxisymBlock &module_block = space.mesh.blocks[block], &leg_block = space.mesh.leg();
  const model::Segment& piece = scene.leg.segments[segment];
  const model::Module& module = scene.bandage.modules[segment];
  const auto &tube = system.tubes()[block], &leg = system.leg();
  const auto& carrier = space.choice.multipliers_on_tube ? tube : leg;
  const double bottom = module_block.height.front(), top = module_block.height.back(), height = top - bottom;
  const Part face{0, static_cast<std::size_t>(module_block.rows())};
  const Part covered{0, carrier.radius.size() / P, bottom, top};
  const auto [first, last] = std::ranges::equal_range(leg_block.segment, segment);
  const Part flesh{static_cast<std::size_t>(first - leg_block.segment.begin()),
                   static_cast<std::size_t>(last - leg_block.segment.begin())};
  const double flesh_height = leg.height[P * flesh.last_edge] - leg.height[P * flesh.first_edge];
  const auto radius_along = [](std::size_t, double, Pair r, Pair z, double) { return r[0] * z[1]; };

  sum.pressure =
      integrate<P>(carrier, covered, [](std::size_t, double, Pair, Pair z, double p) { return p * z[1]; }) /
      height;
  const double force = integrate<P>(carrier, covered, [](std::size_t, double, Pair r, Pair z, double p) {
    return p * r[0] * std::hypot(r[1], z[1]);
  });
  const double area = integrate<P>(
      tube, face, [](std::size_t, double, Pair r, Pair z, double) { return r[0] * std::hypot(r[1], z[1]); });
  sum.pressure_area = force / area;
  sum.volume = integrate<P>(
      leg, flesh, [](std::size_t, double, Pair r, Pair z, double) { return M_PI * r[0] * r[0] * z[1]; });
  sum.radius = integrate<P>(leg, flesh, radius_along) / flesh_height;
  const double reference =
      (module.length > 0 ? module.length / (2 * M_PI) : piece.mean_radius() / module.stretch) /
      space.mesh.length;
  sum.stretch = integrate<P>(tube, face, radius_along) / height / reference;
  const auto& nodes = space.tubes[block].nodes;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    sum.slip = std::max(sum.slip, std::fabs(tube.height[i] - nodes[i].height));
  std::size_t active = 0;
  for (std::size_t i = 0; i < carrier.active.size(); i += P) {
    const double place = (carrier.height[i] - bottom) / height;
    if (place < 0 || place > 1) continue;
    active += carrier.active[i];
    if (carrier.active[i] && place > end_zone && place < 1 - end_zone)
      sum.highest_pressure = std::max(sum.highest_pressure, carrier.multiplier[i]);
  }
  sum.open_everywhere = active == 0;
  if (sum.open_everywhere) sum.pressure = sum.pressure_area = 0;  // rounding is left in the multipliers
  if (energised) add_actuation(scene.bandage, system, block, face, height, sum);
  return sum;
}

namespace {

// Collects the derivatives of an integral along a surface.
template <int P>
class SurfaceGradient {
 public:
  using State = typename AxisymSystem<P>::SurfaceState;

  SurfaceGradient(const State& state, const ContactSurface& surface) : state_(state), surface_(surface) {}

  // Of the height average of the pressure between two heights.
  PetscErrorCode pressure(const Part& part, double height, Vec gradient) const {
    PetscFunctionBegin;
    for (std::size_t edge = part.first_edge; edge < part.last_edge; ++edge) {
      const double low = place_of<P>(state_.height, edge, part.bottom),
                   high = place_of<P>(state_.height, edge, part.top);
      if (low >= high) continue;
      for (std::size_t g = 0; g < rule().nodes.size(); ++g) {
        const double x = low + rule().nodes[g] * (high - low), weight = rule().weights[g] * (high - low);
        const double slope = at<P>(state_.height, edge, x)[1];
        PetscCall(add(edge, 0, &SurfaceNode::multiplier, weight * (1 - x) * slope / height, gradient));
        PetscCall(add(edge, P, &SurfaceNode::multiplier, weight * x * slope / height, gradient));
        PetscCall(add_nodes(edge, x, &SurfaceNode::u_z, 0, weight * multiplier(edge, x) / height, gradient));
      }
      // The place of a height that cuts the edge moves against the edge.
      if (low > 0)
        PetscCall(add_nodes(edge, low, &SurfaceNode::u_z, multiplier(edge, low) / height, 0, gradient));
      if (high < 1)
        PetscCall(add_nodes(edge, high, &SurfaceNode::u_z, -multiplier(edge, high) / height, 0, gradient));
    }
    PetscFunctionReturn(PETSC_SUCCESS);
  }

  // Of the volume within.
  PetscErrorCode volume(const Part& part, Vec gradient) const {
    PetscFunctionBegin;
    for (std::size_t edge = part.first_edge; edge < part.last_edge; ++edge)
      for (std::size_t g = 0; g < rule().nodes.size(); ++g) {
        const double x = rule().nodes[g], weight = M_PI * rule().weights[g];
        const double radius = at<P>(state_.radius, edge, x)[0], slope = at<P>(state_.height, edge, x)[1];
        PetscCall(add_nodes(edge, x, &SurfaceNode::u_r, 2 * weight * radius * slope, 0, gradient));
        PetscCall(add_nodes(edge, x, &SurfaceNode::u_z, 0, weight * radius * radius, gradient));
      }
    PetscFunctionReturn(PETSC_SUCCESS);
  }

 private:
  static const physics::Quadrature& rule() {
    static const physics::Quadrature rule = physics::gauss_legendre(P + 2);
    return rule;
  }
  double multiplier(std::size_t edge, double x) const {
    return (1 - x) * state_.multiplier[P * edge] + x * state_.multiplier[P * (edge + 1)];
  }
  PetscErrorCode add(std::size_t edge, int node, PetscInt SurfaceNode::*unknown, double value,
                     Vec gradient) const {
    PetscFunctionBegin;
    const PetscInt place = surface_.nodes[P * edge + node].*unknown;
    if (place >= 0) PetscCall(VecSetValue(gradient, place, value, ADD_VALUES));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  // `value` times the nodes' shapes at x, and `slope` times their slopes.
  PetscErrorCode add_nodes(std::size_t edge, double x, PetscInt SurfaceNode::*unknown, double value,
                           double slope, Vec gradient) const {
    PetscFunctionBegin;
    for (int i = 0; i <= P; ++i) {
      std::vector<double> shape(P + 1, 0.0);
      shape[i] = 1;
      const Pair there = at<P>(shape, 0, x);
      PetscCall(add(edge, i, unknown, value * there[0] + slope * there[1], gradient));
    }
    PetscFunctionReturn(PETSC_SUCCESS);
  }

  const State& state_;
  const ContactSurface& surface_;
};

}  // namespace

template <int P>
PetscErrorCode differentiate_output(const AxisymSystem<P>& system, int block, AxisymOutput output,
                                    Vec gradient) {
  PetscFunctionBegin;
  const AxisymSpace<P>& space = system.space();
  const AxisymBlock &tube = space.mesh.blocks[block], &leg = space.mesh.leg();
  PetscCall(VecSet(gradient, 0));
  if (petsc::rank(system.comm()) == 0) {
    const bool on_tube = space.choice.multipliers_on_tube;
    const auto& carrier = on_tube ? system.tubes()[block] : system.leg();
    const double bottom = tube.height.front(), top = tube.height.back();
    const auto [first, last] = std::ranges::equal_range(leg.segment, tube.segment.front());
    if (output == AxisymOutput::pressure)
      PetscCall((SurfaceGradient<P>(carrier, on_tube ? space.tubes[block] : space.leg)
                     .pressure({0, carrier.radius.size() / P, bottom, top}, top - bottom, gradient)));
    else
      PetscCall((SurfaceGradient<P>(system.leg(), space.leg)
                     .volume({static_cast<std::size_t>(first - leg.segment.begin()),
                              static_cast<std::size_t>(last - leg.segment.begin())},
                             gradient)));
  }
  PetscCall(VecAssemblyBegin(gradient));
  PetscCall(VecAssemblyEnd(gradient));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define GAITER_OUTPUT(P) \
  template PetscErrorCode differentiate_output(const AxisymSystem<P>&, int, AxisymOutput, Vec);
GAITER_OUTPUT(2)
GAITER_OUTPUT(3)
GAITER_OUTPUT(4)

template AxisymSummary summarise_axisym<2>(const model::Scene&, std::size_t, const AxisymSystem<2>&, int,
                                           bool);
template AxisymSummary summarise_axisym<3>(const model::Scene&, std::size_t, const AxisymSystem<3>&, int,
                                           bool);
template AxisymSummary summarise_axisym<4>(const model::Scene&, std::size_t, const AxisymSystem<4>&, int,
                                           bool);

}  // namespace gaiter::solvers
