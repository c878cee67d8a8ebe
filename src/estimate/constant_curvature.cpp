#include "constant_curvature.h"

#include <cmath>

#include "math/so3.h"

namespace softarm::estimate {

using Eigen::Vector3d;

Eigen::VectorXd constant_curvature_through(const arm::Arm& arm, const Problem& problem,
                                           const std::vector<int>& end_bodies) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(problem.NumParameters());
  Eigen::Isometry3d end = Eigen::Isometry3d::Identity();
  for (int i = 0; i < static_cast<int>(end_bodies.size()); ++i) {
    const double rest = problem.rest_length(i);
    const Vector3d& at_rest = arm.segments[static_cast<std::size_t>(i)].rest_curvature_per_m;
    x[Problem::column(i, 2)] = 1.0;
    x[Problem::column(i, 3)] = 1.0;
    for (const Observation& o : problem.observations()) {
      if (o.body != end_bodies[static_cast<std::size_t>(i)]) continue;
      const Vector3d chord = end.inverse() * o.p;
      const double across = std::hypot(chord.x(), chord.y());
      const double half = std::atan2(across, chord.z());  // half the arc's angle
      const double length = chord.norm() * (half > 1e-8 ? half / std::sin(half) : 1.0);
      const Vector3d curvature =
          across > 0.0 ? Vector3d(2.0 * half / length * Vector3d(-chord.y(), chord.x(), 0.0) / across)
                       : Vector3d(Vector3d::Zero());
      x[Problem::column(i, 0)] = (curvature.y() - at_rest.y()) * rest;
      x[Problem::column(i, 1)] = -(curvature.x() - at_rest.x()) * rest;
      x[Problem::column(i, 3)] = length / rest;
      end.translation() = o.p;
      end.linear() =
          (Eigen::Quaterniond(end.linear()) * math::exp_so3(curvature * length)).toRotationMatrix();
    }
  }
  return x;
}

Eigen::Quaterniond constant_curvature_tip(const Problem& problem, const Eigen::VectorXd& x) {
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  const int segments = (problem.NumParameters() - 1) / kSegmentParameters;
  for (int i = 0; i < segments; ++i) {
    const rod::Segment& segment = problem.rod().segments[static_cast<std::size_t>(i)];
    const Vector3d u =
        segment.rest_curvature_per_m +
        Vector3d(-x[Problem::column(i, 1)], x[Problem::column(i, 0)], 0.0) / segment.rest_length_m;
    q = q * math::exp_so3(u * (x[Problem::column(i, 3)] * segment.rest_length_m));
  }
  return q.normalized();
}

}  // namespace softarm::estimate
