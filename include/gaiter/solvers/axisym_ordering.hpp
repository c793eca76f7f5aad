// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <petscmat.h>

namespace gaiter::solvers {

// The ordering `saddle_point` of a matrix with rows that constrain others and whose diagonal may be 0: a
// fill-reducing ordering of the free rows, each constraint right after the last free row it couples to. A
// factorisation without pivoting then finds - b' K^-1 b on the constraint's diagonal, not 0.
// For matrices on one rank.
PetscErrorCode register_saddle_point_ordering();

// Marks the constraints of a matrix by their global numbers, for the ordering.
PetscErrorCode set_constraints(Mat matrix, IS constraints);

}  // namespace gaiter::solvers
