// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <string>
#include <vector>

namespace gaiter::model {

// Constants of the radial strain law eps_r(P) = a exp(bP) + c exp(dP), paper Eq. (2), as published.
struct Compliance {
  double a = 0;  // [1]
  double b = 0;  // [1/Pa]
  double c = 0;  // [1]
  double d = 0;  // [1/Pa]
};

enum class ComplianceVariant { published, anchored };  // anchored: c = -a, so that eps_r(0) = 0
enum class LegModel { compliant, rigid };
enum class LegMaterial { compliance, neo_hookean };

// One conical piece of leg; a bandage module covers it from end to end.
struct Segment {
  std::string name;
  double height = 0;        // [m]
  double lower_radius = 0;  // undeformed, at the end nearer the ankle [m]
  double upper_radius = 0;  // undeformed, at the end nearer the knee [m]
  Compliance compliance;
  struct {
    double lower_radius = 0, upper_radius = 0;
    Compliance compliance;
  } given{};  // before the leg's scales, which Leg::scale applies; nothing else looks at it

  double mean_radius() const { return 0.5 * (lower_radius + upper_radius); }  // [m]
  // Half the difference of the end radii over that.
  double taper() const { return 0.5 * (upper_radius - lower_radius) / mean_radius(); }
};

struct Leg {
  std::vector<Segment> segments;  // ankle up
  LegModel model = LegModel::compliant;
  LegMaterial material = LegMaterial::compliance;
  ComplianceVariant variant = ComplianceVariant::published;
  double data_limit = 7000;     // pressure up to which the compliance was measured [Pa]
  double young_modulus = 80e3;  // neo-Hookean leg [Pa]
  double poisson_ratio = 0.4;   // neo-Hookean leg [1]
  double shear_modulus = 10e3;  // of the compliance material, in finite elements only [Pa]
  double radius_scale = 1;      // of all segments' given radii [1]
  double compliance_scale = 1;  // of the strains of all segments' given compliance [1]

  // Radii and compliance of all segments from what is given and the scales.
  void scale() {
    for (Segment& segment : segments) {
      segment.lower_radius = radius_scale * segment.given.lower_radius;
      segment.upper_radius = radius_scale * segment.given.upper_radius;
      segment.compliance = segment.given.compliance;
      segment.compliance.a *= compliance_scale;
      segment.compliance.c *= compliance_scale;
    }
  }
};

}  // namespace gaiter::model
