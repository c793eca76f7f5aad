// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include "gaiter/physics/forecast_laws.hpp"
#include "gaiter/physics/height_error.hpp"

namespace gaiter::physics {

// What SegmentForecast tells, of 64 segments at a time and at a fraction of its cost, where a segment is
// benign: in contact from end to end, and close enough to the first-order correction that one more Newton
// step gives its pressures well enough. Pressures are those by one point through the wall, corrected by the
// second derivative there; under voltage that step starts from the state at rest, less what of the relief the
// leg's giving way leaves. Where `sure` is 0 the other numbers mean nothing. What a segment gets does not
// depend on the others. Tested in tests/auto_model.cpp against SegmentForecast.
// In single precision the errors of the rigid leg and of the first order are told to some 2e-6.
template <typename Number>
class QuickForecast {
 public:
  using Input = ForecastInput<Number>;
  using Pack = PackOf<Number>;
  static constexpr int most_points = 12;  // over the height or through the wall

  Pack sure;                        // 1 or 0
  Pack compliance, first_order;     // errors of the rigid leg, of the first-order correction
  Pack first_order_at_middle;       // likewise, at mid-height alone and without caution
  Pack drop_factor, volume_factor;  // as SegmentForecast's

  // Errors of Gauss rules of so many points; few are ever asked for.
  double height_error(int place, int points) const;
  double wall_error(int place, int points) const;
  // The leg under voltage, where there is one.
  LoadedLeg loaded(int place) const {
    return {loaded_pressure_[place], loaded_strain_[place], loaded_response_[place], loaded_give_[place]};
  }

  // `rest`, `actuated`: 1 where that state's pressure counts, else 0.
  void analyse(const Input& input, const Pack& rest, const Pack& actuated);

  // After analyse(), works out `compliance` and `first_order` anew, for about as much again, from two heights
  // and the pressures' own errors there: far closer, with hardly any caution. The input is used up.
  void look_again(Input& input, const Pack& rest, const Pack& actuated);

 private:
  void work_out(const Input& input, const Pack& rest, const Pack& actuated);
  void work_out_again(Input& input, const Pack& rest, const Pack& actuated);

  Pack taper_;  // half the difference of the end radii over the mean radius, without its sign
  Pack share_;  // the most that an error of the rigid leg's pressure counts for [1/Pa]
  LegPoles<Number> poles_;
  ForecastErrors<Number> errors_;
  Pack loaded_pressure_, loaded_strain_, loaded_response_, loaded_give_;
};

template <typename Number>
double QuickForecast<Number>::height_error(int place, int points) const {
  const int known = points < forecast_points ? points : forecast_points;
  const double of_bandage =
      forecast::caution * (errors_.height[known][place] + errors_.height[known + 1][place]) * share_[place];
  double of_leg[2] = {poles_.part[0][place], poles_.part[1][place]};
  for (int n = 0; n < points; ++n)
    for (int k = 0; k < 2; ++k) of_leg[k] *= poles_.fall[k][place];
  return taper_[place] > 0 ? of_bandage + of_leg[0] + of_leg[1] : 0;
}

template <typename Number>
double QuickForecast<Number>::wall_error(int place, int points) const {
  const int known = points < forecast_points ? points : forecast_points;
  const Number before = errors_.wall[known - 1][place], here = errors_.wall[known][place],
               after = errors_.wall[known + 1][place];
  // A term that is small by chance is not trusted.
  const Number neighbours = Number(0.04f) * before * after;
  const Number trusted = here * here < neighbours ? std::sqrt(neighbours) : here;
  return forecast::caution_of_wall * share_[place] * (trusted + after);
}

}  // namespace gaiter::physics
