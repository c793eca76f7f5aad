// SPDX-License-Identifier: BSD-2-Clause
// The axisymmetric model under voltage against the slices and against itself: cylinders, cones, lift-off, and
// where the branch of stable states ends.
#include <gtest/gtest.h>
#include <petscsys.h>
// Needs what petscsys.h declares.
#include <petscblaslapack.h>

#include <algorithm>
#include <cmath>

#include "axisym_problem.hpp"
#include "gaiter/petsc/session.hpp"
#include "gaiter/physics/axisym_point.hpp"
#include "gaiter/physics/quadrature.hpp"
#include "gaiter/solvers/axisym_model.hpp"
#include "paper_scene.hpp"

namespace gaiter::axisym {
namespace {

using model::Electrostatics;
using model::Status;

constexpr double vacuum_permittivity = 8.8541878128e-12;

model::SegmentResult solve(const model::Scene& scene) {
  const solvers::SegmentTask task{&scene, 0};
  return solvers::solve_axisym(PETSC_COMM_WORLD, {&task, 1})[0];
}

model::SegmentResult slices_of(const model::Scene& scene) {
  const solvers::SegmentTask task{&scene, 0};
  return solvers::solve_segments(PETSC_COMM_SELF, {&task, 1})[0];
}

model::Scene anchored(model::Scene scene) {
  scene.leg.variant = model::ComplianceVariant::anchored;
  scene.leg.segments.resize(1);
  scene.bandage.modules.resize(1);
  scene.fidelity = model::Fidelity::axisym;
  return scene;
}

// Reference radii of the tube's faces.
std::pair<double, double> faces(const model::Scene& scene) {
  const double reference = scene.leg.segments[0].mean_radius() / scene.bandage.modules[0].stretch;
  const double inner =
      scene.bandage.length_at == model::LengthAt::inner ? reference : reference - scene.bandage.thickness;
  return {inner, inner + scene.bandage.thickness};
}

// A cylinder whose stretch is that of the tube's inner face.
model::Scene inner_face(double radius, double stretch, double voltage) {
  model::Scene scene = paper::cylinder(radius, stretch, voltage);
  scene.bandage.length_at = model::LengthAt::inner;
  return scene;
}

// Eq. (8) of each layer in parallel, of a wall whose inner face is at r.
double actuation_pressure(const model::Scene& scene, double r) {
  const model::Bandage& bandage = scene.bandage;
  const double voltage = bandage.modules[0].voltage;
  const auto [A, B] = faces(scene);
  double sum = 0;
  for (int k = 0; k < bandage.layers; ++k) {
    const double inner = A + bandage.thickness * k / bandage.layers;
    const double outer = A + bandage.thickness * (k + 1) / bandage.layers;
    const double a = std::sqrt(r * r + inner * inner - A * A), b = std::sqrt(r * r + outer * outer - A * A);
    sum += vacuum_permittivity * bandage.permittivity * voltage * voltage / 2 * (1 / (a * a) - 1 / (b * b)) /
           std::pow(std::log(b / a), 2);
  }
  return sum;
}

TEST(CylinderUnderVoltage, EqualsTheSlice) {
  for (int layers : {1, 2, 5})
    for (Electrostatics electrostatics : {Electrostatics::field, Electrostatics::radial}) {
      model::Scene scene = anchored(paper::cylinder(39.6e-3, 1.8, 8e3 / layers));
      scene.bandage.layers = layers;
      scene.axisym.electrostatics = electrostatics;
      const auto slice = slices_of(scene), result = solve(scene);
      EXPECT_EQ(result.status, Status::contact);
      EXPECT_GT(slice.actuation_drop, 0.05 * slice.pressure_rest);
      EXPECT_NEAR(result.pressure_actuated, slice.pressure_actuated, 1e-5 * slice.pressure_actuated);
      EXPECT_NEAR(result.volume_actuated, slice.volume_actuated, 1e-6 * slice.volume_actuated);
      EXPECT_NEAR(result.actuation_pressure, actuation_pressure(scene, result.radius_actuated),
                  1e-6 * result.actuation_pressure);
      EXPECT_NEAR(result.electric_field_max, slice.electric_field_max, 1e-6 * slice.electric_field_max);
      EXPECT_EQ(result.voltage_stable, scene.bandage.modules[0].voltage);
    }
}

TEST(ConeUnderVoltage, BothFieldsAgree) {
  struct Case {
    double stretch, voltage;
  };
  for (const Case& of : {Case{1.4, 8e3}, Case{1.8, 6e3}, Case{2.2, 3e3}})
    for (int layers : {1, 3}) {
      model::Scene scene = anchored(paper::scene(of.stretch, of.voltage / layers));
      scene.bandage.layers = layers;
      const auto field = solve(scene);
      scene.axisym.electrostatics = Electrostatics::radial;
      const auto radial = solve(scene);
      EXPECT_TRUE(model::trustworthy(field.status));
      EXPECT_EQ(radial.status, field.status);
      EXPECT_NEAR(radial.pressure_actuated, field.pressure_actuated, 2e-4 * field.pressure_actuated);
      EXPECT_NEAR(radial.actuation_drop, field.actuation_drop, 2e-3 * field.actuation_drop);
      EXPECT_NEAR(radial.volume_actuated, field.volume_actuated, 1e-6 * field.volume_actuated);
    }
}

// The mesh's field at the inner face, extrapolated from the Gauss points of the wall by its fall with the
// radius: the largest away from the ends, and the largest of all.
std::pair<double, double> largest_fields(const model::Scene& scene, int refine) {
  solvers::AxisymResolution resolution;
  resolution.refinements = refine;
  Problem<2> problem(scene, resolution);
  problem.start(scene);
  for (double share : {0.0, 1.0}) {
    problem.system.energise(share);
    EXPECT_TRUE(problem.solver.solve(problem.x.get()).converged);
  }
  using Element = physics::AxisymElement<2>;
  const auto& space = problem.system.space();
  petsc::Vector local;
  petsc::check(DMCreateLocalVector(space.plex.get(), local.out()));
  petsc::check(problem.system.fill_local(problem.x.get(), local.get()));
  const PetscScalar* values = nullptr;
  petsc::check(VecGetArrayRead(local.get(), &values));
  double inside = 0, all = 0;
  for (const auto& cell : space.cells) {
    const solvers::AxisymBlock& block = space.mesh.blocks[cell.block];
    if (!block.tube) continue;
    std::vector<double> u;
    for (PetscInt place : cell.local) u.push_back(values[place]);
    for (int g = 0; g < Element::points; ++g) {
      const auto [rR, rZ, zR, zZ, t] = physics::deformation<2>(cell.geometry, g, u.data());
      const double R = cell.geometry.radius[g], r = R * t, A = block.inner[0];
      double d_R = 0, d_Z = 0;
      double height = block.height[cell.row] +
                      cell.geometry.place[g][1] * (block.height[cell.row + 1] - block.height[cell.row]);
      for (int a = 0; a < Element::nodes; ++a) {
        d_R += cell.geometry.d_R[g][a] * u[Element::tube_unknowns + a];
        d_Z += cell.geometry.d_Z[g][a] * u[Element::tube_unknowns + a];
        height += cell.geometry.over_R[g][a] * R * u[2 * a + 1];
      }
      const double face = std::sqrt(r * r - (R * R - A * A) / std::hypot(rZ, zZ));
      const double field =
          std::hypot(zZ * d_R - zR * d_Z, rR * d_Z - rZ * d_R) / (rR * zZ - rZ * zR) * r / face;
      const double place = height / block.height.back();
      all = std::max(all, field);
      if (place > 0.1 && place < 0.9) inside = std::max(inside, field);
    }
  }
  petsc::check(VecRestoreArrayRead(local.get(), &values));
  const double unit = scene.bandage.modules[0].voltage / space.mesh.length;
  return {inside * unit, all * unit};
}

TEST(ConeUnderVoltage, LargestFieldIsThatOfTheMeshAwayFromTheEnds) {
  for (double stretch : {1.4, 1.8}) {
    model::Scene scene = anchored(paper::scene(stretch, 6e3));
    double last = 0;
    for (int refine : {0, 1, 2}) {
      scene.axisym.refine = refine;
      const auto [inside, all] = largest_fields(scene, refine);
      const double told = solve(scene).electric_field_max;
      std::printf(
          "  stretch %.1f, refined %d: told %.4e, mesh %.4e away from the ends, %.4e with them, slices "
          "%.4e\n",
          stretch, refine, told, inside, all, slices_of(scene).electric_field_max);
      EXPECT_NEAR(told, inside, 6e-3 * inside);
      EXPECT_GT(all, last);  // the ends' singularity
      last = all;
    }
  }
}

// Of a tube that does not touch, on a cylinder: its own radius, at which the field balances its stretch.
double own_stretch(const model::Scene& scene) {
  solvers::AxisymCase<2> problem(PETSC_COMM_SELF, scene, 0, 0, scene.axisym.refine);
  problem.rest();
  const solvers::AxisymSummary found = problem.actuated()[0];
  EXPECT_TRUE(found.converged && found.stable);
  EXPECT_EQ(found.pressure, 0);
  return found.stretch;
}

// Eq. (4) less Eq. (8) vanishes, by bisection.
double balanced_stretch(const model::Scene& scene) {
  const auto [A, B] = faces(scene);
  const auto pressure = [&](double r) {
    const physics::Quadrature rule = physics::gauss_legendre(8);
    double sum = -actuation_pressure(scene, r);
    for (std::size_t g = 0; g < rule.nodes.size(); ++g) {
      const double R = A + rule.nodes[g] * (B - A), rho = std::sqrt(r * r + R * R - A * A), hoop = rho / R;
      for (const auto& term : scene.bandage.ogden)
        sum += rule.weights[g] * (B - A) * R / (rho * rho) * term.mu *
               (std::pow(hoop, term.alpha) - std::pow(hoop, -term.alpha));
    }
    return sum;
  };
  double low = A, high = 1.1 * A;
  for (int k = 0; k < 100; ++k) {
    const double middle = 0.5 * (low + high);
    (pressure(middle) < 0 ? low : high) = middle;
  }
  return low / A;
}

TEST(LiftOff, OnEveryMeshWithTheTubesOwnRadius) {
  for (Electrostatics electrostatics : {Electrostatics::field, Electrostatics::radial})
    for (int refine : {0, 1, 2}) {
      model::Scene scene = anchored(inner_face(39.6e-3, 1.005, 5e3));
      scene.axisym.electrostatics = electrostatics;
      scene.axisym.refine = refine;
      const auto result = solve(scene);
      EXPECT_EQ(result.status, Status::lifted) << "refined " << refine;
      EXPECT_GT(result.pressure_rest, 0);
      EXPECT_EQ(result.pressure_actuated, 0);
      EXPECT_NEAR(result.volume_actuated, result.volume_initial, 1e-12 * result.volume_initial);
      EXPECT_EQ(result.voltage_stable, 5e3);
      EXPECT_NEAR(own_stretch(scene), balanced_stretch(scene), 1e-6);
      EXPECT_EQ(slices_of(scene).status, Status::lifted);
    }
}

TEST(LiftOff, OfATubeWiderThanTheLeg) {
  for (double stretch : {0.7, 0.9, 0.99})
    for (double voltage : {0.0, 3e3})
      for (double upper : {39.6e-3, 43e-3})
        for (int refine : {0, 1, 2}) {
          model::Scene scene = anchored(inner_face(39.6e-3, 1, voltage));
          scene.leg.segments[0].upper_radius = upper;
          scene.discretisation.slice_count = 3;  // exact for the volume of a cone
          scene.bandage.modules[0].stretch =
              stretch * scene.leg.segments[0].mean_radius() / std::max(39.6e-3, upper);
          scene.axisym.refine = refine;
          const auto result = solve(scene);
          EXPECT_EQ(result.status, Status::slack) << stretch << " at " << voltage << " V";
          EXPECT_EQ(result.pressure_rest, 0);
          EXPECT_EQ(result.pressure_actuated, 0);
          EXPECT_NEAR(result.volume_rest, result.volume_initial, 1e-12 * result.volume_initial);
          EXPECT_EQ(result.voltage_stable, voltage);
        }
}

// Eigenvalues of a tangent by LAPACK.
int negative_eigenvalues(Mat matrix) {
  PetscInt size = 0;
  petsc::check(MatGetSize(matrix, &size, nullptr));
  std::vector<PetscScalar> dense(static_cast<std::size_t>(size) * size);
  for (PetscInt row = 0; row < size; ++row) {
    PetscInt count = 0;
    const PetscInt* columns = nullptr;
    const PetscScalar* values = nullptr;
    petsc::check(MatGetRow(matrix, row, &count, &columns, &values));
    for (PetscInt k = 0; k < count; ++k) dense[static_cast<std::size_t>(row) * size + columns[k]] = values[k];
    petsc::check(MatRestoreRow(matrix, row, &count, &columns, &values));
  }
  PetscBLASInt n = static_cast<PetscBLASInt>(size), room = 34 * n, info = 0;
  std::vector<PetscReal> eigenvalues(size);
  std::vector<PetscScalar> work(room);
  LAPACKsyev_("N", "U", &n, dense.data(), &n, eigenvalues.data(), work.data(), &room, &info);
  EXPECT_EQ(info, 0);
  return static_cast<int>(
      std::count_if(eigenvalues.begin(), eigenvalues.end(), [](double v) { return v < 0; }));
}

// On a cylinder the slice is an equilibrium at any voltage; it is stable until the field has used up the
// tension of the tube along its axis.
TEST(Inertia, IsExactWithPotentials) {
  solvers::AxisymResolution resolution;
  resolution.tube_rows = 8;
  resolution.leg_rows = 5;
  resolution.leg_columns = 2;
  for (int layers : {1, 2})
    for (double voltage : {0.0, 4e3, 12e3}) {
      model::Scene scene = anchored(paper::cylinder(39.6e-3, 2.2, std::max(voltage, 1.0) / layers));
      scene.bandage.layers = layers;
      Problem<2> problem(scene, resolution);
      problem.system.energise(voltage > 0 ? 1 : 0);
      problem.start(scene);
      const auto report = problem.solver.solve(problem.x.get());
      ASSERT_TRUE(report.converged) << voltage;
      EXPECT_EQ(report.stable, voltage < 5e3) << voltage;
      const int negative = negative_eigenvalues(problem.system.matrix());
      const int expected = problem.system.space().negative_eigenvalues();
      EXPECT_GT(problem.system.space().potentials, 0);
      if (report.stable)
        EXPECT_EQ(negative, expected) << voltage;
      else
        EXPECT_GT(negative, expected) << voltage;
    }
}

// The paper's ankle, held and free, ends on the way to 11.3 kV: what is known at rest stays.
TEST(StableBranch, EndsAtAVoltageThatIsTold) {
  struct Case {
    model::ContactAxial axial;
    double low, high;
  };
  for (const Case& of :
       {Case{model::ContactAxial::free, 4e3, 5e3}, Case{model::ContactAxial::held, 8e3, 9e3}}) {
    model::Scene scene = anchored(paper::scene(2.2));
    scene.contact_axial = of.axial;
    const auto result = solve(scene);
    EXPECT_EQ(result.status, Status::no_equilibrium);
    EXPECT_GT(result.voltage_stable, of.low);
    EXPECT_LT(result.voltage_stable, of.high);
    EXPECT_TRUE(std::isnan(result.pressure_actuated) && std::isnan(result.volume_change));
    // Within its tolerance the voltage is the last.
    model::Scene below = scene, above = scene;
    below.bandage.modules[0].voltage = 0.97 * result.voltage_stable;
    above.bandage.modules[0].voltage = 1.04 * result.voltage_stable;
    const auto last = solve(below);
    EXPECT_TRUE(model::trustworthy(last.status));
    EXPECT_EQ(last.pressure_rest, result.pressure_rest);
    EXPECT_EQ(last.volume_rest, result.volume_rest);
    EXPECT_EQ(last.voltage_stable, below.bandage.modules[0].voltage);
    EXPECT_EQ(solve(above).status, Status::no_equilibrium);
  }
}

}  // namespace
}  // namespace gaiter::axisym
