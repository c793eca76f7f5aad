// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/designs.hpp"

#include <fmt/format.h>

#include <limits>
#include <span>
#include <utility>

#include "gaiter/base/error.hpp"

namespace gaiter::studies {

Designs::Designs(std::vector<SweepAxis> axes) : axes_(std::move(axes)), stride_(axes_.size()) {
  for (std::size_t i = axes_.size(); i-- > 0;) {
    stride_[i] = size_;
    const auto values = static_cast<std::int64_t>(axes_[i].values.size());
    if (values == 0) throw base::InputError(fmt::format("-sweep_{}: no values", axes_[i].name));
    if (size_ > std::numeric_limits<std::int64_t>::max() / values) {
      throw base::InputError(fmt::format(
          "-sweep_{}: the sweep has more designs than can be counted, at most 2^63", axes_[i].name));
    }
    size_ *= values;
  }
}

double Designs::value(std::size_t axis, std::int64_t design) const {
  const std::vector<double>& values = axes_[axis].values;
  return values[static_cast<std::size_t>(design / stride_[axis]) % values.size()];
}

void Designs::apply(std::int64_t design, model::Scene& scene) const {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const double chosen = value(i, design);
    for (const std::size_t segment : axes_[i].segments) {
      axes_[i].option->set(scene, segment, std::span(&chosen, 1));
    }
  }
}

}  // namespace gaiter::studies
