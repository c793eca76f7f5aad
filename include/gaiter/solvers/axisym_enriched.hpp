// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <vector>

#include "gaiter/solvers/axisym_case.hpp"

namespace gaiter::solvers {

// What an output is expected to change by, in the units of AxisymSummary.
struct AxisymChange {
  double pressure = 0, volume = 0;
};

// What the outputs of each segment would change by on a finer mesh, whose cells halve those of the solved
// one, without solving there: the state last found is put on the finer mesh and its residual weighted by the
// dual solutions (AxisymDual). Halved cells, and not a higher order, because contact pressures have one value
// a vertex at every order: with the order raised by one only 1 to 6 % of the pressure's error shows. Empty
// where the dual says nothing: the state is inadmissible or no longer stable on the finer mesh.
//
// Measured at tapers of 2 to 20 degrees, stretch 1.05 to 2.2, 0 and 6 kV, orders 2 and 3, the first two
// meshes, against order 4 refined twice: of errors of the mean pressure above 1e-6 the estimate is 0.28 of
// the error or more, 0.95 in the median. It is too large, up to 17 times, where the vertex nearest to the end
// that lifts off happens to be at the right place. Below 1e-6 it says nothing but that. The output plus the
// change is 3 and 9 times as accurate as the output (medians on the two meshes), but in a sixth of the cases
// less, so that it is not what is reported. @note Collective.
template <int P>
std::vector<AxisymChange> expected_changes(const AxisymCase<P>& solved, AxisymCase<P>& finer);

}  // namespace gaiter::solvers
