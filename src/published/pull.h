// The papers' own procedure: stiffness from the bending angle before and after a known force.
//
// Semi-physical paper, section 4.1: three ground truths per condition, the length and the bending angle of
// the circle from base to tip, and the stiffness from the change of that angle under a known force at the
// tip, by (2) and (17); then a least-squares fit of the laws to the three. Beside it what exact statics make
// of the same measurements.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "published.h"
#include "softarm/arm/arm.h"
#include "softarm/identify/identify.h"

namespace softarm::published {

/// The circle that leaves the base along z and passes through a tip.
struct Circle {
  double length_m = 0.0;
  double angle_rad = 0.0;      ///< bending angle theta, 0 ... 2 pi
  double direction_rad = 0.0;  ///< phi of the plane
};
Circle circle_through(const Eigen::Vector3d& tip_p_base);

/// Turn of the tip times EI, N m^2 rad, by a vertical force at the tip of an arm bent to a circle: the
/// integral of its moment over the length. kPrinted: (17), F sin theta(L) [x(L) - x(s)] cos phi; kStatics:
/// the moment of a dead force, F [x(L) - x(s)] cos phi.
/// @param force_n vertical, towards the bending (down on an arm that stands)
/// @param azimuth_rad between the force's plane and the plane of bending
double force_turn_times_stiffness(const Circle& circle, double force_n, LoadLaw law,
                                  double azimuth_rad = 0.0);
/// The same of the arm's own weight: kPrinted is (14), kStatics that of dead weights.
double weight_turn_times_stiffness(const Circle& circle, double weight_n, LoadLaw law);

/// EI by (2) and (17) on circles, the moment taken on the loaded shape; nothing where the angle changes
/// against the force or not at all.
std::optional<double> stiffness_on_circles(const Circle& before, const Circle& after, double force_n,
                                           LoadLaw law, double azimuth_rad = 0.0);

/// EI by exact statics from a force that stays perpendicular to the tip's tangent, in the plane of bending,
/// of an arm without weight: the paper's force sensor. Angles are those of circles through base and tip.
/// @param force_n > 0 bends further
/// @return nothing where no stiffness between 1e-6 and 1e3 N m^2 gives the change
std::optional<double> stiffness_from_perpendicular_force(double length_m, double angle_before_rad,
                                                         double angle_after_rad, double force_n);

/// Two loads at the same inputs.
struct Pull {
  std::size_t trial = 0;
  double stamp_s = 0.0;  ///< of the first frame under the second load
  arm::InputValues inputs;
  double payload_before_kg = 0.0, payload_after_kg = 0.0;
  bool upright = false;  ///< the base stands or hangs: the formulas on circles hold
  bool hanging = false;
  Circle before, after;
  std::optional<double> stiffness_printed_nm2;  ///< arms that stand or hang
  std::optional<double> stiffness_circles_nm2;  ///< with the moment of a dead force
  /// Moment, EI and length by exact statics from all bodies; absent where that fit does not converge, too.
  std::optional<double> stiffness_exact_nm2;
  double sd_exact_nm2 = 0.0;  ///< of the noise
};

/// The steps of the payload at held inputs that the trials contain, each from the mean of the frames at rest
/// before and after it. Arms of one segment with a body at the tip.
/// @throws std::invalid_argument for other arms
std::vector<Pull> find_pulls(const arm::Arm& arm, const std::vector<trial::Trial>& trials);

/// Least squares of the pneumatic laws to the three ground truths, each by itself as in the paper: lengths
/// give the elongations (near plus far), stiffnesses b1 to b3, moments (angle times stiffness over length,
/// less that of the weight) the gains.
struct ThreeTruths {
  arm::Arm arm;
  std::size_t pulls = 0;      ///< with a stiffness
  double length_rms_m = 0.0;  ///< what the fit leaves
  double stiffness_rms_nm2 = 0.0;
  double moment_rms_nm = 0.0;
};
/// @param exact stiffness by exact statics instead of the law on circles
/// @throws std::invalid_argument for other arms than of one segment driven by chambers alone, or too few
/// pulls
ThreeTruths fit_three_truths(const arm::Arm& arm, const std::vector<Pull>& pulls, LoadLaw law, bool exact);

std::string describe(const arm::Arm& arm, const std::vector<trial::Trial>& trials,
                     const std::vector<Pull>& pulls);

}  // namespace softarm::published
