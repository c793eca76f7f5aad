// SPDX-License-Identifier: BSD-2-Clause
// Orders of the axisymmetric elements on cylinders that press on a leg which gives way: displacement and
// pressure field of the tube in L2, and contact pressure, over meshes that are halved.
#include "axisym_errors.hpp"
#include "paper_scene.hpp"

namespace gaiter::axisym {
namespace {

// The root of a function that changes its sign between two places.
long double root(long double low, long double high, const std::function<long double(long double)>& f) {
  const bool rises = f(high) > 0;
  for (int k = 0; k < 200; ++k) {
    const long double middle = (low + high) / 2;
    ((f(middle) > 0) == rises ? high : low) = middle;
  }
  return (low + high) / 2;
}

// A neo-Hookean tube on a leg that gives way, fixed length, no friction: each in closed form.
constexpr double leg_radius = 40e-3, tube_shear = 130e3, prestretch = 2.2;
// That of the reference values, and one whose solution is further from polynomials.
constexpr double thin_wall = 1e-3, thick_wall = 6e-3;

// W = m/2 (I1 - 3) - m ln J + L/2 (ln J)^2, m and L in the places of shear and bulk modulus.
physics::Jet<5> logarithmic(const physics::LegMaterialLaw& law, const physics::Deformation<5>& f) {
  const physics::Jet<5> first = f.rR * f.rR + f.rZ * f.rZ + f.zR * f.zR + f.zZ * f.zZ + f.t * f.t;
  const physics::Jet<5> dilation = log(f.volume());
  return (0.5 * law.shear_modulus) * (first - 3.0 - 2.0 * dilation) +
         (0.5 * law.bulk_modulus) * (dilation * dilation);
}

model::Scene coupled_scene(double wall) {
  model::Scene scene = paper::cylinder(leg_radius, prestretch);
  scene.bandage.length_at = model::LengthAt::inner;
  scene.bandage.thickness = wall;
  scene.bandage.ogden = {{tube_shear, 2}};
  scene.leg.variant = model::ComplianceVariant::anchored;
  return scene;
}

// All over the leg's radius and the tube's shear modulus.
struct Tube {
  long double inner = 1 / static_cast<long double>(prestretch), outer;
  long double field = 0;  // permittivity times the square of the voltage
  explicit Tube(double wall, long double strength = 0) : outer(inner + wall / leg_radius), field(strength) {}
  Tube(long double A, long double B, long double strength) : inner(A), outer(B), field(strength) {}

