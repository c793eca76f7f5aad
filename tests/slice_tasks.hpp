// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <petscsys.h>

#include <array>
#include <cstring>
#include <string>
#include <vector>

#include "gaiter/petsc/session.hpp"
#include "gaiter/solvers/slice_model.hpp"

namespace gaiter::tasks {

// All numbers of a result, so that two can be compared bit by bit and sent over ranks.
constexpr int fields = 27;
using Numbers = std::array<double, fields>;

inline Numbers numbers_of(const model::SegmentResult& r) {
  return {r.pressure_rest,
          r.pressure_actuated,
          r.pressure_rest_rigid,
          r.pressure_actuated_rigid,
          r.pressure_rest_area_mean,
          r.pressure_actuated_area_mean,
          r.actuation_drop,
          r.actuation_pressure,
          r.volume_initial,
          r.volume_rest,
          r.volume_actuated,
          r.volume_change,
          r.radius_actuated,
          r.stretch_actual,
          r.electric_field_max,
          r.error_estimate,
          static_cast<double>(r.iterations),
          static_cast<double>(r.status),
          static_cast<double>(r.fidelity),
          r.slip_max,
          r.pressure_rest_change,
          r.pressure_actuated_change,
          r.voltage_stable,
          r.discretisation_error,
          r.model_error,
          static_cast<double>(r.slice_count),
          static_cast<double>(r.wall_points)};
}

inline bool same_bits(const Numbers& a, const Numbers& b) {
  return std::memcmp(a.data(), b.data(), sizeof a) == 0;
}

// Every segment of every scene.
inline std::vector<solvers::SegmentTask> all_segments(const std::vector<model::Scene>& scenes) {
  std::vector<solvers::SegmentTask> tasks;
  for (const model::Scene& scene : scenes)
    for (std::size_t segment = 0; segment < scene.leg.segments.size(); ++segment)
      tasks.push_back({&scene, segment});
  return tasks;
}

// The first segment of a scene, alone.
inline model::SegmentResult solve_one(const model::Scene& scene) {
  const solvers::SegmentTask task{&scene, 0};
  return solvers::solve_segments(PETSC_COMM_SELF, {&task, 1})[0];
}

// An option for as long as this object lives.
class Option {
 public:
  Option(std::string name, const std::string& value) : name_(std::move(name)) {
    (void)PetscOptionsSetValue(nullptr, name_.c_str(), value.c_str());
  }
  ~Option() { (void)PetscOptionsClearValue(nullptr, name_.c_str()); }
  Option(const Option&) = delete;
  Option& operator=(const Option&) = delete;

 private:
  std::string name_;
};

}  // namespace gaiter::tasks
