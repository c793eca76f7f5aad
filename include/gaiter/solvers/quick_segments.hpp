// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "gaiter/physics/quick_forecast.hpp"
#include "gaiter/solvers/slice_model.hpp"

namespace gaiter::solvers {

// One segment of a quick forecast, asked like a SegmentForecast.
template <typename Number>
struct QuickSegment {
  using Pack = physics::QuickForecast<Number>;
  static constexpr int most_slices = Pack::most_points, most_wall_points = most_slices;

  const Pack& pack;
  int place;

  double compliance_error() const { return pack.compliance[place]; }
  double first_order_error() const { return pack.first_order[place]; }
  double first_order_at_middle() const { return pack.first_order_at_middle[place]; }
  double height_error(int slices) const { return pack.height_error(place, slices); }
  physics::LoadedLeg loaded() const { return pack.loaded(place); }
  double wall_error(int points) const { return pack.wall_error(place, points); }
  double drop_factor() const { return pack.drop_factor[place]; }
  double volume_factor() const { return pack.volume_factor[place]; }
};

enum class Look { once, twice };  // at mid-height, or also at two heights

// Quick forecasts of the `chosen` tasks, of which wanted(task) outputs say what errors count; those that are
// sure are told(task, QuickSegment). Tasks of which they are not, or told() is false, are added to
// `doubtful`.
template <typename Number, typename Wanted, typename Told>
void forecast_quickly(std::span<const SegmentTask> tasks, std::span<const std::size_t> chosen, Look look,
                      Wanted&& wanted, Told&& told, std::vector<std::size_t>& doubtful) {
  // Large, so that it is kept for the next batch.
  thread_local physics::ForecastInput<Number> input;
  thread_local physics::QuickForecast<Number> quick;
  for (std::size_t first = 0; first < chosen.size(); first += physics::pack_width) {
    const auto some =
        chosen.subspan(first, std::min<std::size_t>(physics::pack_width, chosen.size() - first));
    const int count = static_cast<int>(some.size());
    physics::PackOf<Number> rest{}, actuated{};
    input.start(*tasks[some[0]].scene);
    for (int place = 0; place < count; ++place) {
      const auto& [scene, segment, plan] = tasks[some[place]];
      const model::Wanted outputs = wanted(some[place]);
      input.set(place, *scene, segment);
      actuated[place] = outputs.actuated() && scene->bandage.modules[segment].voltage != 0 ? 1 : 0;
      rest[place] = outputs.at_rest() || actuated[place] == 0 ? 1 : 0;
    }
    input.close(count);
    quick.analyse(input, rest, actuated);
    if (look == Look::twice) quick.look_again(input, rest, actuated);
    for (int place = 0; place < count; ++place)
      if (!(quick.sure[place] > 0 && told(some[place], QuickSegment<Number>{quick, place})))
        doubtful.push_back(some[place]);
  }
}

}  // namespace gaiter::solvers