  long double deformed(long double s, long double R) const {
    return std::sqrt(s * s + (R - inner) * (R + inner));
  }
  // Square of the voltage over the logarithm of the deformed radii, times the permittivity: of r^2 E^2.
  long double strength(long double s) const {
    const long double ratio = std::log(deformed(s, outer) / s);
    return field / (ratio * ratio);
  }
  // Pressure that the wall outside of reference radius R bears at leg stretch s (Melnikov and Ogden 2016).
  long double pressure(long double s, long double R) const {
    const long double r = deformed(s, R), outside = deformed(s, outer), a = r / R, b = outside / outer;
    return std::log(a / b) - (1 / (a * a) - 1 / (b * b)) / 2 -
           strength(s) / 2 * (1 / (r * r) - 1 / (outside * outside));
  }
  Exact solution(long double s) const {
    Exact exact;
    exact.leg_stretch = static_cast<double>(s);
    exact.contact = static_cast<double>(pressure(s, inner));
    exact.displacement = [*this, s](double R) { return static_cast<double>(deformed(s, R) - R); };
    // The radial stress, less the elastomer's own mu (R/r)^2 and Maxwell's eps E^2 / 2.
    exact.pressure = [*this, s](double R) {
      const long double r = deformed(s, R), ratio = R / r;
      return static_cast<double>(-pressure(s, R) - ratio * ratio - strength(s) / (2 * r * r));
    };
    exact.potential = [*this, s](double R) {
      return static_cast<double>(std::log(deformed(s, R) / s) / std::log(deformed(s, outer) / s));
    };
    return exact;
  }
  // On a leg that bears core(s) when its radius is s times that of rest.
  Exact solution(const std::function<long double(long double)>& core) const {
    return solution(root(0.5L, 1, [&](long double s) { return pressure(s, inner) - core(s); }));
  }
};

constexpr double log_shear = 20e3 / tube_shear, log_lame = 70e3 / tube_shear;

long double logarithmic_core(long double s) {
  const long double y = s * s;
  return -(log_shear * (y - 1) + log_lame * std::log(y)) / y;
}

solvers::AxisymMaterials logarithmic_materials(const model::Scene& scene) {
  solvers::AxisymMaterials materials = solvers::axisym_materials(scene, 0, 0);
  materials.leg[0].shear_modulus = log_shear;
  materials.leg[0].bulk_modulus = log_lame;
  materials.leg[0].other = logarithmic;
  return materials;
}

TEST(CoupledProblem, HasItsReferenceValues) {
  const Exact exact = Tube(thin_wall).solution(logarithmic_core);
  EXPECT_NEAR(exact.leg_stretch, 0.966156, 0.5e-6);
  EXPECT_NEAR(exact.contact * tube_shear, 6589.48, 0.5e-2);
}

template <int P>
Orders coupled_orders(double wall, model::ContactSide side) {
  model::Scene scene = coupled_scene(wall);
  scene.axisym.multipliers = side;
  std::vector<Errors> meshes;
  for (int k = 0; k < 4; ++k) {
    Problem<P> problem(scene, resolution(k), logarithmic_materials(scene));
    problem.start(leg_radius, 0.05 * tube_shear);
    solve_to_rounding(problem);
    meshes.push_back(
        errors<P>(problem.system.space(), problem.values(), Tube(wall).solution(logarithmic_core)));
  }
  return orders("coupled problem, wall " + std::to_string(1e3 * wall) + " mm, order " + std::to_string(P),
                meshes, 1e-12);
}

class CoupledProblemOf : public testing::TestWithParam<model::ContactSide> {};

// At a wall of 1 mm the higher orders leave no more than rounding of the contact pressure.
TEST_P(CoupledProblemOf, ThinWallsConvergesWithTheElementsOrders) {
  const Orders second = coupled_orders<2>(thin_wall, GetParam());
  expect_orders<2>(second);
  EXPECT_GT(second.contact, 3.7);
  const Orders third = coupled_orders<3>(thin_wall, GetParam());
  expect_orders<3>(third);
  EXPECT_LT(third.coarsest.contact, 1e-11);
  const Orders fourth = coupled_orders<4>(thin_wall, GetParam());
  EXPECT_NEAR(fourth.pressure, 4, 0.1);
  EXPECT_LT(fourth.coarsest.displacement, 1e-11);
  EXPECT_LT(fourth.coarsest.contact, 1e-11);
}

template <int P>
void expect_thick_wall(model::ContactSide side) {
  const Orders fitted = coupled_orders<P>(thick_wall, side);
  expect_orders<P>(fitted);
  // A mean of the solution, and so twice as good.
  if (P < 4) {
    EXPECT_GT(fitted.contact, 2 * P - 0.3);
    EXPECT_GT(fitted.leg, 2 * P - 0.3);
  } else {
    EXPECT_LT(fitted.coarsest.contact, 1e-10);
  }
}

TEST_P(CoupledProblemOf, ThickWallsConvergesWithTheElementsOrders) {
  expect_thick_wall<2>(GetParam());
  expect_thick_wall<3>(GetParam());
  expect_thick_wall<4>(GetParam());
}

INSTANTIATE_TEST_SUITE_P(Multipliers, CoupledProblemOf,
                         testing::Values(model::ContactSide::tube, model::ContactSide::leg),
                         [](const auto& of) {
                           return of.param == model::ContactSide::tube ? "on_tube" : "on_leg";
                         });

// The reference values of Melnikov and Ogden's tube: pressure without voltage, and the voltage that takes it
// away, of stretches of the inner face. On the mesh, lifted off a leg that it would not touch otherwise.
struct FreeTube {
  double outer, stretch, pressure,
      voltage;  // over inner radius, shear modulus, and its root over permittivity
};
constexpr FreeTube free_tubes[] = {{2, 1.5, 0.428228, 0.777981},
                                   {2, 2, 0.574054, 0.915945},
                                   {1.1, 1.5, 0.074407, 0.088361},
                                   {1.05, 2.2, 0.046539, 0.048837}};

TEST(TubeWithVoltage, HasItsReferenceValues) {
  for (const FreeTube& tube : free_tubes) {
    EXPECT_NEAR(Tube(1, tube.outer, 0).pressure(tube.stretch, 1), tube.pressure, 0.5e-6);
    const double left = Tube(1, tube.outer, tube.voltage * tube.voltage).pressure(tube.stretch, 1);
    // Of half a unit of the voltage's last digit, with both roundings.
    EXPECT_NEAR(left, 0, 2e-6 / tube.voltage * tube.pressure);
  }
}

// A voltage, over the square root of the shear modulus over the permittivity, in V.
double volts(const model::Scene& scene, double voltage, double length) {
  return voltage * length * std::sqrt(tube_shear / (8.8541878128e-12 * scene.bandage.permittivity));
}

// Without friction these equilibria are not stable, as the field compresses the tube along its axis: what is
// looked at is the balance of forces alone.
template <int P>
Orders free_tube_orders(const FreeTube& of, int meshes) {
  constexpr double slack = 1.05;
  const double inner = slack * leg_radius;
  model::Scene scene = paper::cylinder(leg_radius, 1 / slack);
  scene.bandage.length_at = model::LengthAt::inner;
  scene.bandage.thickness = (of.outer - 1) * inner;
  scene.bandage.ogden = {{tube_shear, 2}};
  scene.leg.variant = model::ComplianceVariant::anchored;
  scene.bandage.modules[0].voltage = volts(scene, of.voltage, inner);
  const long double strength = std::pow(of.voltage * slack, 2.0L);
  const Tube tube(slack, slack * of.outer, strength);
  const long double s = root(slack * (of.stretch - 0.01L), slack * (of.stretch + 0.01L),
                             [&](long double at) { return tube.pressure(at, tube.inner); });
  EXPECT_NEAR(s / slack, of.stretch, 3e-4);  // of the reference's digits, where the pressure is flat
  Exact exact = tube.solution(s);
  exact.contact = 0;
  exact.leg_stretch = 1;
  std::vector<Errors> errors_of;
  for (int k = 0; k < meshes; ++k) {
    Problem<P> problem(scene, resolution(k));
    problem.system.energise(1);
    problem.start(slack * leg_radius * of.stretch, 0);
    // From further away than one solve has steps for.
    solvers::AxisymReport report;
    for (int solve = 0; solve < 5 && !(report.converged && report.iterations == 1); ++solve)
      report = problem.solver.solve(problem.x.get());
    EXPECT_TRUE(report.converged);
    errors_of.push_back(errors<P>(problem.system.space(), problem.values(), exact));
    EXPECT_LT(errors_of.back().contact, 1e-20);
    EXPECT_LT(errors_of.back().leg, 1e-14);
  }
  return orders("free tube with voltage, B/A " + std::to_string(of.outer) + ", order " + std::to_string(P),
                errors_of, 1e-12);
}

TEST(TubeWithVoltage, HoldsItselfOpenOnEveryMesh) {
  for (const FreeTube& tube : free_tubes) {
    const Orders second = free_tube_orders<2>(tube, 4), third = free_tube_orders<3>(tube, 4);
    for (const auto& [order, found] : {std::pair{2, second}, std::pair{3, third}}) {
      EXPECT_NEAR(found.displacement, order + 1, 0.2);
      EXPECT_NEAR(found.pressure, order, 0.2);
      EXPECT_NEAR(found.potential, order + 1, 0.2);
    }
  }
}

// On the leg that gives way, under a voltage that takes about a tenth of the pressure away.
template <int P>
Orders actuated_orders(double wall, double voltage, model::ContactSide side) {
  model::Scene scene = coupled_scene(wall);
  scene.axisym.multipliers = side;
  scene.bandage.modules[0].voltage = volts(scene, voltage, leg_radius);
  const Tube tube(wall, std::pow(static_cast<long double>(voltage), 2));
  const Exact exact = tube.solution(logarithmic_core);
  EXPECT_LT(exact.contact, 0.93 * Tube(wall).solution(logarithmic_core).contact);
  std::vector<Errors> meshes;
  for (int k = 0; k < 4; ++k) {
    Problem<P> problem(scene, resolution(k), logarithmic_materials(scene));
    problem.system.energise(1);
    problem.start(leg_radius, 0.05 * tube_shear);
    solve_to_rounding(problem);
    meshes.push_back(errors<P>(problem.system.space(), problem.values(), exact));
  }
  return orders(
      "coupled problem with voltage, wall " + std::to_string(1e3 * wall) + " mm, order " + std::to_string(P),
      meshes, 1e-12);
}

TEST_P(CoupledProblemOf, VoltageConvergesWithTheElementsOrders) {
  for (double wall : {thin_wall, thick_wall}) {
    const double voltage = wall == thin_wall ? 0.0085 : 0.055;
    const Orders second = actuated_orders<2>(wall, voltage, GetParam());
    expect_orders<2>(second);
    EXPECT_NEAR(second.potential, 3, 0.15);
    EXPECT_GT(second.contact, 3.7);
    const Orders third = actuated_orders<3>(wall, voltage, GetParam());
    expect_orders<3>(third);
    EXPECT_NEAR(third.potential, 4, 0.15);
  }
}

// The same tube on the program's own legs.
TEST(CoupledProblem, HoldsOnTheProgramsLegs) {
  for (auto material : {model::LegMaterial::neo_hookean, model::LegMaterial::compliance}) {
    model::Scene scene = coupled_scene(thin_wall);
    scene.leg.material = material;
    const physics::LegMaterialLaw law = physics::leg_material(scene.leg, scene.leg.segments[0]);
    const auto strain_of = [&](long double pressure) {
      return law.a * std::exp(law.b * pressure) + law.c * std::exp(law.d * pressure);
    };
    const Exact exact = Tube(thin_wall).solution([&](long double s) -> long double {
      const long double y = s * s;
      const long double pressure =
          material == model::LegMaterial::neo_hookean
              ? (1 - y) * (law.bulk_modulus + law.shear_modulus / 3 * std::pow(y, -5.0L / 3))
              : root(0, 1e5L, [&](long double p) { return strain_of(p) - (1 - s); });
      return pressure / tube_shear;
    });
    Problem<3> problem(scene, resolution(1));
    problem.start(scene);
    solve_to_rounding(problem);
    const Errors error = errors<3>(problem.system.space(), problem.values(), exact);
    EXPECT_LT(error.contact, 1e-11);
    EXPECT_LT(error.leg, 1e-11);
    EXPECT_LT(error.displacement, 1e-10);
  }
}

}  // namespace
}  // namespace gaiter::axisym
