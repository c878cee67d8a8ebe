#include "point_loads.h"

#include <cmath>

#include "ramp.h"

namespace softarm::rig {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

class Spring : public PointLoad {
 public:
  Spring(const Vector3d& anchor, double stiffness) : anchor_(anchor), stiffness_(stiffness) {}
  PointForce at(const Vector3d& x, const Vector3d&) const override {
    PointForce f;
    f.force_n = stiffness_ * (anchor_ - x);
    f.stiffness_n_per_m = stiffness_ * Matrix3d::Identity();
    f.stored_j = 0.5 * stiffness_ * (anchor_ - x).squaredNorm();
    return f;
  }

 private:
  Vector3d anchor_;
  double stiffness_;
};

class Hose : public PointLoad {
 public:
  Hose(const Vector3d& anchor, double length, double stiffness, const Vector3d& weight)
      : anchor_(anchor), length_(length), stiffness_(stiffness), weight_(weight) {}
  PointForce at(const Vector3d& x, const Vector3d&) const override {
    constexpr double kOnsetM = 2e-3;
    PointForce f;
    f.force_n = 0.5 * weight_;
    f.stored_j = -0.5 * weight_.dot(x);
    const Vector3d away = x - anchor_;
    const double distance = away.norm();
    const Ramp ramp(distance - length_, kOnsetM);
    if (ramp.value > 0.0) {
      const Vector3d along = away / distance;
      f.force_n -= stiffness_ * ramp.value * along;
      f.stiffness_n_per_m = stiffness_ * (ramp.value / distance * Matrix3d::Identity() +
                                          (ramp.slope - ramp.value / distance) * along * along.transpose());
      f.stored_j += stiffness_ * ramp.integral;
    }
    return f;
  }

 private:
  Vector3d anchor_;
  double length_, stiffness_;
  Vector3d weight_;
};

class SpringWall : public PointLoad {
 public:
  SpringWall(const Plane& wall, double stiffness) : wall_(wall), stiffness_(stiffness) {}
  PointForce at(const Vector3d& x, const Vector3d&) const override {
    constexpr double kOnsetM = 2e-4;
    const Ramp ramp(wall_.normal.dot(x) - wall_.distance_m, kOnsetM);
    PointForce f;
    f.force_n = -stiffness_ * ramp.value * wall_.normal;
    f.stiffness_n_per_m = stiffness_ * ramp.slope * wall_.normal * wall_.normal.transpose();
    f.stored_j = stiffness_ * ramp.integral;
    return f;
  }

 private:
  Plane wall_;
  double stiffness_;
};

class Rough : public PointLoad {
 public:
  explicit Rough(const RoughWall& wall) : wall_(wall) {}
  PointForce at(const Vector3d& x, const Vector3d& v) const override {
    constexpr double kUnitM = 1e-3, kSlowMPerS = 1e-3;
    PointForce f;
    const Vector3d& n = wall_.plane.normal;
    const double depth = n.dot(x) - wall_.plane.distance_m;
    if (depth <= 0.0) return f;
    const double root = std::sqrt(depth / kUnitM), elastic = wall_.stiffness_n_per_m * depth * root;
    const double factor = std::max(0.0, 1.0 + wall_.damping_s_per_m * n.dot(v));
    const double push = elastic * factor;
    const double by_depth = 1.5 * wall_.stiffness_n_per_m * root * factor;
    const double by_rate = factor > 0.0 ? elastic * wall_.damping_s_per_m : 0.0;
    const Vector3d slip = v - n.dot(v) * n;
    const double speed = std::sqrt(slip.squaredNorm() + kSlowMPerS * kSlowMPerS);
    const Vector3d direction = n + wall_.friction * slip / speed;  // minus the force's, per push
    f.force_n = -push * direction;
    f.stiffness_n_per_m = by_depth * direction * n.transpose();
    f.damping_n_s_per_m =
        by_rate * direction * n.transpose() +
        push * wall_.friction / speed *
            (Matrix3d::Identity() - n * n.transpose() - slip * slip.transpose() / (speed * speed));
    f.stored_j = 0.4 * elastic * depth;
    return f;
  }

 private:
  RoughWall wall_;
};

class RoundPost : public PointLoad {
 public:
  explicit RoundPost(const Post& post) : post_(post) {}
  PointForce at(const Vector3d& x, const Vector3d& v) const override {
    constexpr double kOnsetM = 2e-3, kSlowMPerS = 2e-3;
    PointForce f;
    const Vector3d out(x.x() - post_.centre_m.x(), x.y() - post_.centre_m.y(), 0.0);
    const double distance = out.norm();
    const Ramp ramp(post_.radius_m - distance, kOnsetM);
    if (ramp.value <= 0.0 || distance <= 0.0) return f;
    const double push = post_.stiffness_n_per_m * ramp.value;
    const Vector3d n = out / distance, slip = v - n.dot(v) * n;
    const double speed = std::sqrt(slip.squaredNorm() + kSlowMPerS * kSlowMPerS);
    const double per_slip = post_.friction / speed + post_.drag_s_per_m;
    f.force_n = push * (n - per_slip * slip);
    const Vector3d around(-n.y(), n.x(), 0.0);
    const Matrix3d turn = around * around.transpose() / distance;  // of n
    const Matrix3d slip_by_x = -n.dot(v) * turn - n * (v.transpose() * turn);
    const Matrix3d drag =
        per_slip * Matrix3d::Identity() - post_.friction / (speed * speed * speed) * slip * slip.transpose();
    f.stiffness_n_per_m = post_.stiffness_n_per_m * ramp.slope * (n - per_slip * slip) * n.transpose() +
                          push * (drag * slip_by_x - turn);
    f.damping_n_s_per_m = push * drag * (Matrix3d::Identity() - n * n.transpose());
    f.stored_j = post_.stiffness_n_per_m * ramp.integral;
    return f;
  }

 private:
  Post post_;
};

}  // namespace

PointLoadPtr spring_to(const Vector3d& anchor_m, double stiffness_n_per_m) {
  return std::make_shared<Spring>(anchor_m, stiffness_n_per_m);
}
PointLoadPtr hose_to(const Vector3d& anchor_m, double length_m, double stiffness_n_per_m,
                     const Vector3d& weight_n) {
  return std::make_shared<Hose>(anchor_m, length_m, stiffness_n_per_m, weight_n);
}
PointLoadPtr spring_wall(const Plane& wall, double stiffness_n_per_m) {
  return std::make_shared<SpringWall>(wall, stiffness_n_per_m);
}
PointLoadPtr rough_wall(const RoughWall& wall) {
  return std::make_shared<Rough>(wall);
}
PointLoadPtr round_post(const Post& post) {
  return std::make_shared<RoundPost>(post);
}

}  // namespace softarm::rig
