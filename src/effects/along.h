// Along the arm: how a stretch of it falls on the pieces, and where a point of it is.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "model/effect.h"

namespace softarm::effects {

/// Shares by which pieces change so that the whole turns as if the stretch [from, to] alone had changed by 1:
/// sums over the pieces of share times length, and of share times length times place, are those of the
/// stretch. Where it ends within a piece, that piece and a neighbour share it.
Eigen::VectorXd cover(const model::FineRod& fine, double from_m, double to_m);

/// The same for a stretch at an end of the arm, [0, length] or the last `length`: no share is above 1.
Eigen::VectorXd cap_at_base(const model::FineRod& fine, double length_m);
Eigen::VectorXd cap_at_tip(const model::FineRod& fine, double length_m);

/// The turn of angle |v| towards (v.x, v.y) of something that points along z: about (-v.y, v.x, 0).
inline Eigen::Vector3d turn_towards(double x, double y) {
  return {-y, x, 0.0};
}

}  // namespace softarm::effects
