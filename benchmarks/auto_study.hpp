// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <vector>

#include "gaiter/model/result.hpp"

// What the studies of -fidelity auto have in common.
namespace gaiter::study {

// The larger one of the relative errors of the pressures at rest and under voltage.
inline double error_of(const model::SegmentResult& found, const model::SegmentResult& truth) {
  const auto relative = [](double a, double b) { return b > 0 ? std::fabs(a / b - 1) : std::fabs(a); };
  const double error = std::max(relative(found.pressure_rest, truth.pressure_rest),
                                relative(found.pressure_actuated, truth.pressure_actuated));
  return model::trustworthy(found.status) ? error : 1e300;
}

// The same of another output than the pressures.
inline double error_of(const model::SegmentResult& found, const model::SegmentResult& truth,
                       double model::SegmentResult::*output) {
  if (!output) return error_of(found, truth);
  return model::trustworthy(found.status) ? std::fabs(found.*output / truth.*output - 1) : 1e300;
}

inline double quantile(std::vector<double> values, double part) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1,
                         static_cast<std::size_t>(part * static_cast<double>(values.size())))];
}

// True over estimated errors: of each tolerance how many scenes lie between the edges.
class ErrorRatios {
 public:
  // Errors of no more than `rounding` say nothing about their estimates.
  explicit ErrorRatios(double rounding) : rounding_(rounding) {}

  void add(double tolerance, double error, double estimate) {
    if (!(error > rounding_)) return;
    const double ratio = error / std::max(estimate, 1e-14);
    ++counts_[tolerance][std::upper_bound(edges.begin(), edges.end(), ratio) - edges.begin()];
  }

  void print() const {
    std::printf("\ntrue over estimated error, share of scenes [%%], where the true error is above %.0e\n%8s",
                rounding_, "TOL");
    for (const double edge : edges) std::printf("  <%7.0e", edge);
    std::printf("    beyond\n");
    for (auto it = counts_.rbegin(); it != counts_.rend(); ++it) {
      int all = 0;
      for (const int number : it->second) all += number;
      std::printf("%8.0e", it->first);
      for (const int number : it->second) std::printf("  %8.2f", 100.0 * number / std::max(all, 1));
      std::printf("\n");
    }
  }

 private:
  static constexpr std::array<double, 8> edges{1e-4, 1e-3, 1e-2, 0.03, 0.1, 0.3, 1, 3};
  double rounding_;
  std::map<double, std::array<int, edges.size() + 1>> counts_;
};

}  // namespace gaiter::study
