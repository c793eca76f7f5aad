// SPDX-License-Identifier: BSD-2-Clause
#include "gaiter/physics/slice_outcome.hpp"

#include "gaiter/physics/slice_kernel.hpp"

namespace gaiter::physics {

namespace {

using model::Status;

#define GAITER_EACH for (int i = 0; i < pack_width; ++i)

inline double number_of(Status status) {
  return static_cast<double>(status);
}

inline double larger(double a, double b) {
  return a < b ? b : a;
}

// The actuated state: what both states share.
inline __attribute__((always_inline)) void record(const SliceShape& shape, const Pack* rows,
                                                  const SegmentConstants<Pack>& segments, PackState& state,
                                                  SliceOutcomes& outcomes) {
  const Pack &scale = rows[SliceShape::pressure_scale], &data_limit = segments.data_limit;
  leg_strain(shape, rows, state.pressure, state.strain, state.strain_slope);
  PressureError error;
  pressure_error(shape, rows, state, segments.wall_error, segments.passive_wall_error, error);
  GAITER_EACH {
    outcomes.error_of_difference[i] += error.solution[i] * scale[i];
    outcomes.error_actuated[i] = (error.solution[i] + error.wall[i]) * scale[i];
  }
  GAITER_EACH {
    const double pressure = state.pressure[i] * scale[i];
    const double radius = outcomes.leg_radius[i] * (1 - state.strain[i]);
    outcomes.iterations[i] = larger(outcomes.iterations[i], state.iterations[i]);
    // The estimate to first order may crush a soft leg to nothing.
    const bool diverged = state.open[i] > 0 || state.failed[i] > 0 || state.strain[i] >= 1;
    const double found = diverged                   ? number_of(Status::diverged)
                         : pressure > data_limit[i] ? number_of(Status::extrapolated)
                                                    : number_of(Status::contact);
    outcomes.status[i] = larger(outcomes.status[i], found);
    outcomes.pressure_actuated[i] = pressure;
    outcomes.strain_actuated[i] = state.strain[i];
    outcomes.radius_actuated[i] = radius;
    outcomes.bandage_radius_actuated[i] = pressure > 0 ? radius : larger(radius, outcomes.inner_radius[i]);
  }
}

}  // namespace

GAITER_MULTIVERSION
void record_rigid(const Pack* rows, const Pack& at_rest, const Pack& relief, SliceOutcomes& outcomes) {
  const Pack& scale = rows[SliceShape::pressure_scale];
  GAITER_EACH {
    outcomes.pressure_rest_rigid[i] = larger(0, at_rest[i]) * scale[i];
    outcomes.pressure_actuated_rigid[i] = larger(0, at_rest[i] - relief[i]) * scale[i];
    const double pressing = larger(0, at_rest[i]);
    outcomes.actuation_drop[i] = (relief[i] < pressing ? relief[i] : pressing) * scale[i];
  }
}

GAITER_MULTIVERSION
void adopt_rigid(SliceOutcomes& outcomes) {
  GAITER_EACH {
    const double radius = outcomes.leg_radius[i];
    const bool pressed = outcomes.pressure_rest_rigid[i] > 0;
    outcomes.pressure_rest[i] = outcomes.pressure_rest_rigid[i];
    outcomes.pressure_actuated[i] = outcomes.pressure_actuated_rigid[i];
    outcomes.strain_actuated[i] = 0;
    outcomes.radius_rest[i] = outcomes.radius_actuated[i] = radius;
    outcomes.bandage_radius_rest[i] = outcomes.bandage_radius_actuated[i] =
        pressed ? radius : larger(radius, outcomes.inner_radius[i]);
    outcomes.status[i] = pressed ? number_of(Status::contact) : number_of(Status::slack);
  }
}

GAITER_MULTIVERSION
void record_rest(const SliceShape& shape, const Pack* rows, const SegmentConstants<Pack>& segments,
                 PackState& state, SliceOutcomes& outcomes) {
  record(shape, rows, segments, state, outcomes);
  outcomes.error_rest = outcomes.error_actuated;
  outcomes.pressure_rest = outcomes.pressure_actuated;
  outcomes.radius_rest = outcomes.radius_actuated;
  outcomes.bandage_radius_rest = outcomes.bandage_radius_actuated;
  GAITER_EACH {
    const double found = number_of(outcomes.pressure_rest[i] == 0 ? Status::slack : Status::contact);
    outcomes.status[i] = larger(outcomes.status[i], found);
  }
}

GAITER_MULTIVERSION
void record_actuated(const SliceShape& shape, const Pack* rows, const SegmentConstants<Pack>& segments,
                     PackState& state, SliceOutcomes& outcomes) {
  record(shape, rows, segments, state, outcomes);
  GAITER_EACH outcomes.actuation_drop[i] = outcomes.pressure_rest[i] - outcomes.pressure_actuated[i];
}

GAITER_MULTIVERSION
void record_loads(const SliceShape& shape, const Pack* rows, const Pack& voltage, SliceOutcomes& outcomes) {
  Pack strain, pressure, slope, field;
  GAITER_EACH {
    const bool found = outcomes.status[i] < number_of(Status::no_equilibrium);
    strain[i] = found ? 1 - outcomes.bandage_radius_actuated[i] / outcomes.leg_radius[i]
                      : outcomes.strain_actuated[i];
  }
  actuation_pressure(shape, rows, strain, pressure, slope);
  largest_field(shape, rows, strain, field);
  GAITER_EACH {
    outcomes.actuation_pressure[i] = pressure[i] * rows[SliceShape::pressure_scale][i];
    outcomes.electric_field[i] = field[i] * voltage[i] / outcomes.inner_radius[i];
  }
}

}  // namespace gaiter::physics
