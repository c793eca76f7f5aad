// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/axisym_summary.hpp"

#include <algorithm>
#include <array>
#include <cmath>

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

// Integral along a contact surface of integrand(edge, place, radius, height, pressure).
template <int P, typename Integrand>
double integrate(const typename AxisymSystem<P>::SurfaceState& surface, Integrand&& integrand) {
  static const physics::Quadrature rule = physics::gauss_legendre(P + 2);
  double total = 0;
  for (std::size_t edge = 0; P * edge + P < surface.radius.size(); ++edge)
    for (std::size_t g = 0; g < rule.nodes.size(); ++g) {
      const double x = rule.nodes[g];
      const double pressure = (1 - x) * surface.multiplier[P * edge] + x * surface.multiplier[P * (edge + 1)];
      total += rule.weights[g] *
               integrand(edge, x, at<P>(surface.radius, edge, x), at<P>(surface.height, edge, x), pressure);
    }
  return total;
}

// Eq. (8) and the field at the inner faces of the layers, the wall thinned by its axial stretch as well.
template <int P>
void add_actuation(const model::Bandage& bandage, const AxisymSystem<P>& system, double height,
                   AxisymSummary& sum) {
  const auto& nodes = system.space().tubes[0].nodes;
  std::vector<double> reference;
  for (const SurfaceNode& node : nodes) reference.push_back(node.height);
  const double A = nodes[0].radius, wall = bandage.thickness / system.space().mesh.length;
  const double strength = system.materials().tube.permittivity;
  const auto pressure = [&](std::size_t edge, double x, Pair r, Pair z, double) {
    const double axial = z[1] / at<P>(reference, edge, x)[1];
    double total = 0;
    for (int k = 0; k < bandage.layers; ++k) {
      const double inner = A + wall * k / bandage.layers, outer = A + wall * (k + 1) / bandage.layers;
      const double low = r[0] * r[0] + (inner - A) * (inner + A) / axial;
      const double high = r[0] * r[0] + (outer - A) * (outer + A) / axial;
      const double q = (high - low) / low, log_q = std::log1p(q);
      total += 2 * strength * q / (high * log_q * log_q);
      sum.field = std::max(sum.field, 2 / (std::sqrt(low) * log_q));
    }
    return total * z[1];
  };
  sum.maxwell = integrate<P>(system.tubes()[0], pressure) / height;
}

}  // namespace

template <int P>
AxisymSummary summarise_axisym(const model::Scene& scene, std::size_t segment, const AxisymSystem<P>& system,
                               bool energised) {
  AxisymSummary sum;
  sum.converged = true;
  const AxisymSpace<P>& space = system.space();
  const model::Segment& piece = scene.leg.segments[segment];
  const model::Module& module = scene.bandage.modules[segment];
  const auto &tube = system.tubes()[0], &leg = system.leg();
  const auto& carrier = space.choice.multipliers_on_tube ? tube : leg;
  const double height = piece.height / space.mesh.length;
  const auto mean_radius = [](std::size_t, double, Pair r, Pair z, double) { return r[0] * z[1]; };

  sum.pressure =
      integrate<P>(carrier, [](std::size_t, double, Pair, Pair z, double p) { return p * z[1]; }) / height;
  const double force = integrate<P>(carrier, [](std::size_t, double, Pair r, Pair z, double p) {
    return p * r[0] * std::hypot(r[1], z[1]);
  });
  const double face = integrate<P>(
      tube, [](std::size_t, double, Pair r, Pair z, double) { return r[0] * std::hypot(r[1], z[1]); });
  sum.pressure_area = force / face;
  sum.volume = integrate<P>(
      leg, [](std::size_t, double, Pair r, Pair z, double) { return M_PI * r[0] * r[0] * z[1]; });
  sum.radius = integrate<P>(leg, mean_radius) / height;
  const double reference =
      (module.length > 0 ? module.length / (2 * M_PI) : piece.mean_radius() / module.stretch) /
      space.mesh.length;
  sum.stretch = integrate<P>(tube, mean_radius) / height / reference;
  const auto& nodes = space.tubes[0].nodes;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    sum.slip = std::max(sum.slip, std::fabs(tube.height[i] - nodes[i].height));
  std::size_t vertices = 0, active = 0;
  for (std::size_t i = 0; i < carrier.active.size(); i += P, ++vertices) {
    active += carrier.active[i];
    const double place = carrier.height[i] / height;
    if (carrier.active[i] && place > end_zone && place < 1 - end_zone)
      sum.highest_pressure = std::max(sum.highest_pressure, carrier.multiplier[i]);
  }
  sum.open_somewhere = active < vertices;
  sum.open_everywhere = active == 0;
  if (energised) add_actuation(scene.bandage, system, height, sum);
  return sum;
}

template AxisymSummary summarise_axisym<2>(const model::Scene&, std::size_t, const AxisymSystem<2>&, bool);
template AxisymSummary summarise_axisym<3>(const model::Scene&, std::size_t, const AxisymSystem<3>&, bool);
template AxisymSummary summarise_axisym<4>(const model::Scene&, std::size_t, const AxisymSystem<4>&, bool);

}  // namespace gaiter::solvers
