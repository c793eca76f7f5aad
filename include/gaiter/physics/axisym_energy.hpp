// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <limits>
#include <vector>

#include "gaiter/model/scene.hpp"
#include "gaiter/physics/jet.hpp"

// Stored energies per reference volume of the axisymmetric bodies, as jets of the deformation gradient
//   F = [ F_rR F_rZ 0; F_zR F_zZ 0; 0 0 F_t ],  F_t = r/R.
// Validity: det F > 0 (the caller checks). Tests: tests/axisym_energy.cpp.
namespace gaiter::physics {

// The independent components, in the order in which elements hand them over.
template <int N>
struct Deformation {
  Jet<N> rR, rZ, zR, zZ, t;

  Jet<N> in_plane() const { return rR * zZ - rZ * zR; }
  Jet<N> volume() const { return in_plane() * t; }
};

// lambda_1^alpha + lambda_2^alpha of the in-plane stretches, which is smooth where they are equal.
template <int N>
Jet<N> in_plane_powers(const Deformation<N>& f, double alpha);

// Elastomer: Ogden, pressure field p, bulk modulus K, and the stabilising term kappa/2 (J - 1)^2, which
// removes one-element folds that the mixed element would otherwise have at large stretch, and which a finite
// K absorbs:
//   W = sum mu/alpha (sum_i (J^{-1/3} lambda_i)^alpha - 3) + p (J - 1) - p^2 / (2 (K - kappa)) + kappa/2 (J -
//   1)^2.
// For infinite K the stretches stay plain (no J^{-1/3}), so p is then not the mean stress but less than it by
// sum mu (lambda_1^alpha + lambda_2^alpha + lambda_3^alpha)/3.
struct TubeMaterial {
  std::vector<model::OgdenTerm> ogden;
  double bulk_modulus = std::numeric_limits<double>::infinity();  // K [Pa]
  double stabilisation = 0;                                       // kappa [Pa]
  double permittivity = 0;                                        // absolute [F/m]
  int layers = 1;  // of equal reference thickness, electrically in parallel
};

template <int N>
Jet<N> tube_energy(const TubeMaterial& material, const Deformation<N>& f, const Jet<N>& pressure);

// Ideal dielectric at a potential with reference gradient (phi_R, phi_Z): - permittivity/2 J |F^{-T} grad
// phi|^2.
template <int N>
Jet<N> electric_energy(double permittivity, const Deformation<N>& f, const Jet<N>& phi_R,
                       const Jet<N>& phi_Z);

// The same for the field across a wall that keeps its volume, in closed form: between electrodes at the
// reference radii `inner` and `outer`, at the reference radius R between them. With rho = r the current
// radius and l the stretch of the line along Z, the faces are at rho_i^2 = rho^2 - (R^2 - inner^2)/l and so
// on, and the energy per reference volume is - permittivity/2 / (rho ln(rho_o/rho_i))^2.
template <int N>
Jet<N> closed_form_electric_energy(double permittivity, const Deformation<N>& f, double R, double inner,
                                   double outer);

// Leg: W = G/2 (I1 - 3 - 2 ln J) + U(J), with U' = -P(1 - sqrt J) - G (1 - 1/J) and P the inverse of the
// strain law, so that uniform radial compression at fixed length gives paper Eq. (2); or neo-Hookean W = G/2
// (J^{-2/3} I1 - 3) + K/2 (J - 1)^2.
struct LegMaterialLaw {
  model::LegMaterial kind = model::LegMaterial::compliance;
  double shear_modulus = 0;           // G [Pa]
  double bulk_modulus = 0;            // K, neo-Hookean [Pa]
  double a = 0, b = 0, c = 0, d = 0;  // strain law, the variant already chosen [1, 1/Pa]
  // An energy in place of these two: leg materials that other people's exact solutions are for.
  Jet<5> (*other)(const LegMaterialLaw& law, const Deformation<5>& f) = nullptr;
};

LegMaterialLaw leg_material(const model::Leg& leg, const model::Segment& segment);

template <int N>
Jet<N> leg_energy(const LegMaterialLaw& law, const Deformation<N>& f);

// Pressure at which the strain law gives this radial strain, and its derivative. NaN where no pressure does.
// [Pa]
struct PressureOfStrain {
  double pressure = 0;
  double slope = 0;
};
PressureOfStrain pressure_of_strain(const LegMaterialLaw& law, double strain);

}  // namespace gaiter::physics
