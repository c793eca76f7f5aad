// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/studies/designs.hpp"

#include <fmt/format.h>

#include <boost/random/sobol.hpp>
#include <limits>
#include <utility>

#include "gaiter/base/error.hpp"

namespace gaiter::studies {

namespace {

constexpr std::size_t most_sobol_axes = 3667;  // dimensions that Boost has direction numbers for

// SplitMix64: number `index` of the stream `key`.
std::uint64_t random_bits(std::uint64_t key, std::uint64_t index) {
  std::uint64_t bits = key + (index + 1) * 0x9E3779B97F4A7C15u;
  bits = (bits ^ (bits >> 30)) * 0xBF58476D1CE4E5B9u;
  bits = (bits ^ (bits >> 27)) * 0x94D049BB133111EBu;
  return bits ^ (bits >> 31);
}

// A stream of its own for each axis, so that one more axis does not change the others.
std::uint64_t stream(std::uint64_t seed, const std::string& name) {
  std::uint64_t key = random_bits(seed, 0);
  for (const char c : name) key = random_bits(key, static_cast<unsigned char>(c));
  return key;
}

// The middle of one of 2^53 equal pieces of (0, 1).
double place_of(std::uint64_t bits) {
  return (static_cast<double>(bits >> 11) + 0.5) * 0x1p-53;
}

}  // namespace

struct Designs::Sobol {
  explicit Sobol(std::size_t axes) : engine(static_cast<unsigned>(axes)) {}
  boost::random::sobol engine;
  std::int64_t next = 0;  // design that the engine gives next
};

Designs::~Designs() = default;
Designs::Designs(Designs&&) noexcept = default;

Designs::Designs(std::vector<SweepAxis> axes, Sampling sampling)
    : axes_(std::move(axes)), sampling_(sampling), stride_(axes_.size()) {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    one_setting_.push_back(i);
    for (std::size_t j = 0; j < i; ++j)
      if (axes_[j].option == axes_[i].option && axes_[j].segments == axes_[i].segments) {
        one_setting_.back() = one_setting_[j];
        break;
      }
  }
  if (sampling_.sampler != Sampler::grid) {
    size_ = sampling_.samples;
    for (const SweepAxis& axis : axes_) keys_.push_back(stream(sampling_.seed, axis.name));
    if (sampling_.sampler == Sampler::random) return;
    if (axes_.size() > most_sobol_axes)
      throw base::InputError(fmt::format("-sweep_sampler 'sobol': {} options are swept; must be at most {}",
                                         axes_.size(), most_sobol_axes));
    sobol_ = std::make_unique<Sobol>(axes_.size());
    return;
  }
  for (std::size_t i = axes_.size(); i-- > 0;) {
    stride_[i] = size_;
    if (axes_[i].values.drawn())
      throw base::InputError(
          fmt::format("-sweep_{} '{}': a grid needs values that can be counted, a distribution needs "
                      "-sweep_sampler sobol "
                      "or random",
                      axes_[i].name, axes_[i].values.text(*axes_[i].option, axes_[i].component)));
    const std::int64_t values = axes_[i].values.size();
    if (values == 0) throw base::InputError(fmt::format("-sweep_{}: no values", axes_[i].name));
    if (size_ > std::numeric_limits<std::int64_t>::max() / values) {
      throw base::InputError(fmt::format(
          "-sweep_{}: the sweep has more designs than can be counted, at most 2^63", axes_[i].name));
    }
    size_ *= values;
  }
}

void Designs::grid_values(std::int64_t design, std::span<double> values) const {
  for (std::size_t i = 0; i < axes_.size(); ++i)
    values[i] = axes_[i].values.at(design / stride_[i] % axes_[i].values.size());
}

void Designs::values(std::int64_t design, std::span<double> values) const {
  if (sampling_.sampler == Sampler::grid) return grid_values(design, values);
  if (sobol_ && sobol_->next != design) sobol_->engine.seed(static_cast<std::uint64_t>(design));
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const std::uint64_t shift = sampling_.seed == 0 ? 0 : keys_[i];
    const std::uint64_t bits =
        sobol_ ? sobol_->engine() ^ shift : random_bits(keys_[i], static_cast<std::uint64_t>(design));
    values[i] = axes_[i].values.quantile(place_of(bits));
  }
  if (sobol_) sobol_->next = design + 1;
}

int Designs::apply(std::span<const double> values, model::Scene& scene) const {
  int refused = -1;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const SweepAxis& axis = axes_[i];
    if (refused < 0 && !axis.option->component(axis.component).range.contains(values[i]))
      refused = static_cast<int>(i);
    // Several numbers of one option are set together, with the first of them.
    if (one_setting_[i] != i) continue;
    std::vector<double> numbers = axis.base;
    for (std::size_t j = i; j < axes_.size(); ++j)
      if (one_setting_[j] == i) numbers[axes_[j].component] = values[j];
    for (const std::size_t segment : axis.segments) axis.option->set(scene, segment, numbers);
  }
  return refused;
}

}  // namespace gaiter::studies
