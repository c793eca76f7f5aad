// SPDX-License-Identifier: BSD-2-Clause
// Orders of the axisymmetric elements on Lame's press fit: displacement and pressure field of
// the tube in L2, and contact pressure, over meshes that are halved.
#include "axisym_errors.hpp"
#include "paper_scene.hpp"

namespace gaiter::axisym {
namespace {

// Lame's press fit of two linear cylinders, plane strain: the limit of small interference.
struct PressFit {
  static constexpr double inner = 40e-3, leg_young = 1e5, tube_young = 1e6, poisson = 0.3;
  double outer;

  explicit PressFit(double wall) : outer(inner + wall) {}

  // The elastomer's tube of this interference over the radius.
  model::Scene scene(double interference) const {
    model::Scene scene = paper::cylinder(inner, 1 / (1 - interference));
    scene.bandage.length_at = model::LengthAt::inner;
    scene.bandage.thickness = outer - inner;
    scene.bandage.ogden = {{tube_young / (2 * (1 + poisson)), 2}};
    scene.bandage.bulk_modulus = tube_young / (3 * (1 - 2 * poisson));
    scene.leg.material = model::LegMaterial::neo_hookean;
    scene.leg.young_modulus = leg_young;
    scene.leg.poisson_ratio = poisson;
    return scene;
  }
  // Contact pressure over interference / inner [Pa].
  double pressure() const {
    const double square = outer * outer - inner * inner;
    return 1 / ((1 + poisson) * (1 - 2 * poisson) / leg_young +
                (1 + poisson) * ((1 - 2 * poisson) * inner * inner + outer * outer) / (tube_young * square));
  }
  // Fields over interference / inner.
  Exact solution() const {
    const double stress = tube_young / (2 * (1 + poisson));
    const double pull =
        pressure() * inner * inner / (outer * outer - inner * inner) * (1 + poisson) / tube_young;
    const double b = outer / inner;
    Exact exact;
    exact.contact = pressure() / stress;
    exact.leg_stretch = 1 - pressure() * (1 + poisson) * (1 - 2 * poisson) / leg_young;
    exact.displacement = [=](double R) { return pull * ((1 - 2 * poisson) * R + b * b / R); };
    // Bulk modulus, less the stabilisation, times the dilation.
    const double bulk = scene(0).bandage.bulk_modulus / stress;
    exact.pressure = [=](double) { return (bulk - 1) * 2 * pull * (1 - 2 * poisson); };
    return exact;
  }
};

// Unknowns over interference / inner, extrapolated to none: the solution of the linear problem.
template <int P>
std::vector<double> linear_limit(const PressFit& fit, int refinements) {
  const std::vector<double> interference{8e-3, 4e-3, 2e-3, 1e-3, 5e-4};  // over the radius
  std::vector<double> limit;
  for (double at : interference) {
    Problem<P> problem(fit.scene(at), resolution(refinements));
    problem.start(PressFit::inner, at * fit.pressure());
    solve_to_rounding(problem);
    double weight = 1 / at;  // of the polynomial through all, at 0
    for (double other : interference)
      if (other != at) weight *= other / (other - at);
    const std::vector<double> values = problem.values();
    limit.resize(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) limit[i] += weight * values[i];
  }
  return limit;
}

template <int P>
Orders press_fit_orders(double wall, int count) {
  const PressFit fit(wall);
  std::vector<Errors> meshes;
  for (int k = 0; k < count; ++k) {
    // The limit's own mesh.
    const Problem<P> problem(fit.scene(0), resolution(k));
    meshes.push_back(errors<P>(problem.system.space(), linear_limit<P>(fit, k), fit.solution()));
  }
  return orders("Lame's press fit, wall " + std::to_string(1e3 * wall) + " mm, order " + std::to_string(P),
                meshes, 2e-10);
}

TEST(PressFit, HasItsReferenceValue) {
  EXPECT_NEAR(PressFit(1e-3).pressure() * 0.04e-3 / PressFit::inner, 23.5568, 0.5e-4);
}

TEST(PressFit, ConvergesWithTheElementsOrders) {
  for (double wall : {1e-3, 6e-3}) {
    const Orders second = press_fit_orders<2>(wall, 4);
    EXPECT_NEAR(second.displacement, 3, 0.15);
    EXPECT_GT(second.pressure, 1.9);  // 3, as the field is constant
    EXPECT_GT(second.contact, 3.7);
  }
  const Orders third = press_fit_orders<3>(6e-3, 4);
  EXPECT_NEAR(third.displacement, 4, 0.15);
  EXPECT_GT(third.pressure, 2.9);
  EXPECT_GT(third.contact, 5.3);
  // The reference value, to what extrapolation and rounding leave.
  const Errors coarsest = press_fit_orders<3>(1e-3, 1).coarsest;
  EXPECT_LT(coarsest.contact, 1e-10);
  EXPECT_LT(coarsest.leg, 1e-10);
}

}  // namespace
}  // namespace gaiter::axisym
