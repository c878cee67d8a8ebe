// The arm with one central chamber of "Toward Semi-autonomous Stiffness Adaptation of Pneumatic Soft Robots"
// (slides): a Cosserat rod with the tangent modulus of Mooney-Rivlin rubber, its stiffness k(F, P), as
// printed and as statics has it.
//
// Arm frame: p = 0 at s = 0, z along the tangent there (e_1 of the slides' stiffness matrices). s is the
// arclength of the unpressurised arm.
//
// What the print has:
// - n' = -rho A g - P A e_3. P A is a force, n' a force per length; the term that was meant is P A_ch (R e)',
//   A_ch the area of the chamber, not of the wall (hybrid paper (5), where it returns with the wrong sign).
//   Taken at its word in SI units it pulls the arm with P A newtons per metre along its own tangent, and
//   softens it: k at 20 kPa is 10 % lower for it. In truth gas in a closed chamber balances the tension that
//   it gives the wall, and neither the force nor the moment of a whole section know of it: what remains is
//   the stretch and the modulus there, together +0.5 % of k at 20 kPa where the slides report +74 %.
// - Everything is given at s = 0: u = (1 0 0), v = 0 (swapped; v = (1 0 0), u = 0 must be meant). Then
//   n(0) = m(0) = 0 and the tip force stands nowhere. A clamp and a force at the other end are a
//   boundary-value problem; as an initial-value one it can only be read with n(0) and m(0) of the undeformed
//   arm (kInitialValue), and then nothing makes n(L) the force and m(L) zero.
// - k = d|F| / d|p(L)|: the distance of the tip from the base hardly changes with a small force across the
//   arm (k is infinite at F = 0); its displacement must be meant.
// - T_11, called nominal, is the Cauchy stress, and c_01 stands where C_10 does elsewhere: MooneyRivlin's
//   c10_pa is the slides' c_01 (277 kPa), c01_pa the slides' c_10 (-209 kPa).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "arm/mooney_rivlin.h"
#include "softarm/rod/solver.h"

namespace softarm::published {

/// A round wall around a central chamber, undeformed.
struct Tube {
  double outer_diameter_m = 0.0;
  double inner_diameter_m = 0.0;

  double wall_area_m2() const;
  double chamber_area_m2() const;
  double second_moment_m4() const;  ///< I; 2 I about the axis
};

struct SingleChamberArm {
  Tube section;
  double length_m = 0.0;
  arm::MooneyRivlin material;
  double density_kg_m3 = 0.0;
  Eigen::Vector3d gravity_m_s2 = Eigen::Vector3d::Zero();  ///< arm frame
  /// E_o instead of the material's, the same at every pressure (the stretch by pressure then is linear).
  std::optional<double> modulus_pa;
};

/// The arm of the slides, without gravity (which way it points is not said).
SingleChamberArm slides_arm();

struct SingleChamberLoad {
  Eigen::Vector3d tip_force_n = Eigen::Vector3d::Zero();  ///< dead, arm frame
  double pressure_pa = 0.0;                               ///< gauge
};

/// What the pressure makes of the arm without load.
struct PressurisedArm {
  double stretch = 1.0;                ///< of the wall under the nominal stress P A_ch / A
  double modulus_pa = 0.0;             ///< E_o: tangent modulus there
  double bending_stiffness_nm2 = 0.0;  ///< E_o I; of incompressible rubber also that per stretched length
};
/// @return nothing for properties that are not physical, or where the material has no stable stretch
std::optional<PressurisedArm> pressurise(const SingleChamberArm& arm, double pressure_pa);

/// How the pressure enters, beside E_o.
enum class ChamberLaw {
  kPrinted,  ///< n' = -rho A g - P A e_3(s), a number of N/m for P A in N; v* = 1
  kStatics,  ///< the wall carries P A_ch: v* is the stretch by pressure; n of the whole section
};

enum class ChamberSolution {
  /// n(0), m(0) of the undeformed arm (the sum of F and of all that is in n', with undeformed levers), then
  /// Runge-Kutta of 4th order to the tip.
  kInitialValue,
  /// n(L) = F, m(L) = 0. kStatics by rod::Solver, kPrinted by shooting with the same Runge-Kutta.
  kBoundaryValue,
};

struct ChamberOptions {
  int steps = 100;  ///< of the integration, as in the slides; 4 ... 100000. rod::Solver chooses its own
};

struct SingleChamberShape {
  rod::SolveStatus status = rod::SolveStatus::kInvalidInput;  ///< the rest is empty unless kConverged
  Eigen::VectorXd s_m;                                        ///< steps + 1 nodes
  Eigen::Matrix3Xd p_m;                                       ///< one column per node, arm frame
  /// n(L) - F and m(L): what is left of the conditions at the tip, arm frame. Not zero for kInitialValue.
  Eigen::Vector3d tip_force_error_n = Eigen::Vector3d::Zero();
  Eigen::Vector3d tip_moment_error_nm = Eigen::Vector3d::Zero();
};

SingleChamberShape solve_single_chamber(const SingleChamberArm& arm, const SingleChamberLoad& load,
                                        ChamberLaw law, ChamberSolution solution,
                                        const ChamberOptions& options = {});

/// The tip's answer to a force, weight and pressure held.
struct TipStiffness {
  Eigen::Vector3d displacement_m = Eigen::Vector3d::Zero();  ///< from the tip at no force
  double secant_n_m = 0.0;                                   ///< |F| / |displacement|; at F = 0 the tangent
  double tangent_n_m = 0.0;  ///< d|F| / d|displacement|, the direction of F held
};
/// @param direction of the force, arm frame, any length but 0
/// @param force_n >= 0
/// @return nothing where there is no solution, or the tip does not move
std::optional<TipStiffness> tip_stiffness(const SingleChamberArm& arm, const Eigen::Vector3d& direction,
                                          double force_n, double pressure_pa, ChamberLaw law,
                                          ChamberSolution solution, const ChamberOptions& options = {});

/// k(F, P) at all pairs: one per pressure, then one per force.
std::vector<std::vector<std::optional<TipStiffness>>> stiffness_surface(
    const SingleChamberArm& arm, const Eigen::Vector3d& direction, const std::vector<double>& forces_n,
    const std::vector<double>& pressures_pa, ChamberLaw law, ChamberSolution solution,
    const ChamberOptions& options = {});

}  // namespace softarm::published
