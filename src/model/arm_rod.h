// The solution of an arm's rod as every fit of the arm looks at it: which of the rod's parameters there are,
// where the bodies are, and how both follow. A fit, whatever its unknowns x are, adds d (rod's parameters) /
// d x.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/rod/solver.h"

namespace softarm::model {

/// Columns of a segment among segment_parameters(). Bending towards the azimuth (a, b) is a turn about (-b,
/// a), so a moment of actuation (a, b) is the rod's (-b, a).
enum SegmentColumn { kMomentX, kMomentY, kBendingCompliance, kLengthColumn, kSegmentColumns };
/// What inputs and fits always change of a rod, segment by segment in the order of SegmentColumn.
std::vector<rod::Parameter> segment_parameters(const arm::Arm& arm);

/// Where the bodies sit, m from the base, in the order of Arm::bodies: the first stations of every solver.
std::vector<double> body_stations(const arm::Arm& arm);

/// Positions to a thousandth of what cameras see.
/// @param orientation_tolerance_rad of the base; where differences of solutions are taken, finer than where
/// none are
rod::SolverOptions solver_options(double orientation_tolerance_rad, double position_tolerance = 1e-6);

/// Derivatives of one body by the rod's parameters, 3 x P. @param body its index, which is its station, too
Eigen::Matrix3Xd position_by_rod(const arm::MeasuredBody& measured, int body, const rod::Solver& solver);
Eigen::Matrix3Xd tangent_by_rod(int body, const rod::Solver& solver);

/// Whether the solution is so near a buckling load that shapes follow EI closely, and with EI all that a
/// model leaves out: tip's turn per turn of the base, norm, 1.7 for a stiff rod and without bound at the load
/// itself, of four or more.
bool near_buckling(const rod::Solver& solver);

/// An equilibrium that others are looked for from.
struct Equilibrium {
  Eigen::Quaterniond q_tip = Eigen::Quaterniond::Identity();
  Eigen::VectorXd x;          ///< unknowns there
  Eigen::Matrix3Xd tip_by_x;  ///< turn of the tip per unit of each

  /// The tip as it should be at x, to first order; nothing where it would turn by more than this.
  std::optional<Eigen::Quaterniond> tip_at(const Eigen::VectorXd& at, double most_rad) const;
};

}  // namespace softarm::model
