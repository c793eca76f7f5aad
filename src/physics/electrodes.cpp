// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/electrodes.hpp"

#include <array>
#include <cmath>

#include "gaiter/physics/quadrature.hpp"

namespace gaiter::physics {

namespace {

// What the energy depends on at a place of the edge: radius and height of either face, and their slopes.
enum Local { inner_r, inner_z, outer_r, outer_z, inner_r_slope, inner_z_slope, outer_r_slope, outer_z_slope };
constexpr int locals = 8;
using LocalJet = Jet<locals>;

LocalJet log1p(const LocalJet& x) {
  const double r = 1 / (1 + x.value);
  return compose(x, std::log1p(x.value), r, -r * r);
}

// Capacitance per permittivity and length of edge, over 2 pi.
LocalJet capacitance(const std::array<double, locals>& at, std::span<const double> shares) {
  std::array<LocalJet, locals> x;
  for (int i = 0; i < locals; ++i) x[i] = LocalJet::variable(at[i], i);
  const LocalJet slope_r = 0.5 * (x[inner_r_slope] + x[outer_r_slope]);
  const LocalJet slope_z = 0.5 * (x[inner_z_slope] + x[outer_z_slope]);
  const LocalJet across_r = x[outer_r] - x[inner_r], across_z = x[outer_z] - x[inner_z];
  const LocalJet area = slope_z * across_r - slope_r * across_z;
  if (!(area.value > 0 && across_r.value > 0 && at[inner_r] > 0)) return LocalJet(NAN);
  const LocalJet inner_square = x[inner_r] * x[inner_r];
  const LocalJet growth = across_r * (x[outer_r] + x[inner_r]);
  LocalJet layers;
  for (std::size_t k = 0; k + 1 < shares.size(); ++k)
    layers +=
        reciprocal(0.5 * log1p((shares[k + 1] - shares[k]) * growth / (inner_square + shares[k] * growth)));
  return (slope_r * slope_r + slope_z * slope_z) * across_r * layers / area;
}

}  // namespace

template <int P>
ElectrodeJet<P> electrode_energy(double permittivity, const ContactEdge<P>& inner,
                                 const ContactEdge<P>& outer, std::span<const double> shares) {
  static const Quadrature rule = gauss_legendre(P + 1);
  const auto& c = lagrange_coefficients<P>();
  ElectrodeJet<P> energy;
  for (std::size_t g = 0; g < rule.nodes.size(); ++g) {
    // Derivative of each local quantity with respect to the node values it is made of.
    std::array<double, P + 1> value{}, slope{};
    for (int i = 0; i <= P; ++i)
      for (int k = P; k >= 0; --k) {
        slope[i] = slope[i] * rule.nodes[g] + value[i];
        value[i] = value[i] * rule.nodes[g] + c[i][k];
      }
    const std::array<const std::array<double, P + 1>*, 4> nodal{&inner.r, &inner.z, &outer.r, &outer.z};
    std::array<double, locals> at{};
    for (int q = 0; q < 4; ++q)
      for (int i = 0; i <= P; ++i) {
        at[q] += value[i] * (*nodal[q])[i];
        at[q + 4] += slope[i] * (*nodal[q])[i];
      }
    const LocalJet local = capacitance(at, shares);
    const double weight = -M_PI * permittivity * rule.weights[g];
    energy.value += weight * local.value;
    for (int p = 0, k = 0; p < ElectrodeJet<P>::size; ++p) {
      const int q = p / (P + 1), i = p % (P + 1);
      energy.gradient[p] += weight * (local.gradient[q] * value[i] + local.gradient[q + 4] * slope[i]);
      for (int o = 0; o <= p; ++o, ++k) {
        const int s = o / (P + 1), j = o % (P + 1);
        energy.hessian[k] +=
            weight * (value[i] * (local.second(q, s) * value[j] + local.second(q, s + 4) * slope[j]) +
                      slope[i] * (local.second(q + 4, s) * value[j] + local.second(q + 4, s + 4) * slope[j]));
      }
    }
  }
  return energy;
}

#define GAITER_ELECTRODES(P)                                                                      \
  template ElectrodeJet<P> electrode_energy(double, const ContactEdge<P>&, const ContactEdge<P>&, \
                                            std::span<const double>);
GAITER_ELECTRODES(2)
GAITER_ELECTRODES(3)
GAITER_ELECTRODES(4)

}  // namespace gaiter::physics
