// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <vector>

#include "gaiter/physics/sliding_kernel.hpp"

// The equilibrium of sliding segments, 64 at a time. A segment of n slices has 2n unknowns, first the slips z
// - Z of the n nodes above the lower end (Gauss-Lobatto nodes of the cubic elements; the last, the upper end,
// and the lower end itself are fixed), then the contact variable of each slice (see SlidingPlace). Equations:
// the energy's derivative by each nodal slip, and e_eps at each slice. A slice's own equation and the inner
// nodes of its element are eliminated on the spot; what is left is one tridiagonal symmetric system a segment
// over the ends of its elements, positive definite where the equilibrium is stable.
namespace gaiter::physics {

// What the energy's derivatives at an iterate leave behind: n packs a field.
struct SlidingTangent {
  std::vector<Pack> z_z, z_zeta, zeta_zeta, z_strain, zeta_strain, strain_slope, strain_stiffness;
  std::vector<Pack> residual;  // 2n, in the order of the unknowns
  std::vector<Pack> advance;   // dz/dZ - 1
  Pack energy, energy_size, admissible;

  explicit SlidingTangent(int slices = 0);
};

struct SlidingState {
  std::vector<Pack> unknown;  // 2n
  SlidingTangent tangent;     // at `unknown`
  SlidingTangent trial;
  std::vector<Pack> trial_unknown;
  Pack negative;   // pivots that were not positive when the tangent was last solved with
  Pack last_step;  // size of the last full Newton step, 0: there was none
  Pack iterations;
  Pack open;    // 1 while the segment is being solved, else 0
  Pack failed;  // 1: the energy falls along no step, or the equilibrium is not stable

  explicit SlidingState(int slices = 0);
};

// The place of slice `slice` (0 .. n - 1) of all segments of a pack at an iterate.
void sliding_place(const SlidingSystem& system, std::size_t pack, const std::vector<Pack>& unknown, int slice,
                   SlidingPlace& place);

// Reference height of a slice, and its share of the height, both over the segment's height.
double slice_height(const SlidingShape& shape, int slice);
double slice_share(const SlidingShape& shape, int slice);

// Not slid, pressures as those of the slices at the same heights; opens all segments.
void start_sliding(const SlidingSystem& system, std::size_t pack, SlidingState& state);

// Energy, residual and tangent at an iterate.
void evaluate_sliding(const SlidingSystem& system, std::size_t pack, const std::vector<Pack>& unknown,
                      SlidingTangent& tangent);

// Whether an equilibrium can be trusted, 1 or 0: whether the energy, the leg's strain eliminated, is convex
// in dz/dZ, at every slice, and between two slices where dz/dZ jumps. Where it is not, no smooth state is a
// minimum: the tube bunches up, the leg under it is squeezed in bands, and how many of them and where this
// model, without bending and shear of the leg, leaves to the mesh.
void judge_sliding(const SlidingSystem& system, std::size_t pack, const SlidingState& state, Pack& trusted);

// Largest |z - Z| of one segment, over A.
double largest_slip(const SlidingShape& shape, const std::vector<Pack>& unknown, int lane);

// y = J x, and x = J^-1 y with pivots that are not positive replaced by their sizes, and counted: then still
// a direction along which the energy falls.
void multiply_sliding(const SlidingSystem& system, std::size_t pack, const SlidingTangent& tangent,
                      const std::vector<Pack>& x, std::vector<Pack>& y);
void solve_sliding_tangent(const SlidingSystem& system, std::size_t pack, const SlidingTangent& tangent,
                           const std::vector<Pack>& y, std::vector<Pack>& x, Pack& negative);

// Size of a Newton step: the largest relative change of dz/dZ, or change of a contact variable in relation to
// the largest of them.
void step_size(const SlidingSystem& system, std::size_t pack, const SlidingState& state,
               const std::vector<Pack>& direction, Pack& size);

// One Newton step, unknown - t direction, of each open segment, and the tangent there. t is the first of 1,
// 0.4, 0.16 .. that keeps the tube from being squeezed or drawn out by more than half and lowers the energy.
// A segment closes when the size of its next step is predicted to be below `tolerance`.
void advance_sliding(const SlidingSystem& system, std::size_t pack, const std::vector<Pack>& direction,
                     double tolerance, SlidingState& state);

}  // namespace gaiter::physics
