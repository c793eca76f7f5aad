// SPDX-License-Identifier: BSD-2-Clause
// The same segments give the same bits on any number of ranks, at any place, and beside any others: hard
// ones, slack ones, such without an equilibrium, thick walls, other numbers of layers.
#include <gtest/gtest.h>

#include <cstring>
#include <type_traits>

#include "gaiter/petsc/session.hpp"
#include "gaiter/solvers/sliding_model.hpp"
#include "paper_scene.hpp"

namespace gaiter::solvers {
namespace {

std::vector<model::Scene> scenes() {
  std::vector<model::Scene> all;
  for (int i = 0; i < 30; ++i) {
    all.push_back(paper::scene(0.95 + 0.06 * i, i % 3 == 0 ? 0 : 1e3 * (i % 13)));
    model::Scene& scene = all.back();
    scene.leg.variant = i % 2 == 0 ? model::ComplianceVariant::published : model::ComplianceVariant::anchored;
    scene.bandage.thickness = (0.2 + 0.3 * (i % 5)) * 1e-3;
    scene.bandage.layers = 1 + i % 2;
    scene.contact_axial = i % 7 == 0 ? model::ContactAxial::held : model::ContactAxial::free;
    scene.discretisation.sliding_count = 12;
  }
  return all;
}

bool same(const model::SegmentResult& a, const model::SegmentResult& b) {
  static_assert(std::is_trivially_copyable_v<model::SegmentResult>);
  return std::memcmp(&a, &b, sizeof a) == 0;
}

TEST(SlidingRanks, ResultsDoNotDependOnThem) {
  const std::vector<model::Scene> all = scenes();
  std::vector<SegmentTask> tasks;
  for (const model::Scene& scene : all)
    for (std::size_t segment = 0; segment < scene.leg.segments.size(); ++segment)
      tasks.push_back({&scene, segment});
  const std::size_t rank = petsc::rank(PETSC_COMM_WORLD), ranks = petsc::size(PETSC_COMM_WORLD);

  // Every rank by itself has all of them, backwards; together each has its share, the first rank none of
  // three.
  const std::vector<SegmentTask> backwards(tasks.rbegin(), tasks.rend());
  const auto alone = solve_sliding(PETSC_COMM_SELF, backwards);
  const std::size_t shares = ranks == 3 ? 2 : ranks, place = ranks == 3 ? rank - 1 : rank;
  const std::size_t first = ranks == 3 && rank == 0 ? 0 : tasks.size() * place / shares;
  const std::size_t last = ranks == 3 && rank == 0 ? 0 : tasks.size() * (place + 1) / shares;
  const auto together = solve_sliding(PETSC_COMM_WORLD, std::span(tasks).subspan(first, last - first));
  ASSERT_EQ(together.size(), last - first);
  int statuses = 0;
  for (std::size_t t = first; t < last; ++t) {
    EXPECT_TRUE(same(together[t - first], alone[tasks.size() - 1 - t])) << "task " << t;
    statuses |= 1 << static_cast<int>(together[t - first].status);
  }
  if (ranks == 1) {
    EXPECT_GE(__builtin_popcount(statuses), 4) << "not much of a mixture";
  }
  // By themselves too.
  for (std::size_t t = first; t < last; t += 17)
    EXPECT_TRUE(same(solve_sliding(tasks[t]).result, together[t - first])) << "task " << t;
}

}  // namespace
}  // namespace gaiter::solvers
