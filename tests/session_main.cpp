// SPDX-License-Identifier: BSD-2-Clause
#include <gtest/gtest.h>

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "gaiter/petsc/session.hpp"

namespace {

// What the other ranks print: their failures alone, with the rank's number.
class FailuresOfRank : public testing::EmptyTestEventListener {
 public:
  explicit FailuresOfRank(int rank) : rank_(rank) {}

 private:
  // GoogleTest holds the lock of current_test_info() while it reports a part, so the name is kept from the
  // start.
  void OnTestStart(const testing::TestInfo& test) override {
    test_ = std::string(test.test_suite_name()) + "." + test.name();
  }
  void OnTestPartResult(const testing::TestPartResult& part) override {
    if (!part.failed()) return;
    std::fprintf(stderr, "[rank %d] %s:%d: %s\n%s\n", rank_, part.file_name() ? part.file_name() : "",
                 part.line_number(), test_.c_str(), part.message());
  }

  int rank_;
  std::string test_;
};

}  // namespace

// Main of the test programs that use PETSc: arguments that GoogleTest leaves are PETSc options. The exit code
// is that of the worst rank on all ranks.
int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  gaiter::petsc::Session session(std::vector<std::string>(argv + 1, argv + argc));
  const int rank = gaiter::petsc::rank(PETSC_COMM_WORLD);
  if (rank > 0) {
    testing::TestEventListeners& listeners = testing::UnitTest::GetInstance()->listeners();
    delete listeners.Release(listeners.default_result_printer());
    listeners.Append(new FailuresOfRank(rank));
  }
  const bool passed = RUN_ALL_TESTS() == 0;
  return gaiter::petsc::agree(PETSC_COMM_WORLD, passed) ? 0 : 1;
}
