// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cmath>
#include <vector>

namespace gaiter {

// Slope of ln(error) over ln(size), by least squares: the order of an error in a mesh or step size.
inline double fitted_order(const std::vector<double>& sizes, const std::vector<double>& errors) {
  double x = 0, y = 0, xx = 0, xy = 0;
  const double n = static_cast<double>(sizes.size());
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    const double u = std::log(sizes[k]), v = std::log(errors[k]);
    x += u;
    y += v;
    xx += u * u;
    xy += u * v;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

}  // namespace gaiter
