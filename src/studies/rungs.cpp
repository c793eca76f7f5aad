// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/rungs.hpp"

#include <fmt/format.h>
#include <petscsys.h>

#include <algorithm>

#include "gaiter/petsc/check.hpp"

namespace gaiter::studies {

namespace {

using model::Fidelity, model::Scene, model::SliceRule, model::SliceSolver;

constexpr int finest_slices = 64, finest_sliding_slices = 192, finest_refinement = 3;

// One that is given holds for all rungs.
bool newton_tolerance_given() {
  PetscBool given = PETSC_FALSE;
  petsc::check(PetscOptionsHasName(nullptr, "slice_", "-snes_rtol", &given));
  return given;
}

std::string short_number(double value) {
  const std::string power = fmt::format("{:.0e}", value);
  return std::stod(power) == value ? power : fmt::format("{:g}", value);
}

class Ladder {
 public:
  explicit Ladder(const Scene& scene) : base_(scene) {
    base_.discretisation = {};
    base_.axisym.scope = model::AxisymScope::segment;
    rigid_ = scene.leg.model == model::LegModel::rigid;
    energised_ = std::ranges::any_of(scene.bandage.modules, [](const auto& m) { return m.voltage != 0; });
  }

  std::vector<Rung> run() {
    slices();
    if (base_.goal.up_to != Fidelity::slice) sliding();
    if (base_.goal.up_to == Fidelity::axisym && !rigid_) finite_elements();
    std::vector<double> accuracies{1e-1, 1e-2, 1e-3, 1e-4, 1e-5};
    if (std::ranges::find(accuracies, base_.goal.accuracy) == accuracies.end())
      accuracies.push_back(base_.goal.accuracy);
    for (const double accuracy : accuracies) {
      Scene& scene = add(fmt::format("auto_{}", short_number(accuracy)), Fidelity::automatic);
      scene.goal.accuracy = accuracy;
      if (rigid_ && scene.goal.up_to == Fidelity::axisym) scene.goal.up_to = Fidelity::sliding;
    }
    finest();
    return std::move(rungs_);
  }

 private:
  Scene& add(std::string name, Fidelity fidelity) {
    rungs_.push_back({std::move(name), base_});
    rungs_.back().scene.fidelity = fidelity;
    return rungs_.back().scene;
  }

  void slices() {
    add("rigid", Fidelity::rigid);
    if (!rigid_) add("first_order", Fidelity::first_order);
    for (const int count : {1, 2, 3, 4, 6, 12})
      add(fmt::format("slices_{}", count), Fidelity::slice).discretisation.slice_count = count;
    for (const int points : {1, 2, 3})
      add(fmt::format("slices_6_wall_{}", points), Fidelity::slice).discretisation.wall_points = points;
    for (const int count : {4, 16, 64}) {
      Scene& scene = add(fmt::format("midpoints_{}", count), Fidelity::slice);
      scene.discretisation.slice_rule = SliceRule::midpoint;
      scene.discretisation.slice_count = count;
    }
    if (!rigid_) cheaper_slices();
  }

  // What spares digits that few need.
  void cheaper_slices() {
    for (const int count : {2, 6}) {
      Scene& scene = add(fmt::format("slices_{}_single", count), Fidelity::slice);
      scene.discretisation.slice_count = count;
      scene.discretisation.slice_precision = model::SlicePrecision::in_single;
    }
    for (const double tolerance : {1e-1, 1e-3, 1e-6})
      if (!newton_tolerance_given())
        add(fmt::format("slices_6_newton_{}", short_number(tolerance)), Fidelity::slice)
            .discretisation.newton_tolerance = tolerance;
    add("slices_6_fixed_point", Fidelity::slice).discretisation.slice_solver = SliceSolver::fixed_point;
  }

  void sliding() {
    for (const int count : {6, 12, 24, 48})
      add(fmt::format("sliding_{}", count), Fidelity::sliding).discretisation.sliding_count = count;
  }

  void finite_elements() {
    for (const int refine : {0, 1, 2})
      add(fmt::format("axisym_{}", refine), Fidelity::axisym).axisym.refine = refine;
    Scene& third = add("axisym_order_3_0", Fidelity::axisym);
    third.axisym.order = 3;
    third.axisym.refine = 0;
    if (energised_) {
      Scene& radial = add("axisym_radial_1", Fidelity::axisym);
      radial.axisym.electrostatics = model::Electrostatics::radial;
      radial.axisym.refine = 1;
    }
  }

  void finest() {
    const Fidelity most = rigid_ ? std::min(base_.goal.up_to, Fidelity::sliding) : base_.goal.up_to;
    Scene& scene = add("finest", most);
    scene.discretisation.slice_count = finest_slices;
    scene.discretisation.sliding_count = finest_sliding_slices;
    scene.axisym.refine = finest_refinement;
  }

  Scene base_;
  bool rigid_, energised_;
  std::vector<Rung> rungs_;
};

}  // namespace

std::vector<Rung> rungs_of(const Scene& scene) {
  return Ladder(scene).run();
}

}  // namespace gaiter::studies
