// SPDX-License-Identifier: BSD-2-Clause
// How finely, and by which algorithm, slices are solved.
#include "gaiter/studies/option_table.hpp"

namespace gaiter::studies {

namespace {

using model::Scene;
using Values = std::span<const double>;

}  // namespace

std::vector<Option> slice_options() {
  return {
      {.name = "slice_count",
       .kind = Kind::count,
       .components = {{.range = {.low = 1, .high = 100000}}},
       .default_text = "6",
       .doc = "Slices a segment.",
       .sweepable = true,
       .set = [](Scene& s, std::size_t, Values v) { s.discretisation.slice_count = static_cast<int>(v[0]); }},
      {.name = "slice_fixed_point_tolerance",
       .components = {{.range = {.low = 1e-16, .high = 0.1}}},
       .default_text = "1e-4",
       .doc = "The fixed point stops once the radius changes by less than this part of the undeformed one.",
       .sweepable = true,
       .set = [](Scene& s, std::size_t, Values v) { s.discretisation.fixed_point_tolerance = v[0]; }},
      {.name = "slice_precision",
       .kind = Kind::choice,
       .choices = {"double", "single"},
       .default_text = "double",
       .doc = "Precision of the exponentials and logarithms of the slices (fidelity slice); with single, "
              "Newton and the points through the wall go no further than it can tell.",
       .set =
           [](Scene& s, std::size_t, Values v) {
             s.discretisation.slice_precision = static_cast<model::SlicePrecision>(static_cast<int>(v[0]));
           }},
      {.name = "slice_rule",
       .kind = Kind::choice,
       .choices = {"gauss", "midpoint"},
       .default_text = "gauss",
       .doc = "Where the slices of a segment sit and what they weigh; midpoint is the paper's.",
       .set =
           [](Scene& s, std::size_t, Values v) {
             s.discretisation.slice_rule = static_cast<model::SliceRule>(static_cast<int>(v[0]));
           }},
      {.name = "slice_solver",
       .kind = Kind::choice,
       .choices = {"newton", "fixed_point"},
       .default_text = "newton",
       .doc = "Newton on all slices together (SNES), or the paper's fixed point.",
       .set =
           [](Scene& s, std::size_t, Values v) {
             s.discretisation.slice_solver = static_cast<model::SliceSolver>(static_cast<int>(v[0]));
           }},
      {.name = "wall_points",
       .kind = Kind::count,
       .components = {{.range = {.low = 1, .high = 128}}},
       .word = {"auto", 0},
       .default_text = "auto",
       .doc = "Gauss points through the wall; 1 is a thin wall, auto takes as many as the wall needs.",
       .sweepable = true,
       .set = [](Scene& s, std::size_t, Values v) { s.discretisation.wall_points = static_cast<int>(v[0]); }},
  };
}

}  // namespace gaiter::studies
