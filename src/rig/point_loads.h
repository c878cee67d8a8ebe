// The forces from outside that can be hidden at an arm: private to the rig.
#pragma once

#include <memory>

#include "point_load.h"

namespace softarm::rig {

using PointLoadPtr = std::shared_ptr<const PointLoad>;

/// A linear spring to an anchor.
PointLoadPtr spring_to(const Eigen::Vector3d& anchor_m, double stiffness_n_per_m);

/// A hose to an anchor: half of its weight hangs here, and it pulls, as a spring, only when the anchor is
/// further than its length. Sets in over 2 mm.
PointLoadPtr hose_to(const Eigen::Vector3d& anchor_m, double length_m, double stiffness_n_per_m,
                     const Eigen::Vector3d& weight_n);

/// A plane: normal . x = distance, the normal (unit) points into the wall.
struct Plane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();
  double distance_m = 0.0;
};

/// A smooth wall that pushes back as a one-sided spring. Sets in over 0.2 mm.
PointLoadPtr spring_wall(const Plane& wall, double stiffness_n_per_m);

/// A rough wall: pushes with k p (p / 1 mm)^1/2 (1 + c dp/dt) at a penetration p, the law of K. H. Hunt and
/// F. R. E. Crossley (J. Appl. Mech. 42, 1975) with Hertz's exponent 3/2; never pulls. Coulomb friction,
/// regularised below 1 mm/s.
struct RoughWall {
  Plane plane;
  double stiffness_n_per_m = 0.0;  ///< k: of the secant at 1 mm
  double damping_s_per_m = 0.0;    ///< c
  double friction = 0.0;
};
PointLoadPtr rough_wall(const RoughWall& wall);

/// A round post along z, padded: pushes back as a one-sided spring that sets in over 2 mm, and drags along
/// its skin with Coulomb friction, regularised below 2 mm/s, and more the faster the slip.
struct Post {
  Eigen::Vector2d centre_m = Eigen::Vector2d::Zero();
  double radius_m = 0.0, stiffness_n_per_m = 0.0;
  double friction = 0.0, drag_s_per_m = 0.0;  ///< over the push: friction + drag * speed
};
PointLoadPtr round_post(const Post& post);

}  // namespace softarm::rig
