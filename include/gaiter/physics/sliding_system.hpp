// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <vector>

#include "gaiter/physics/slice_system.hpp"

// Sliding slices: the tube of one segment slides without friction along the taper of the leg.
//
// Kinematics. The tube's material circle at reference height Z sits at z(Z) with inner radius r(Z). On the
// leg it follows the slope m = dR_c/dz of the undeformed leg, so its stretch along the meridian is lambda =
// c dz/dZ with c = sqrt(1 + m^2), the same at all wall points; material normals stay normal, and the wall
// keeps its volume:
//   rho^2 = r^2 + g (s - A^2),  g = (dz/dZ)/lambda^2 = 1/(c^2 dz/dZ),  lambda_theta^2 = rho^2/s,
// with s the reference radius squared and rho the distance from the axis. The capacity of a layer per dZ is
// 2 pi eps (dz/dZ)/ln(rho_out/rho_in). With m = 0 and dz/dZ = 1 these are Eqs. (4) and (8) of the paper.
//
// Why the leg's slope, and not r'(Z). With r' in lambda a free edge is pulled off the slope: an interior
// pressure lower by the factor 1/c^2 and concentrated forces at the two ends (lift-off at the narrow one)
// that make up for it, over sqrt(tension/leg stiffness), about 1 mm. The sum of radial forces is the integral
// of dw/dr either way, and it is what the pressures reported here are made of. But the voltage turns the
// tension along the tube into compression (stretch 1.4 and 11.3 kV on the ankle), and a membrane with r' and
// no bending stiffness then wrinkles at the width of its mesh. With the slope given, r is local to each
// circle, and z(Z) obeys one ordinary differential equation of second order without boundary layers. The
// difference is 0.1 % of the mean pressure at rest. Local pressures are those of the total force, spread
// evenly: up to 1 + m^2 larger than those in the interior of a tube with free edges.
//
// Energy per reference height over 2 pi, with the leg's strain eps (r = R_c(z)(1 - eps)):
//   e(z, z', eps) = w(r, z') + R_c(z)^2 Phi(eps) z',   Phi = int P (1 - eps) d eps,
// w = 1/2 ln(B^2/A^2) int sum mu/alpha (..) s dt - sum over layers eps_0 eps_r V^2 z'/log1p(q). The leg is a
// stack of slices that do not shear; each slice's energy is that of its strain law.
namespace gaiter::physics {

// Elements are cubic in z, with as many Gauss points, each a slice: functionals of the solution converge with
// the sixth power of their number where the bandage touches all along.
constexpr int sliding_degree = 3;

struct SlidingShape {
  int elements = 8;    // a segment
  bool rigid = false;  // the leg does not give way

  int slices() const { return sliding_degree * elements; }
  // Heights z between the fixed ends, and a strain a slice.
  int unknowns() const { return 2 * slices() - 1; }
};

// Elements for at least `slices` slices.
constexpr int sliding_elements(int slices) {
  return slices <= sliding_degree ? 1 : (slices + sliding_degree - 1) / sliding_degree;
}

// Constants of many segments in packs of 64, a segment a lane: those of its slice at mean radius, and the
// rows below. Lengths over A, pressures over S, as in SliceSystem.
class SlidingSystem {
 public:
  enum Row {
    slope,           // m
    log_slope,       // ln c
    element_height,  // over A
    free,            // 1: slides; 0: held
    lifted_slope,    // d eps / d contact where the tube is off a leg that does not give way
    row_count
  };

  SlidingSystem(SlidingShape shape, SliceShape slice_shape, std::size_t segments);

  const SlidingShape& shape() const { return shape_; }
  const SliceShape& slice_shape() const { return sections_.shape(); }
  std::size_t segments() const { return sections_.slices(); }
  std::size_t packs() const { return sections_.packs(); }

  // Constants of one segment of a scene; `wall_rule`: its own points through the wall, at most as many as the
  // shape's. `overstretch` and `drive` are the parts of its stretch beyond 1, and
  // of its voltage squared, that are taken (1: all); continuation walks along them.
  void set(std::size_t index, const model::Scene& scene, std::size_t segment, const Quadrature& wall_rule,
           double overstretch = 1, double drive = 1);

  // With the voltage on, or off as if there were none (the rest state).
  void energise(bool on) { sections_.energise(on); }
  // Whether the leg gives way.
  void set_rigid(bool rigid) { shape_.rigid = rigid; }

  const Pack* section(std::size_t pack) const { return sections_.pack(pack); }
  const Pack* pack(std::size_t pack) const { return rows_.data() + row_count * pack; }
  double inner_radius(std::size_t index) const { return inner_radius_[index]; }  // A [m]
  double pressure_scale(std::size_t index) const {                               // S [Pa]
    return sections_.constant(index, SliceShape::pressure_scale);
  }

 private:
  SlidingShape shape_;
  SliceSystem sections_;
  std::vector<Pack> rows_;
  std::vector<double> inner_radius_;
};

}  // namespace gaiter::physics
