// A dynamic three-dimensional rod, discretised by a global Ritz expansion of its curvature.
//
// The rod is made of pieces in series. In a piece of length L the unknowns q are the coefficients of a cubic
// B-spline for the dimensionless curvature w(sigma) = L u(sigma), three components in the section frame,
// sigma = s / L; the splines of neighbouring pieces are independent, so that curvature, stiffness and
// actuation may jump where they meet. Given w, the rotations follow from exponentials of the Magnus series
// (order 4) and positions from Lobatto quadrature of the tangent. The base may yield: a hinge with a spring,
// whose rotation vector is unknown too.
//
// Sections may differ along a piece and answer bending with laws of their own (section_law.h), whose moments
// are then summed at the Lobatto points; a short piece may answer as a whole. Hoses and walls are forces at
// points (point_load.h).
//
// A piece may also shear and stretch elastically under the dead loads, whose force n at a section is known
// whatever the shape: the tangent is R (e3 + K^-1 R^T n). By the envelope theorem the equations of statics
// keep their form with that tangent. Of the inertia forces, small against the weights, only the moments feel
// it; nor do the forces of hoses and walls stretch the rod.
//
// Time: every material station has a position x and two section directors d1, d2, which carry its mass and
// rotary inertia (like a disc's). Their accelerations are those of backward differences in Cartesian space,
// so that no Coriolis terms appear, and the equations of motion are d'Alembert's principle projected on dq:
//   sum_k J_k(q)^T (m_k a_k - m_k g + c_k v_k) + K(w + tau w') - B M = 0,
// solved by Newton's method with the geometric stiffness of all forces. Third order in time where
// every wall lags by a step at least, else second order and unconditionally stable; fourth order or better in
// space.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "point_load.h"
#include "section_law.h"

namespace softarm::rig {

/// What a section has of its piece's.
struct SectionRatios {
  double bending = 1.0, twist = 1.0;  ///< stiffness
  double actuation = 1.0;             ///< moment
};

/// What does not change of one piece.
struct RodPiece {
  int elements = 6;
  double share = 1.0;  ///< of the rod's material coordinate [0, 1]; they sum to 1
  double mass_kg = 0.2;
  double diameter_m = 0.04;
  double retardation_s = 0.0;
  double mass_slope = 0.0;   ///< the density is 1 - slope ... 1 + slope times its mean, from base to tip
  double end_mass_kg = 0.0;  ///< of a point at its end
  /// By the fraction of the piece; none: all sections are alike.
  std::function<SectionRatios(double)> sections = {};
  std::vector<std::shared_ptr<const SectionLaw>> laws = {};
  /// What the piece answers as a whole: to its mean curvature, with the same moment all along.
  std::shared_ptr<const SectionLaw> stretch = {};
};

/// A force on the end of a piece, or on the whole rod.
struct RodLoad {
  std::shared_ptr<const PointLoad> law;
  std::optional<std::size_t> piece;  ///< absent: along the rod, the law's forces are per length
};

/// What does not change.
struct RitzRodParams {
  std::vector<RodPiece> pieces = std::vector<RodPiece>(1);  ///< from base to tip
  double tip_mass_kg = 0.0;
  double air_damping_n_s_m2 = 0.0;
  Eigen::Vector3d gravity_base_m_s2 = Eigen::Vector3d::Zero();
  std::optional<std::size_t> payload_piece;  ///< the payload hangs at its end; absent: at the tip
  /// Of the payload from the backbone there, in the section frame.
  Eigen::Vector3d payload_offset_section_m = Eigen::Vector3d::Zero();
  /// How the rod stands in the frame of the clamp.
  Eigen::Quaterniond base_attitude = Eigen::Quaterniond::Identity();
  /// The base turns by (bending) moment over this, N m / rad, with the first piece's retardation. Absent:
  /// rigid.
  std::optional<double> base_stiffness_nm_per_rad;
  /// So far the base turns freely, but for a hundredth of its stiffness.
  double base_play_rad = 0.0;
  /// With play: hardly held within it, and beyond it by Hertz's law.
  bool base_bush = false;
  std::vector<RodLoad> loads;
  /// The draught grows with the fraction, and the inputs have that of the tip; else it is the same all along.
  bool draught_grows = false;
  /// Sections answer with kinks, as a core that slips does: steps of the second order at most, and each is
  /// corrected until a correction is small itself, not until the next one should be.
  bool kinked = false;
};

/// What may change of one piece from step to step.
struct PieceInputs {
  double length_m = 0.2;
  double bending_stiffness_nm2 = 0.03;
  double torsional_stiffness_nm2 = 0.03;
  Eigen::Vector3d moment_section_nm =
      Eigen::Vector3d::Zero();  ///< actuation, uniform, turning with the sections
  /// Against the loads; absent: rigid. length_m is that without loads.
  std::optional<double> shear_stiffness_n, axial_stiffness_n;
  double core_stiffness_nm2 = 0.0;  ///< the part of the bending stiffness that a jammed core gives
};

/// What may change from step to step.
struct RitzRodInputs {
  std::vector<PieceInputs> pieces = std::vector<PieceInputs>(1);
  double payload_kg = 0.0;          ///< point mass
  double hand_damping_n_s_m = 0.0;  ///< force against the velocity of the payload's place
  Eigen::Vector3d tip_force_base_n = Eigen::Vector3d::Zero();  ///< dead load
  /// Per length; what of it is along the rod does nothing.
  Eigen::Vector3d draught_base_n_per_m = Eigen::Vector3d::Zero();
};

/// The rod's state at one instant and how to advance it. Everything is in the frame of the clamp (base
/// frame). A fraction is one of the material coordinate: piece by piece, of its length.
class RitzRod {
 public:
  /// @throws std::invalid_argument for pieces that are none or do not sum to 1
  explicit RitzRod(const RitzRodParams& params);
  ~RitzRod();
  RitzRod(RitzRod&&) noexcept;
  RitzRod& operator=(RitzRod&&) noexcept;

  /// Goes to static equilibrium, reached by increasing all loads from zero, and forgets all motion.
  /// @return false if none was found; the state is then unchanged.
  /// @throws std::invalid_argument if the inputs are for another number of pieces
  bool settle(const RitzRodInputs& inputs);

  /// Advances by dt; the inputs are those at the end of the step. The first step of another length than the
  /// last one's is of first order only.
  /// @return false if Newton's method failed; the state is then unchanged.
  /// @throws std::invalid_argument if the inputs are for another number of pieces
  bool step(const RitzRodInputs& inputs, double dt_s);

  /// Position and orientation of the section at a fraction.
  Eigen::Isometry3d pose(double fraction) const;
  Eigen::Vector3d velocity(double fraction) const;
  /// Curvature and torsion u (1/m) in the section frame; where pieces meet, of the distal one.
  Eigen::Vector3d curvature(double fraction) const;
  /// How far the base is turned, a rotation vector in the frame of the clamp (rad).
  Eigen::Vector3d base_rotation() const;

  /// Kinetic + elastic + gravity energy - work of the actuation moment and of the tip's dead load, for the
  /// inputs of the last step. Laws and loads count with what they store.
  double energy_j() const;

  /// Newton iterations of the last solution.
  int last_iterations() const;
  std::size_t coefficient_count() const;
  const Eigen::VectorXd& coefficients() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace softarm::rig
