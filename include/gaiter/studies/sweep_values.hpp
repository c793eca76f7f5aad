// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gaiter/studies/option_table.hpp"

namespace gaiter::studies {

// The values that a sweep gives to one number of an option: a list, points of a line or of a logarithmic
// scale, or a distribution to draw from. All but the list take no memory, however many values they have.
class SweepValues {
 public:
  enum class Law { list, linspace, logspace, uniform, normal };

  explicit SweepValues(std::vector<double> list) : list_(std::move(list)) {}
  SweepValues(Law law, double first, double second, std::int64_t count, bool whole)
      : law_(law), first_(first), second_(second), count_(count), whole_(whole) {}

  Law law() const { return law_; }
  bool drawn() const { return law_ == Law::uniform || law_ == Law::normal; }  // without values to count

  // Of a law that is not drawn: how many values, and the one of an index.
  std::int64_t size() const;
  double at(std::int64_t index) const;

  // The value at a place from 0 to 1 (both excluded) of the distribution: its quantile; of a law with values
  // to count, one of these, all equally likely.
  double quantile(double place) const;

  // Least and largest value; the normal distribution has none, its mean stands for both.
  std::pair<double, double> extremes() const;

  // Text that parse_sweep_values reads as this again, in SI with units. A list has YAML's brackets.
  std::string text(const Option& option, std::size_t component) const;

  bool operator==(const SweepValues&) const = default;

 private:
  Law law_ = Law::list;
  std::vector<double> list_;
  double first_ = 0, second_ = 0;  // ends, or mean and standard deviation
  std::int64_t count_ = 0;
  bool whole_ = false;  // uniform: whole numbers, both ends among them
};

// Reads `1.4,1.6`, `linspace(lo,hi,n)`, `logspace(lo,hi,n)`, `uniform(lo,hi)` or `normal(mean,sd)` for one
// component of an option. Values, ends and the mean are within the option's range. Throws InputError.
SweepValues parse_sweep_values(const Option& option, std::size_t component, std::string_view name,
                               std::string_view text);

}  // namespace gaiter::studies
