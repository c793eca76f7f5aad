// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "gaiter/model/scene.hpp"
#include "gaiter/studies/option_table.hpp"
#include "gaiter/studies/sweep_values.hpp"

namespace gaiter::studies {

// One swept number.
struct SweepAxis {
  std::string name;                   // as the user writes it after sweep_, the archive's variable
  const Option* option;               // its entry in the table
  std::size_t component = 0;          // which of the option's numbers
  std::vector<std::size_t> segments;  // those whose value it sets; 0 alone for options of the whole scene
  std::vector<double> base;           // all numbers of the option; those that are not swept stay as they are
  SweepValues values;                 // [unit()]

  std::string_view unit() const { return option->component(component).unit; }
};

enum class Sampler { grid, sobol, random };

struct Sampling {
  Sampler sampler = Sampler::grid;
  std::int64_t samples = 0;  // sobol and random
  std::uint64_t seed = 0;
};

// The designs of a sweep. The grid combines all axes' values, the last axis running fastest; without an axis
// it is one design. A Sobol sequence (Boost's, so Joe and Kuo's direction numbers) or random numbers
// (SplitMix of Steele, Lea and Flood 2014, a function of seed, axis and design alone) give each design a
// place between 0 and 1 on each axis, of which the axis's quantile is the value. A design is worked out from
// its index, so that millions of them take no memory and do not depend on who works them out.
class Designs {
 public:
  explicit Designs(std::vector<SweepAxis> axes, Sampling sampling = {});  // throws InputError
  ~Designs();
  Designs(Designs&&) noexcept;

  std::int64_t size() const { return size_; }
  const std::vector<SweepAxis>& axes() const { return axes_; }

  // The value of each axis in a design [axes()[axis].unit()].
  void values(std::int64_t design, std::span<double> values) const;

  // Puts a design's values into a scene, which keeps all others. Any order of designs may follow on one
  // scene. The first axis whose value its option does not allow, which a distribution may draw; -1: none.
  int apply(std::span<const double> values, model::Scene& scene) const;

 private:
  struct Sobol;
  void grid_values(std::int64_t design, std::span<double> values) const;

  std::vector<SweepAxis> axes_;
  Sampling sampling_;
  std::vector<std::int64_t> stride_;      // of a grid: designs between two values of an axis
  std::vector<std::size_t> one_setting_;  // axes of one option and one segment have the same number here
  std::vector<std::uint64_t> keys_;       // of each axis's random numbers
  std::int64_t size_ = 1;
  std::unique_ptr<Sobol> sobol_;  // where the sequence stands; it is asked for designs in turn, mostly
};

}  // namespace gaiter::studies
