// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <array>
#include <vector>

#include "gaiter/model/scene.hpp"
#include "gaiter/physics/vector_math.hpp"

// What plans go by, of 64 segments at a time, each by its slice at mid-height. Lengths are divided by the
// inner reference radius A of the wall; pressures are in Pa.
namespace gaiter::physics {

constexpr int forecast_points = 8;  // over the height, and through the wall, for which errors are worked out

// Given of each segment, in double or single precision.
template <typename Number>
struct ForecastInput {
  using Pack = PackOf<Number>;
  struct Term {
    Pack mu, alpha;  // [Pa, 1]
  };
  // By set().
  Pack mean_radius, rise, height;  // of the leg; rise: difference of the end radii [m]
  Pack inner_radius, thickness;    // of the wall [m]
  Pack gap;                        // R - A at mid-height [m]; by close(): (R - A)/A
  Pack voltage, electric;          // times the number of layers [V]; eps [F/m]
  Pack gives_way;                  // 1, or 0: a rigid leg
  Pack slides;                     // 1, or 0: held on the slope
  std::array<Pack, 4> leg;         // a, b, c, d of the strain law; neo-Hookean: K, G/3, K + G/3 [Pa]
  std::vector<Term> terms;
  model::LegMaterial material = model::LegMaterial::compliance;
  // By close().
  Pack leg_radius;         // R/A at mid-height
  Pack area, log_area;     // (B^2 - A^2)/A^2, ln(B^2/A^2)
  Pack taper;              // half the difference of the end radii over the mean radius
  Pack drive;              // 2 eps V^2/A^2, layers as if the field were the same in all [Pa]
  Pack slack;              // strain of the leg that leaves the bandage slack
  Pack pressure_limit;     // and the pressure, about [Pa]
  Pack middle;             // A^2/s at mid-wall
  bool energised = false;  // there is a voltage somewhere

  // Leg material and number of terms are those of all.
  void start(const model::Scene& scene);
  void set(int lane, const model::Scene& scene, std::size_t segment);
  // Repeats the last of `count` segments to the end of the pack and works out the rest.
  void close(int count);
};

// Of the pressure over the height, by the two exponentials of the leg's law: the error of n points is part
// fall^n.
template <typename Number>
struct LegPoles {
  std::array<PackOf<Number>, 2> part, fall;
};

// Of one state, at rest or under voltage; see SegmentForecast::State.
struct ForecastState {
  Pack rigid, first, pressure, passive, slope, gain, strain, response;
  LegPoles<double> poles;
  Pack narrow_net, wide_net;  // at the ends, on the leg without pressure; negative: open
};

// Error of a Gauss rule for the mean of the pressure, leading order and, for more than some points, the size
// it has at most: over the height (as if the leg were rigid), and through the wall. Entry n: n points.
template <typename Number>
struct ForecastErrors {
  std::array<PackOf<Number>, forecast_points + 2> height, wall;  // [Pa]
};

// Pressure by two points through the wall; the leg's strain from a few Newton steps. `rest`: the state
// without voltage, if it is known, to start from.
void forecast_state(const ForecastInput<double>& input, bool voltage, const ForecastState* rest,
                    ForecastState& state);

// The height, over that of the segment, at which the pressure under voltage on a leg without pressure, which
// decides where the bandage leaves it, changes its sign; where `open` on entry: one end is.
void forecast_cut(const ForecastInput<double>& input, const ForecastState& state, Pack& open, Pack& height);

// At a strain of the leg.
void forecast_errors(const ForecastInput<double>& input, const Pack& strain, ForecastErrors<double>& errors);

// Relative change of the mean pressure if the tube slides (or, held, lies on the slope); NaN: beyond the
// first order. Thin wall, leg that does not give way. With w(r, z') the tube's energy per reference height,
// balance along the leg of slope m asks for (w_z')' = w_r m; where nothing has slid, it is missed by f = -m
// D, D = w_r
// - w_rz. The slip that makes up for it, u'' = -f/w_zz with u = 0 at both ends, changes the mean of P = w_r/r
// by
//   - m^2 H^2 D (D/r)' / (12 w_zz).
// The slope itself stretches the tube by sqrt(1 + m^2) along the meridian: w_rz (sqrt(1 + m^2) - 1) / r.
void forecast_sliding(const ForecastInput<double>& input, bool voltage, Pack& change);

}  // namespace gaiter::physics
