// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <span>

#include "gaiter/model/result.hpp"
#include "gaiter/physics/model_error_kernel.hpp"
#include "gaiter/physics/segment_pack.hpp"
#include "gaiter/physics/slice_outcome.hpp"

namespace gaiter::physics {

// Height averages and the like of the segments of a pack, to results.
class SegmentSummary {
 public:
  // From the segments' slices over the height, a pack of each segment's next one, and their weights.
  SegmentSummary(std::span<const SliceOutcomes> slices, std::span<const Pack> weights,
                 const SegmentPack& segments);

  // Of one segment. All numbers but the initial volume and the rigid pressures are NaN where a slice has no
  // trustworthy result, the field also where one is pulled in. `quadrature_error` and the slices' own errors
  // make the discretisation error.
  model::SegmentResult result(int place, double quadrature_error) const;

  // Of all, what tells the error of the model.
  void find(SlicesFound& found) const;

 private:
  void add(const SliceOutcomes& slice, const Pack& weights);
  void finish(const SegmentPack& segments);

  Pack status_{}, iterations_{}, field_{};
  Pack rest_rigid_{}, actuated_rigid_{}, rest_{}, actuated_{}, actuation_{};  // pressures
  Pack drop_{}, rest_error_{}, actuated_error_{};
  Pack rest_force_{}, actuated_force_{}, rest_area_{}, actuated_area_{};  // over 2 pi, a height
  Pack volume_initial_{}, volume_rest_{}, volume_actuated_{}, volume_change_{};
  Pack radius_{}, stretch_{};
};

}  // namespace gaiter::physics
