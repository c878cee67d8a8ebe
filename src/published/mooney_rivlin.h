// The tangent modulus of the hybrid paper, (19)-(26), as printed; the uniaxial law it ought to equal is
// MooneyRivlin (softarm/arm/mooney_rivlin.h), which every other part of the code uses.
//
// What the print has:
// - (19) has v_1 on the diagonal, 1 at rest, which makes C = diag(3, 0, 0) there and C^-T impossible. Only
//   v - v* can be meant ("v - v* is the Lagrangian finite strain"), and that is what stands here. It is still
//   not that strain, which is (lambda^2 - 1) / 2 along the axis, and half the angle for shear; u_1 is a twist
//   per length and lacks a radius; bending (u_2, u_3) is absent, so E(P) cannot depend on it.
// - (20) with (19): det C = (1 + 2e)(1 - e)^2 = 1 - 3e^2 + 2e^3 for a pure extension e. (23), det C = 1,
// holds
//   to first order only: 3 % of volume are lost at e = 0.1.
// - (21) and (22) are right, and (22) is the I_2 of (14).
// - (24), called the second Piola-Kirchhoff stress, is the Cauchy stress -p 1 + 2 C10 B - 2 C01 B^-1, with C
//   for B (the same where principal axes do not turn; the sign of the last term is right for Cauchy).
// - (25) makes that stress free of trace. The pressure p* of a bar follows from its free sides instead
//   (sigma_22 = 0); without the trace sigma_11 is 2/3 of the bar's Cauchy stress, and E(P) at no strain is
//   4 (C10 + C01), 2/3 of Young's modulus 6 (C10 + C01).
// - (26) has no term for sigma_11's own C_11, so its sum is not the derivative it is set equal to.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "arm/mooney_rivlin.h"

namespace softarm::published {

/// (19) with v - v* for v. Axis 1 is the rod's axis.
/// @param strain v - v*, axis 1 the extension
/// @param twist u_1 (as printed it has no radius: a pure number only after multiplication by one)
/// @param poisson_ratio theta of (19)
Eigen::Matrix3d published_strain(const Eigen::Vector3d& strain, double twist, double poisson_ratio = 0.5);

/// (21)-(23).
struct Invariants {
  double i1 = 0.0, i2 = 0.0, i3 = 0.0;
};
Invariants invariants(const Eigen::Matrix3d& cauchy_green);

/// (24) with (25), Pa.
/// @param cauchy_green C, see (20)
/// @return nothing where C is not positive definite or not finite
std::optional<Eigen::Matrix3d> published_stress_pa(const arm::MooneyRivlin& material,
                                                   const Eigen::Matrix3d& cauchy_green);

/// What (26) is set equal to: d sigma_11 / d lambda_1 of (24) along the pure extensions of (19)-(20), Pa;
/// lambda_1 = sqrt(1 + 2 strain) is the axial stretch.
/// @return nothing unless -1/2 < strain < 1
std::optional<double> published_modulus_pa(const arm::MooneyRivlin& material, double strain);

/// What (26) says: its two products, with the derivatives of (14) at fixed other stretches, Pa.
/// @return nothing unless -1/2 < strain < 1
std::optional<double> published_chain_rule_modulus_pa(const arm::MooneyRivlin& material, double strain);

}  // namespace softarm::published
