// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <array>
#include <span>
#include <vector>

#include "gaiter/model/scene.hpp"
#include "gaiter/physics/forecast_kernel.hpp"
#include "gaiter/physics/height_error.hpp"

namespace gaiter::physics {

// What a segment will need, before anything is solved: from its slice at mid-height and few points through
// the wall (forecast_kernel.hpp), many segments at a time, so that a plan costs a fraction of a solve. Errors
// are relative to the segment's mean pressure; they are estimates of the leading order with a factor for
// caution, and tests/auto_model.cpp and benchmarks/auto_study measure them against solutions.
class SegmentForecast {
 public:
  SegmentForecast(const model::Scene& scene, std::size_t segment);

  // Works out all that the functions below tell, or only sliding_error(). All have the same leg material and
  // number of Ogden terms. What one gets does not depend on the others.
  enum class Depth { sliding, all };
  static void analyse(std::span<SegmentForecast> forecasts, Depth depth = Depth::all);
  void analyse() { analyse({this, 1}); }

  // Which states count; both by default. One without voltage is the state at rest.
  void want(bool rest, bool actuated);

  // Fall of the pressure because the leg gives way, left out by the rigid leg; and what the correction to
  // first order (log P = log P_rigid - k eps, one Newton step) still leaves out.
  double compliance_error() const;
  double first_order_error() const;
  // How much the leg's giving way softens the pressure's response: beyond 1 the leg's law rules.
  double gain() const;

  // Beyond these, errors are hardly told apart.
  static constexpr int most_slices = 128, most_wall_points = 24;

  // Of the average by a Gauss rule of `slices` points over the height, in each piece between cuts().
  double height_error(int slices) const;
  // The leg under voltage, where there is one.
  LoadedLeg loaded() const;
  // Of the Gauss rule of `points` points through the wall.
  double wall_error(int points) const;
  // Change of the mean pressure if the tube slides without friction (or, held, lies on the slope), to first
  // order; NaN: beyond it.
  double sliding_error() const;

  // Heights in (0, 1), ascending, at which the bandage leaves the leg, at rest or under voltage; the pressure
  // has a kink there, and a rule that is not cut converges slowly.
  const std::vector<double>& cuts() const { return cuts_; }
  bool open_everywhere() const { return open_everywhere_; }

  // Size of the pressure over that of the actuation drop, and of the leg's strain over its response: by what
  // errors of these outputs exceed those of the pressure.
  double drop_factor() const;
  double volume_factor() const;

 private:
  struct Pole {
    double size = 0, fall = 0;  // the error of n points is size fall^n
  };
  // At rest or under voltage, at mid-height.
  struct State {
    bool wanted = true;
    // Pressures on a leg that does not give way, to first order, and in equilibrium [Pa].
    double rigid = 0, first = 0, pressure = 0;
    double passive = 0;  // the pressure without the relief by the voltage, at the same radius [Pa]
    double slope = 0;    // d P / d ln R of the bandage [Pa]
    double gain = 0;     // slope times the leg's response to pressure
    double strain = 0, response = 0;  // eps and eps' [1, 1/Pa]
    double sliding = 0;
    std::array<Pole, 2> poles{};
    bool lower_end_open = false, upper_end_open = false;
  };

  void take(const ForecastState& found, int lane, State& state) const;
  void find_cuts(const ForecastInput<double>& input, int lane, double actuated_cut);
  double spread(const State& state, double power) const;
  double leg_error(const State& state, int slices) const;
  double height_error(const State& state, int slices) const;
  template <typename Measure>
  double worst(Measure&& measure) const;

  const model::Scene* scene_;
  std::size_t segment_;
  bool energised_;
  double taper_ = 0;  // half the difference of the radii over the mean radius
  State rest_, actuated_;
  std::array<double, forecast_points + 2> height_{}, wall_{};  // see ForecastErrors [Pa]
  std::vector<double> cuts_;
  bool open_everywhere_ = false;
};

}  // namespace gaiter::physics
