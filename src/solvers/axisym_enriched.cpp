// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/solvers/axisym_enriched.hpp"

#include "gaiter/petsc/check.hpp"
#include "gaiter/solvers/axisym_dual.hpp"
#include "gaiter/solvers/axisym_prolong.hpp"

namespace gaiter::solvers {

template <int P>
std::vector<AxisymChange> expected_changes(const AxisymCase<P>& solved, AxisymCase<P>& finer) {
  const AxisymSystem<P>& system = solved.system();
  finer.system().energise(system.energised());
  petsc::check(prolongate<P, P>(system, solved.state(), finer.system(), finer.state()));
  AxisymDual<P> dual(finer.system(), finer.solver());
  std::vector<AxisymChange> changes;
  if (!dual.linearise(finer.state())) return changes;
  for (int block = 0; block < static_cast<int>(system.space().tubes.size()); ++block)
    changes.push_back({dual.error(block, AxisymOutput::pressure), dual.error(block, AxisymOutput::volume)});
  return changes;
}

template std::vector<AxisymChange> expected_changes(const AxisymCase<2>&, AxisymCase<2>&);
template std::vector<AxisymChange> expected_changes(const AxisymCase<3>&, AxisymCase<3>&);
template std::vector<AxisymChange> expected_changes(const AxisymCase<4>&, AxisymCase<4>&);

}  // namespace gaiter::solvers
