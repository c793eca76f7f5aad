// SPDX-License-Identifier: BSD-2-Clause
// Fields taken from a system of several segments, tubes and one leg, at states of which all is known.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "gaiter/petsc/check.hpp"
#include "gaiter/petsc/session.hpp"
#include "gaiter/solvers/axisym_fields.hpp"
#include "paper_scene.hpp"

namespace {

using namespace gaiter;

constexpr double stress_unit = 2e4;  // [Pa]
constexpr double swelling = 0.01;    // u_r / R
constexpr std::size_t segments = 3;

model::Scene leg_scene() {
  model::Scene scene = paper::scene(1.8, 0);
  scene.leg.material = model::LegMaterial::neo_hookean;
  return scene;
}

solvers::AxisymMaterials materials(const model::Scene& scene) {
  solvers::AxisymMaterials result;
  result.stress = stress_unit;
  for (const model::Segment& segment : scene.leg.segments) {
    result.tubes.emplace_back().ogden = {{130e3 / stress_unit, 2}};
    result.leg.push_back(physics::leg_material(scene.leg, segment));
    result.leg.back().shear_modulus /= stress_unit;
    result.leg.back().bulk_modulus /= stress_unit;
  }
  return result;
}

double pressure_at(double height) {  // a made-up profile that piecewise linear multipliers hold [Pa, m]
  return 1000 + 2e4 * height;
}

// Both bodies swollen, pressures of the tubes zero, multipliers as pressure_at says.
template <int P>
void set_state(const solvers::AxisymSpace<P>& space, Vec x) {
  petsc::check(VecSet(x, 0));
  petsc::check(VecSetOption(x, VEC_IGNORE_NEGATIVE_INDICES, PETSC_TRUE));
  for (const auto& cell : space.cells)
    for (int n = 0; n < physics::AxisymElement<P>::nodes; ++n)
      petsc::check(
          VecSetValue(x, cell.global[2 * n], swelling * cell.geometry.position[n][0], INSERT_VALUES));
  const auto press = [&](const solvers::ContactSurface& surface) {
    for (const auto& node : surface.nodes)
      petsc::check(VecSetValue(x, node.multiplier, pressure_at(node.height * space.mesh.length) / stress_unit,
                               INSERT_VALUES));
  };
  for (const auto& tube : space.tubes) press(tube);
  press(space.leg);
  petsc::check(VecAssemblyBegin(x));
  petsc::check(VecAssemblyEnd(x));
}

template <int P>
void check_swollen_bodies(bool multipliers_on_tube) {
  const model::Scene scene = leg_scene();
  auto mesh = solvers::make_axisym_mesh(scene, 0, segments - 1, {});
  const double length = mesh.length;
  solvers::AxisymSystem<P> system(
      PETSC_COMM_WORLD,
      solvers::AxisymSpace<P>::make(PETSC_COMM_WORLD, std::move(mesh), {multipliers_on_tube}),
      materials(scene));
  petsc::Vector x, residual;
  petsc::check(DMCreateGlobalVector(system.space().plex.get(), x.out()));
  petsc::check(VecDuplicate(x.get(), residual.out()));
  set_state<P>(system.space(), x.get());
  bool admissible = false;
  petsc::check(system.evaluate(x.get(), residual.get(), admissible));
  ASSERT_TRUE(admissible);
  const solvers::AxisymFields fields = solvers::extract_fields(system, x.get());
  EXPECT_EQ(fields.first_segment, 0u);
  EXPECT_EQ(fields.last_segment, segments - 1);
  if (petsc::rank(PETSC_COMM_WORLD) > 0) {
    EXPECT_TRUE(fields.position.empty());
    EXPECT_TRUE(fields.cells.empty());
    return;
  }
  // 12 rows of 1 column a tube, 10 of 5 for the leg of a segment; each its own points.
  constexpr std::size_t side = (P + 1) * (P + 1);
  const std::size_t points = segments * ((12 * P + 1) * (P + 1) + (10 * P + 1) * (5 * P + 1));
  ASSERT_EQ(fields.position.size(), 2 * points);
  ASSERT_EQ(fields.displacement.size(), 2 * points);
  ASSERT_EQ(fields.stress.size(), 4 * points);
  ASSERT_EQ(fields.contact_pressure.size(), points);
  ASSERT_EQ(fields.tube.size(), segments * (12 + 50));
  ASSERT_EQ(fields.cells.size(), fields.tube.size() * side);

  const double ratio = 1 + swelling, volume = ratio * ratio;
  const double young = scene.leg.young_modulus, poisson = scene.leg.poisson_ratio;
  const double G = young / (2 * (1 + poisson)), K = young / (3 * (1 - 2 * poisson));
  const auto leg_stress = [&](double stretch) {  // of W = G/2 (J^{-2/3} I1 - 3) + K/2 (J - 1)^2
    return G * std::pow(volume, -5.0 / 3) * (stretch * stretch - (2 * ratio * ratio + 1) / 3) +
           K * (volume - 1);
  };
  const auto tube_stress = [&](double stretch) { return 130e3 * stretch * stretch / volume; };
  std::set<std::int64_t> seen, pressed;
  for (std::size_t c = 0; c < fields.tube.size(); ++c) {
    const std::size_t s = fields.segment[c];
    for (std::size_t k = 0; k < side; ++k) {
      const std::int64_t point = fields.cells[c * side + k];
      seen.insert(point);
      const double r = fields.position[2 * point], z = fields.position[2 * point + 1];
      EXPECT_NEAR(fields.displacement[2 * point], r - r / ratio, 1e-12);
      EXPECT_NEAR(fields.displacement[2 * point + 1], 0, 1e-15);
      const double bottom = 35e-3 * static_cast<double>(s);
      EXPECT_GE(z, bottom - 1e-12);
      EXPECT_LE(z, bottom + 35e-3 + 1e-12);
      const double* stress = &fields.stress[4 * point];
      const auto exact = [&](double stretch) {
        return fields.tube[c] ? tube_stress(stretch) : leg_stress(stretch);
      };
      EXPECT_NEAR(stress[0], exact(ratio), 1e-6);
      EXPECT_NEAR(stress[1], exact(1), 1e-6);
      EXPECT_NEAR(stress[2], 0, 1e-6);
      EXPECT_NEAR(stress[3], exact(ratio), 1e-6);
      const auto& space = system.space();
      const double R = r / ratio, place = (z - bottom) / 35e-3;
      const model::Segment& segment = scene.leg.segments[s];
      const double skin = segment.lower_radius + place * (segment.upper_radius - segment.lower_radius);
      const double facing = fields.tube[c] ? space.mesh.blocks[s].inner[0] * length : skin;
      if (std::fabs(R - facing) < 1e-10) {
        pressed.insert(point);
        EXPECT_NEAR(fields.contact_pressure[point], pressure_at(z), 1e-8);
      } else {
        EXPECT_EQ(fields.contact_pressure[point], 0);
      }
    }
  }
  EXPECT_EQ(seen.size(), points);
  EXPECT_EQ(pressed.size(), segments * (12 * P + 1 + 10 * P + 1));
}

TEST(Fields, OfSwollenBodiesOnSeveralSegments) {
  for (bool multipliers_on_tube : {true, false}) {
    check_swollen_bodies<2>(multipliers_on_tube);
    check_swollen_bodies<3>(multipliers_on_tube);
    check_swollen_bodies<4>(multipliers_on_tube);
  }
}

}  // namespace
