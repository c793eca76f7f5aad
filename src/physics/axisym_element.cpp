// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/axisym_element.hpp"

#include <algorithm>
#include <cmath>

#include "gaiter/physics/axisym_point.hpp"
#include "gaiter/physics/quadrature.hpp"

namespace gaiter::physics {

namespace {

// Values and slopes at x of the Lagrange polynomials.
template <int P>
void lagrange(double x, std::array<double, P + 1>& value, std::array<double, P + 1>& slope) {
  const auto& c = lagrange_coefficients<P>();
  for (int i = 0; i <= P; ++i) {
    value[i] = slope[i] = 0;
    for (int k = P; k >= 0; --k) {
      slope[i] = slope[i] * x + value[i];
      value[i] = value[i] * x + c[i][k];
    }
  }
}

// Legendre polynomials of degree 0 to P - 1 on (-1, 1).
template <int P>
void legendre(double x, std::array<double, P>& value) {
  value[0] = 1;
  if constexpr (P > 1) value[1] = x;
  for (int n = 2; n < P; ++n) value[n] = ((2 * n - 1) * x * value[n - 1] - (n - 1) * value[n - 2]) / n;
}

bool admissible(const std::array<double, components>& f) {
  return f[0] * f[3] - f[1] * f[2] > 0 && f[4] > 0;
}

// Adds one Gauss point's energy jet, times `weight`, to the element.
template <int P, int N>
void scatter(const typename AxisymElement<P>::Geometry& geometry, int point, const Jet<N>& energy,
             double weight, int unknowns, double* residual, double* tangent) {
  constexpr int nodes = AxisymElement<P>::nodes;
  constexpr int pressures = N > components ? AxisymElement<P>::pressures : 0;
  constexpr int potentials = N > components + 1 ? nodes : 0;
  constexpr int first_potential = 2 * nodes + pressures;
  constexpr int most = AxisymElement<P>::charged_unknowns;
  // Derivative of the components with respect to each unknown: at most three are not zero.
  std::array<std::array<double, N>, most> product;  // tangent of the energy times it
  const auto& d_R = geometry.d_R[point];
  const auto& d_Z = geometry.d_Z[point];
  const auto& over_R = geometry.over_R[point];
  std::array<std::array<double, N>, N> second;
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j) second[i][j] = weight * energy.second(i, j);
  for (int a = 0; a < nodes; ++a)
    for (int i = 0; i < N; ++i) {
      product[2 * a][i] = second[i][0] * d_R[a] + second[i][1] * d_Z[a] + second[i][4] * over_R[a];
      product[2 * a + 1][i] = second[i][2] * d_R[a] + second[i][3] * d_Z[a];
    }
  for (int q = 0; q < pressures; ++q)
    for (int i = 0; i < N; ++i)
      product[2 * nodes + q][i] = second[i][components] * geometry.pressure[point][q];
  for (int a = 0; a < potentials; ++a)
    for (int i = 0; i < N; ++i)
      product[first_potential + a][i] = second[i][N - 2] * d_R[a] + second[i][N - 1] * d_Z[a];
  for (int a = 0; a < nodes; ++a) {
    const auto& g = energy.gradient;
    residual[2 * a] += weight * (g[0] * d_R[a] + g[1] * d_Z[a] + g[4] * over_R[a]);
    residual[2 * a + 1] += weight * (g[2] * d_R[a] + g[3] * d_Z[a]);
    double* row_r = tangent + 2 * a * unknowns;
    double* row_z = row_r + unknowns;
    for (int b = 0; b < unknowns; ++b) {
      row_r[b] += product[b][0] * d_R[a] + product[b][1] * d_Z[a] + product[b][4] * over_R[a];
      row_z[b] += product[b][2] * d_R[a] + product[b][3] * d_Z[a];
    }
  }
  for (int q = 0; q < pressures; ++q) {
    residual[2 * nodes + q] += weight * energy.gradient[components] * geometry.pressure[point][q];
    double* row = tangent + (2 * nodes + q) * unknowns;
    for (int b = 0; b < unknowns; ++b) row[b] += product[b][components] * geometry.pressure[point][q];
  }
  for (int a = 0; a < potentials; ++a) {
    residual[first_potential + a] +=
        weight * (energy.gradient[N - 2] * d_R[a] + energy.gradient[N - 1] * d_Z[a]);
    double* row = tangent + (first_potential + a) * unknowns;
    for (int b = 0; b < unknowns; ++b) row[b] += product[b][N - 2] * d_R[a] + product[b][N - 1] * d_Z[a];
  }
}

}  // namespace

