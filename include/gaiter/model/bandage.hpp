// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <limits>
#include <vector>

namespace gaiter::model {

// One term of W = sum mu/alpha (l1^alpha + l2^alpha + l3^alpha - 3), the ANSYS convention.
struct OgdenTerm {
  double mu = 0;     // [Pa]
  double alpha = 0;  // [1]
};

// Which radius of the wall the flat length L = 2 pi R and the stretch refer to.
enum class LengthAt { outer, middle, inner };

// The bandage module on one segment. Its size is given by the stretch or by the flat length, never by both.
struct Module {
  double stretch = 1;  // undeformed mean leg radius over reference radius; unused where length > 0 [1]
  double length = 0;   // flat length, 0: from the stretch [m]
  double voltage = 0;  // [V]
};

struct Bandage {
  std::vector<Module> modules;  // one a segment, same order
  double thickness = 1e-3;      // undeformed wall [m]
  LengthAt length_at = LengthAt::outer;
  std::vector<OgdenTerm> ogden;
  double bulk_modulus = std::numeric_limits<double>::infinity();  // finite elements only [Pa]
  double permittivity = 1;                                        // relative [1]
  int layers = 1;  // of equal reference thickness, electrically in parallel
  double breakdown_field = std::numeric_limits<double>::infinity();  // [V/m]
};

}  // namespace gaiter::model
