// From curvature coefficients to rotations, positions and their derivatives: private to the rig.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "rod_mesh.h"

namespace softarm::rig {

/// Rotation, and its derivatives, of a rod whose dimensionless curvature w = L u is a spline in each piece of
/// length L, on a base that may turn by the rotation vector of the first three coefficients.
///
/// R' = R [w]x is integrated over each interval between stations with the Magnus expansion of order 4 (two
/// Gauss points). Blanes, Casas, Oteo, Ros, "The Magnus expansion and some of its applications", Phys. Rep.
/// 470 (2009).
struct BackboneKinematics {
  using Vectors = std::vector<Eigen::Vector3d>;
  using LocalJacobian = Eigen::Matrix<double, 3, 12>;
  /// What the curvature at the two Gauss points of an interval turns.
  struct GaussTurns {
    Eigen::Matrix3d first, second;
  };

  /// @param base_attitude of the first section, before the base turns
  BackboneKinematics(const RodMesh& mesh, const Eigen::Quaterniond& base_attitude);

  /// Rotations, what turns them, and positions.
  /// @param q coefficients, three components of function m at 3 m ... 3 m + 2
  /// @param lengths_m of the pieces
  /// @param load scale of node_forces
  void update(const RodMesh& mesh, const Eigen::VectorXd& q, const std::vector<double>& lengths_m,
              double load);

  /// A moment's work on the 12 local coefficients of an interval: what turns_of() gives, transposed, times
  /// it.
  Eigen::Matrix<double, 12, 1> work_of(const RodMesh& mesh, int interval,
                                       const Eigen::Vector3d& moment) const;
  /// Interval k, between stations k and k + 1: what a change of the 12 local coefficients (from 3 * its
  /// element's first function on) turns station k + 1 against station k, as a rotation vector in the base
  /// frame.
  LocalJacobian turns_of(const RodMesh& mesh, int interval) const;

  /// rotation_jacobian and position_jacobian of all stations, from the last update().
  void update_jacobians(const RodMesh& mesh, const std::vector<double>& lengths_m);

  /// Rotation of the section and position at any place.
  Eigen::Matrix3d rotation_at(const RodMesh& mesh, const Eigen::VectorXd& q, const RodPlace& place) const;
  Eigen::Vector3d position_at(const RodMesh& mesh, const std::vector<double>& lengths_m,
                              const RodPlace& place) const;

  Eigen::Matrix3d base;  ///< attitude of the first section, before the base turns
  /// Per piece, 1/N: strain (shear, shear, stretch) of the backbone in the section frame per force there.
  Vectors compliances;
  /// Per node, i.e. Lobatto point of an element (kPoints * element + point): the static force that the rod
  /// transmits, N, base frame. Neighbouring elements have nodes of their own: it may jump.
  Vectors node_forces;

  Vectors tangents;                        ///< per node: derivative of the position by arclength at no strain
  std::vector<Eigen::Matrix3d> rotations;  ///< per station
  Vectors positions;                       ///< per station, m, base frame
  std::vector<GaussTurns> turns;           ///< per interval, in the base frame
  /// What a change of the base's rotation vector turns; its z component is held.
  Eigen::Matrix3d base_turn = Eigen::Matrix3d::Zero();
  /// 3 stations x coefficients: rotation vector in the base frame, and position, per coefficient.
  Eigen::MatrixXd rotation_jacobian, position_jacobian;
};

/// Rotation matrix of a rotation vector.
Eigen::Matrix3d rotation_of(const Eigen::Vector3d& rotation_vector);

/// The matrix of v x (.).
Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v);

}  // namespace softarm::rig
