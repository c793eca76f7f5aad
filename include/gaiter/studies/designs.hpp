// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "gaiter/model/scene.hpp"
#include "gaiter/studies/option_table.hpp"

namespace gaiter::studies {

// One swept option.
struct SweepAxis {
  std::string name;                   // of the option, with the segment's name in it: the archive's variable
  const Option* option;               // its entry in the table, unit included
  std::vector<std::size_t> segments;  // those whose value it sets; 0 alone for options of the whole scene
  std::vector<double> values;         // [option->unit()]
};

// The designs of a sweep: the grid of all axes' values, the last axis running fastest. Without an axis, one
// design. A design is worked out from its index, so that millions of them take no memory.
class Designs {
 public:
  explicit Designs(std::vector<SweepAxis> axes);  // throws InputError where the grid is too large to count

  std::int64_t size() const { return size_; }
  const std::vector<SweepAxis>& axes() const { return axes_; }

  // The value of one axis in a design [axes()[axis].option->unit()].
  double value(std::size_t axis, std::int64_t design) const;

  // Puts a design's values into a scene, which keeps all others. Any order of designs may follow on one
  // scene.
  void apply(std::int64_t design, model::Scene& scene) const;

 private:
  std::vector<SweepAxis> axes_;
  std::vector<std::int64_t> stride_;  // designs between two values of an axis
  std::int64_t size_ = 1;
};

}  // namespace gaiter::studies
