// Forces on the rod that depend on where it is and how it moves: hoses, walls.
#pragma once

#include <Eigen/Core>

namespace softarm::rig {

/// Force on a point of the backbone, in the frame of the clamp, and minus its derivatives.
struct PointForce {
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
  Eigen::Matrix3d stiffness_n_per_m = Eigen::Matrix3d::Zero();  ///< - d force / d position
  Eigen::Matrix3d damping_n_s_per_m = Eigen::Matrix3d::Zero();  ///< - d force / d velocity
  double stored_j = 0.0;
};

/// A law of force. For a load along the rod, all of it is per length.
class PointLoad {
 public:
  virtual ~PointLoad() = default;
  /// @param position, velocity of the point in the frame of the clamp; in statics the velocity is zero
  virtual PointForce at(const Eigen::Vector3d& position, const Eigen::Vector3d& velocity) const = 0;
};

}  // namespace softarm::rig
