// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <array>
#include <vector>

#include "gaiter/model/scene.hpp"

namespace gaiter::physics {

// What a segment will need, before anything is solved: in closed form from its slice at mid-height, so that a
// plan costs a fraction of a solve. Errors are relative to the segment's mean pressure; they are estimates of
// the leading order with a factor for caution, and tests/error_estimates.cpp and benchmarks/auto_study
// measure them against solutions.
class SegmentForecast {
 public:
  SegmentForecast(const model::Scene& scene, std::size_t segment);

  // Everything but sliding_error() needs this once.
  void analyse();

  // Which states count; both by default. One without voltage is the state at rest.
  void want(bool rest, bool actuated);

  // Fall of the pressure because the leg gives way, left out by the rigid leg; and what the correction to
  // first order (log P = log P_rigid - k eps, one Newton step) still leaves out.
  double compliance_error() const;
  double first_order_error() const;
  // How much the leg's giving way softens the pressure's response: beyond 1 the leg's law rules.
  double gain() const;

  // Of the average by a Gauss rule of `slices` points over the height, in each piece between cuts().
  double height_error(int slices) const;
  // Of the Gauss rule of `points` points through the wall.
  double wall_error(int points) const;
  // Change of the mean pressure if the tube slides without friction (or, held, lies on the slope), to first
  // order: see sliding_change().
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
  // At rest or under voltage, at mid-height.
  struct State {
    bool wanted = true;
    // Pressures on a leg that does not give way, to first order, and in equilibrium [Pa].
    double rigid = 0, first = 0, pressure = 0;
    double passive = 0;  // the pressure without the relief by the voltage, at the same radius [Pa]
    double slope = 0;    // d P / d ln R of the bandage [Pa]
    double gain = 0;     // slope times the leg's response to pressure
    double bending = 0;  // |eps''/eps'| of the leg [1/Pa]
    double strain = 0, response = 0;  // eps and eps' [1, 1/Pa]
    double sliding = 0;
  };
  struct Power {
    double size, exponent;  // size R^exponent, a part of the bandage's pressure over the height
  };

  double passive_pressure(double leg_radius, double* slope = nullptr) const;
  double relief(double leg_radius) const;
  void strain_law(double pressure, double& strain, double& response, double& bending) const;
  void resolve_wall(double leg_radius);
  void find_cuts();
  void forecast_state(State& state, bool voltage);
  double sliding_change(bool actuated) const;
  double height_error(const State& state, int slices) const;
  template <typename Measure>
  double worst(Measure&& measure) const;

  const model::Scene& scene_;
  const model::Segment& leg_;
  const model::Module& module_;
  double mean_radius_, taper_;     // taper: half the difference of the radii over the mean radius
  double inner_, gap_, log_area_;  // A [m], R - A at mid-height [m], ln(B^2/A^2)
  double strain_of_none_ = 0;      // of the leg without pressure
  State rest_, actuated_;
  std::vector<Power> powers_;
  std::array<double, 4> wall_ratio_{};  // A^2/s at the points of the wall
  std::array<double, 4> wall_{};        // Legendre coefficients of the stress through the wall
  std::vector<double> cuts_;
  bool open_everywhere_ = false;
};

// Error of the n-point Gauss rule for the mean of a function whose Legendre coefficients end with `last`
// (degrees degree - 2, degree - 1, degree), carried on to degree 2n, which the rule is the first to get
// wrong. Ratios of neighbours fall like those of an exponential, but never below those of a function with a
// pole at the distance 1/closeness (in half lengths of the interval).
double gauss_tail(const std::array<double, 3>& last, int degree, double closeness, int points);

}  // namespace gaiter::physics
