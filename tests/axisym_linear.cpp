// SPDX-License-Identifier: BSD-2-Clause
// The linear systems of the axisymmetric model when the pattern of its tangent changes under way.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "gaiter/petsc/check.hpp"
#include "gaiter/solvers/axisym_case.hpp"
#include "gaiter/solvers/axisym_solver.hpp"
#include "gaiter/solvers/axisym_start.hpp"
#include "paper_scene.hpp"

namespace {

using namespace gaiter;

class Cone : public testing::Test {
 protected:
  Cone() {
    scene_ = paper::scene(1.4, 0);
    scene_.leg.material = model::LegMaterial::neo_hookean;
    solvers::AxisymMesh mesh = solvers::make_axisym_mesh(scene_, 0, 0, {});
    height_ = mesh.leg().height.back();
    auto space = solvers::AxisymSpace<2>::make(PETSC_COMM_WORLD, mesh, {});
    for (const auto* surface : {&space.tubes[0], &space.leg}) {
      std::vector<double> heights;
      for (const auto& node : surface->nodes) heights.push_back(node.height / height_);
      states_.push_back(solvers::slice_states(scene_, 0, heights, false));
    }
    system_ = std::make_unique<solvers::AxisymSystem<2>>(PETSC_COMM_WORLD, std::move(space),
                                                         solvers::axisym_materials(scene_, 0, 0));
    petsc::check(DMCreateGlobalVector(system_->space().plex.get(), x_.out()));
    start();
  }

  void start() { petsc::check(solvers::set_start<2>(*system_, states_, x_.get())); }

  // The tube slid far along the leg, without a fold: its surface meets edges of the leg that were out of
  // reach.
  void slide() {
    for (const auto& node : system_->space().tubes[0].nodes)
      if (node.u_z >= 0)
        petsc::check(
            VecSetValue(x_.get(), node.u_z, -0.22 * std::sin(M_PI * node.height / height_), INSERT_VALUES));
    petsc::check(VecAssemblyBegin(x_.get()));
    petsc::check(VecAssemblyEnd(x_.get()));
  }

  model::Scene scene_;
  double height_ = 0;
  std::vector<solvers::RadialState> states_;
  std::unique_ptr<solvers::AxisymSystem<2>> system_;
  petsc::Vector x_;
};

// What has been set up for the old pattern must not be used with the new one: on several ranks PETSc 3.18
// does not notice, and MUMPS' interface would write past the end of its copy of the matrix.
TEST_F(Cone, SolvesAfterThePatternHasChanged) {
  solvers::AxisymSolver<2> solver(*system_);
  const solvers::AxisymReport before = solver.solve(x_.get());
  ASSERT_TRUE(before.converged);
  EXPECT_TRUE(before.stable);
  petsc::Vector reference;
  petsc::check(VecDuplicate(x_.get(), reference.out()));
  petsc::check(VecCopy(x_.get(), reference.get()));

  const int pattern = system_->pattern();
  slide();
  solver.try_at(x_.get());
  ASSERT_GT(system_->pattern(), pattern);

  start();
  const solvers::AxisymReport after = solver.solve(x_.get());
  EXPECT_TRUE(after.converged);
  EXPECT_TRUE(after.stable);
  EXPECT_EQ(after.iterations, before.iterations);
  PetscReal change = 0, size = 0;
  petsc::check(VecNorm(reference.get(), NORM_INFINITY, &size));
  petsc::check(VecAXPY(x_.get(), -1, reference.get()));
  petsc::check(VecNorm(x_.get(), NORM_INFINITY, &change));
  EXPECT_LT(change, 1e-9 * size);
}

}  // namespace