template <int P>
typename AxisymElement<P>::Geometry AxisymElement<P>::geometry(
    const std::array<std::array<double, 2>, 4>& corners) {
  static const Quadrature rule = gauss_legendre(P + 1);
  Geometry result;
  const auto corner_weights = [](double x, double y) {
    return std::array<double, 4>{(1 - x) * (1 - y), x * (1 - y), x * y, (1 - x) * y};
  };
  const auto position = [&](double x, double y, int axis) {
    const auto w = corner_weights(x, y);
    double sum = 0;
    for (int k = 0; k < 4; ++k) sum += w[k] * corners[k][axis];
    return sum;
  };
  const auto& lobatto = lobatto_points<P>();
  for (int j = 0; j <= P; ++j)
    for (int i = 0; i <= P; ++i)
      result.position[i + (P + 1) * j] = {position(lobatto[i], lobatto[j], 0),
                                          position(lobatto[i], lobatto[j], 1)};
  for (int gy = 0; gy <= P; ++gy)
    for (int gx = 0; gx <= P; ++gx) {
      const int point = gx + (P + 1) * gy;
      const double x = rule.nodes[gx], y = rule.nodes[gy];
      double jacobian[2][2];  // d(R, Z)/d(x, y)
      for (int axis = 0; axis < 2; ++axis) {
        jacobian[axis][0] =
            (1 - y) * (corners[1][axis] - corners[0][axis]) + y * (corners[2][axis] - corners[3][axis]);
        jacobian[axis][1] =
            (1 - x) * (corners[3][axis] - corners[0][axis]) + x * (corners[2][axis] - corners[1][axis]);
      }
      const double determinant = jacobian[0][0] * jacobian[1][1] - jacobian[0][1] * jacobian[1][0];
      const double radius = position(x, y, 0);
      result.weight[point] = 2 * M_PI * radius * determinant * rule.weights[gx] * rule.weights[gy];
      result.radius[point] = radius;
      result.place[point] = {x, y};
      result.share[point] = rule.weights[gx] * rule.weights[gy];
      std::array<double, P + 1> vx, sx, vy, sy;
      lagrange<P>(x, vx, sx);
      lagrange<P>(y, vy, sy);
      for (int j = 0; j <= P; ++j)
        for (int i = 0; i <= P; ++i) {
          const int a = i + (P + 1) * j;
          const double d_x = sx[i] * vy[j], d_y = vx[i] * sy[j];
          result.d_R[point][a] = (d_x * jacobian[1][1] - d_y * jacobian[1][0]) / determinant;
          result.d_Z[point][a] = (-d_x * jacobian[0][1] + d_y * jacobian[0][0]) / determinant;
          result.over_R[point][a] = vx[i] * vy[j] / radius;
        }
      std::array<double, P> legendre_x, legendre_y;
      legendre<P>(2 * x - 1, legendre_x);
      legendre<P>(2 * y - 1, legendre_y);
      for (int degree = 0, q = 0; degree < P; ++degree)
        for (int k = 0; k <= degree; ++k, ++q)
          result.pressure[point][q] = legendre_x[degree - k] * legendre_y[k];
    }
  return result;
}

template <int P>
bool AxisymElement<P>::tube(const Geometry& geometry, const TubeMaterial& material, const WallField& field,
                            const double* unknowns, double& energy, double* residual, double* tangent) {
  std::fill_n(residual, tube_unknowns, 0.0);
  std::fill_n(tangent, tube_unknowns * tube_unknowns, 0.0);
  energy = 0;
  for (int point = 0; point < points; ++point) {
    const auto f = deformation<P>(geometry, point, unknowns);
    if (!admissible(f)) return false;
    const auto stored = tube_energy_at<P>(geometry, material, field, unknowns, point, f);
    if (!std::isfinite(stored.value)) return false;
    energy += geometry.weight[point] * stored.value;
    scatter<P>(geometry, point, stored, geometry.weight[point], tube_unknowns, residual, tangent);
  }
  return true;
}

template <int P>
bool AxisymElement<P>::charged_tube(const Geometry& geometry, const TubeMaterial& material,
                                    const WallField& field, const double* unknowns, double& energy,
                                    double* residual, double* tangent) {
  std::fill_n(residual, charged_unknowns, 0.0);
  std::fill_n(tangent, charged_unknowns * charged_unknowns, 0.0);
  energy = 0;
  for (int point = 0; point < points; ++point) {
    const auto f = deformation<P>(geometry, point, unknowns);
    if (!admissible(f)) return false;
    const auto stored = charged_tube_energy_at<P>(geometry, material, field, unknowns, point, f);
    if (!std::isfinite(stored.value)) return false;
    energy += geometry.weight[point] * stored.value;
    scatter<P>(geometry, point, stored, geometry.weight[point], charged_unknowns, residual, tangent);
  }
  return true;
}

template <int P>
bool AxisymElement<P>::leg(const Geometry& geometry, const LegMaterialLaw& law, const double* unknowns,
                           double& energy, double* residual, double* tangent) {
  std::fill_n(residual, leg_unknowns, 0.0);
  std::fill_n(tangent, leg_unknowns * leg_unknowns, 0.0);
  energy = 0;
  for (int point = 0; point < points; ++point) {
    const auto f = deformation<P>(geometry, point, unknowns);
    if (!admissible(f)) return false;
    const Jet<components> stored = leg_energy(law, as_jets<components>(f));
    if (!std::isfinite(stored.value)) return false;
    energy += geometry.weight[point] * stored.value;
    scatter<P, components>(geometry, point, stored, geometry.weight[point], leg_unknowns, residual, tangent);
  }
  return true;
}

template struct AxisymElement<2>;
template struct AxisymElement<3>;
template struct AxisymElement<4>;

}  // namespace gaiter::physics
