// The planar arm of the online paper, equations (1)-(6), with its fixed-point iteration.
//
// Beside Solver, the exact statics and the default everywhere. This is here to reproduce the papers and to
// show what their load moments do: with kStatics the same iteration on the same nodes uses the moments of
// dead weights, so the load law alone makes the difference. doc/published_model.md has figures.
//
// Arm frame: p = 0 at s = 0, z along the tangent there, theta >= 0 the angle of the tangent from z, w the
// deflection, towards direction_rad from x. Gravity is along -z (standing) or +z (hanging).
#pragma once

#include <Eigen/Core>

#include "softarm/rod/solver.h"

namespace softarm::published {

/// The moments that the loads add to M_0 at s; a bending arm that stands is bent further by them.
enum class LoadLaw {
  /// As printed. Online paper (2): F sin theta(L) [w(L) - w(s)]; (3): W/L times the integral over r, from s
  /// to L, of sin theta(r) [w(L) - w(r)]: every s of the printed integrand is the variable of integration.
  kPrinted,
  /// Dead vertical forces: F [w(L) - w(s)], and W/L times the integral over r from s to L of [w(r) - w(s)].
  kStatics,
};

/// Where the arm points at its base. The papers' equations hold for one that stands ("pointing straight
/// upwards at s = 0", semi-physical paper, 2.5): the loads add to the actuation. Of an arm that hangs they
/// pull the bend straight; the same moments are then subtracted.
enum class Mounting { kStanding, kHanging };

struct PublishedArm {
  double moment_nm = 0.0;              ///< M_0 >= 0; the other way is direction_rad + pi
  double direction_rad = 0.0;          ///< phi, bending direction
  double bending_stiffness_nm2 = 0.0;  ///< EI > 0
  double length_m = 0.0;               ///< L > 0
  double payload_n = 0.0;              ///< F >= 0, weight at the tip
  double weight_n = 0.0;               ///< W >= 0, the arm's own, spread evenly
  Mounting mounting = Mounting::kStanding;
};

struct PublishedOptions {
  int nodes = 100;  ///< equally spaced, both ends included; integrals by the trapezoidal rule; 3 ... 1e6
  double relaxation = 1.0;   ///< share of each update that is applied, (0, 1]; 1: as printed
  int max_iterations = 300;  ///< >= 1; evaluations of the moments
  /// > 0; converged when no node's curvature would change by more than this over the length, |dk| L, rad
  double tolerance_rad = 1e-9;
};

struct PublishedShape {
  /// kNoConvergence: the iteration did not settle (mostly it comes to alternate between two shapes). The
  /// vectors are empty unless kConverged.
  rod::SolveStatus status = rod::SolveStatus::kInvalidInput;
  int iterations = 0;                  ///< evaluations of the moments
  double largest_tip_angle_rad = 0.0;  ///< |theta(L)| met on the way; the paper asks for less than pi
  Eigen::VectorXd s_m;                 ///< nodes, m
  Eigen::VectorXd theta_rad;           ///< (4)
  Eigen::VectorXd w_m;                 ///< (5)
  Eigen::VectorXd curvature_per_m;     ///< (1)
  Eigen::Matrix3Xd p_m;                ///< (6), one column per node, arm frame
};

/// Fixed-point iteration of II.A: the circle of M_0 alone; then again and again moments from the last shape
/// and curvature from the moments. The error in position is of second order in the node spacing.
PublishedShape solve_published(const PublishedArm& arm, LoadLaw law, const PublishedOptions& options = {});

/// A relaxation with which the iteration settles, for both laws, where 1 (as printed) need not: 1 / (1 + a),
/// a = 4 F L^2 / (pi^2 EI) + W L^2 / (7.8373 EI) being the loads over those that buckle the straight arm. An
/// arm that hangs answers a change of its curvature by one -a times as large, hence the divergence for a > 1.
/// No proof covers large bending; loads far beyond the papers' need more than the default iterations.
/// @returns 1 for loads or properties that are not physical
double settling_relaxation(const PublishedArm& arm);

}  // namespace softarm::published
