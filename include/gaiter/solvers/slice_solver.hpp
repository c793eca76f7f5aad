// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <functional>
#include <vector>

#include "gaiter/model/scene.hpp"
#include "gaiter/physics/slice_newton.hpp"
#include "gaiter/solvers/batch_solver.hpp"

namespace gaiter::solvers {

// How the slices of all ranks were solved.
struct SliceReport {
  int iterations = 0;   // of the SNES
  double unsolved = 0;  // slices, over all ranks, that were still open at the end
};

// The equilibria of many slices as one SNES over a distributed Vec with blocks (strain, pressure), a slice a
// block. Slices that have converged leave: once most of those in the packs at hand have, the rest are
// gathered into packs of their own, so that a hard slice costs only itself.
//
// Options (prefix slice_): -slice_snes_rtol is the relative error of a slice's pressure at which it closes,
// or earlier, where its state says what it may leave; -slice_snes_max_it bounds the steps; -slice_mat_type
// shell (default: the blocks are inverted as stored) or baij (an assembled matrix, by default with
// point-block Jacobi); every option of SNES, KSP and PC, other line searches and SNES types among them, which
// then damp globally.
class SliceSolver : public BatchSolver {
 public:
  // @note Collective. `packs`: most packs of 64 slices that this rank will ever hand to solve().
  SliceSolver(MPI_Comm comm, std::size_t packs, model::SliceSolver algorithm, double fixed_point_tolerance,
              double newton_tolerance = model::Discretisation{}.newton_tolerance);

  std::size_t packs() const { return packs_; }
  // The options say how exact slices are to be; then none may leave more.
  bool tolerance_given() const { return tolerance_given_; }

  // Sets the iterate of one pack, and its residual and slopes if these are `known`.
  using Start = std::function<void(std::size_t pack)>;
  enum class FirstResidual { evaluated, known };

  // @note Collective. `states`, a pack each, take the solution; they hold the started iterates, or `start`
  // sets them. Slices that are not open stay as they are. The system may have fewer packs than the solver,
  // none too.
  SliceReport solve(
      const physics::SliceSystem& system, std::vector<physics::PackState>& states,
      const Start& start = [](std::size_t) {}, FirstResidual first = FirstResidual::evaluated);

 private:
  // A pack that is worked on: one of the system, or slices gathered from several.
  struct Work {
    const physics::Pack* rows;
    physics::PackState* state;
    std::size_t first;        // its first slice, where the slices are neighbours in the system
    const std::size_t* from;  // else where each of them comes from; null: neighbours
    int count;                // slices; beyond them it repeats the last one

    std::size_t slice(int i) const { return from ? from[i] : first + static_cast<std::size_t>(i); }
  };
  struct Gathered {
    std::vector<physics::Pack> rows;
    std::vector<physics::PackState> states;
    std::vector<std::size_t> from;  // empty: none are gathered
    std::size_t count = 0;          // without the spare places of the last pack
  };

  PetscErrorCode create(MPI_Comm comm, double newton_tolerance);
  PetscErrorCode create_matrix(MPI_Comm comm);
  PetscErrorCode run(const Start& start, FirstResidual first, SliceReport& report);
  void gather_open();
  void put_back();

  PetscErrorCode evaluate(Vec x, Vec f, bool& admissible) override;
  PetscErrorCode assemble(Mat jacobian) override;
  void multiply(const PetscScalar* in, PetscScalar* out) override;
  void invert(const PetscScalar* in, PetscScalar* out) override;
  void step(const PetscScalar* direction, PetscScalar* iterate, PetscScalar* residual,
            Totals& totals) override;
  void close_small_steps(Totals& totals) override;

  std::size_t packs_;
  bool newton_;
  double fixed_point_tolerance_;
  bool tolerance_given_ = false;
  const physics::SliceSystem* system_ = nullptr;
  std::vector<physics::PackState>* states_ = nullptr;
  std::vector<Work> work_;  // packs with open slices
  Gathered gathered_;
};

}  // namespace gaiter::solvers
