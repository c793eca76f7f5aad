// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include "gaiter/model/result.hpp"
#include "gaiter/physics/model_error_kernel.hpp"

// How far slices and sliding slices are from the axisymmetric finite elements, estimated from the slices'
// result alone in less than a microsecond: to leading order in the slope m of the leg, in closed form.
//
// Three effects, all of the order m^2, change the mean pressure of a segment of height H, radius R and slope
// m; tau is the tension along the tube over that around it, K the change of the tube's axial stretch per
// m H/R from one end to the other:
//   sliding  (m H/R)^2/12 [K^2/2 (p_y + p_yy + p_y^2) - K (p_yx + p_x p_y)]: the axial equilibrium,
//   linearised
//            about the tube as laid on, A z'' = m (contact pressure less d tension / d radius), moves the
//            tube by a parabola, which changes the pressure of each slice;
//   slope    m^2/2 d ln(hoop force)/d ln(axial stretch): the tube is longer along the slope than H;
//   ends     -m^2 tau: a cone presses less by 1/(1 + m^2) than the rings it is made of, and the difference
//            acts as line loads, m times the tension, on its two ends.
// Sliding slices have the first two, finite elements all three, plain slices none; if nothing slides
// (ContactAxial::held) the first is gone. p_x and p_y are derivatives of ln P of the slices with respect to
// the logarithms of radius and axial stretch. The volume follows likewise. What is of higher order, and the
// shear of the leg, which none of this has, is bounded by factors that benchmarks/model_map.py fits to finite
// elements. Tests: tests/model_shifts.cpp.
namespace gaiter::physics {

// Relative changes of one output that the effects make, signed.
struct ModelShift {
  double sliding = 0;  // slides along the taper, free of friction
  double slope = 0;    // is as long as the slope
  double ends = 0;     // loses its tension at the ends

  double all() const { return sliding + slope + ends; }
};

// Of the state at rest and the actuated one.
struct ModelShifts {
  ModelShift pressure_rest, pressure_actuated, volume_rest, volume_actuated;
  bool rest_known = false, actuated_known = false;  // false: outside of what was calibrated
};

// Estimated errors of what a model computes, relative to that; infinity: unknown. volume_change is that of
// the actuated state, as in the result.
struct ModelError {
  double pressure_rest = 0, pressure_actuated = 0;
  double actuation_drop = 0;
  double volume_change = 0;
};

struct ModelErrors {
  ModelError slice, sliding;
};

// `slices`: what plain slices say of that segment. Known for segments in contact all over, of taper below 20
// degrees, H/R of 0.3 to 5, difference of the end radii below 1.2 R, wall/R of 0.0025 to 0.05, stretch
// of 1.06 to 2.2 and at the narrow end at least 1.03 once the leg has given way, Ogden exponents from -2
// to 12.2, strains of the leg below 0.3, a shear modulus of the leg of 0.04 to 1 of its stiffness against a
// small uniform pressure and no less than the pressure over 0.7, |K| below 6 (under voltage 4) and |K| m H/R
// below 0.8: beyond, the frictionless tube has often buckled, or has no stable state.
//
// Some way beyond, the pressures' errors alone are known, with more caution: walls of 0.0015 to 0.08 R,
// stretch of 1.045 to 2.65 and at the narrow end 0.9, |K| below 25 (under voltage 16), |K| m H/R below 1.4,
// and the strain of the leg times pressure over shear modulus below 3.2, beyond which half of the legs are
// crushed without an end; nothing holds the tube.
ModelShifts model_shifts(const model::Scene& scene, std::size_t segment, const model::SegmentResult& slices);
ModelErrors model_errors(const model::Scene& scene, std::size_t segment, const model::SegmentResult& slices);

// Of a pack of segments: the larger error of both pressures of plain slices, by the same formulae, and the
// pressure at rest at the end where it is higher, as a power of the radius [Pa]. Without contact garbage.
void bound_slice_pressures(const SegmentPack& segments, model::LegMaterial material,
                           const SlicesFound& slices, Pack& error, Pack& highest);

}  // namespace gaiter::physics
