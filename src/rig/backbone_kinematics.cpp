#include "backbone_kinematics.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace softarm::rig {
namespace {

constexpr double kSqrt3Over12 = 0.14433756729740643;

Eigen::Vector3d strain(const Eigen::VectorXd& q, int element, const LocalBasis& basis) {
  Eigen::Vector3d w = Eigen::Vector3d::Zero();
  for (int m = 0; m < 4; ++m) w += basis[static_cast<std::size_t>(m)] * q.segment<3>(3 * (element + m));
  return w;
}

/// Left Jacobian of SO(3): d exp(Omega) exp(-Omega) = J dOmega.
Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& omega) {
  const double angle2 = omega.squaredNorm();
  double a = 0.0, b = 0.0;
  if (angle2 < 1e-6) {
    a = 0.5 - angle2 / 24.0;
    b = 1.0 / 6.0 - angle2 / 120.0;
  } else {
    const double angle = std::sqrt(angle2);
    a = (1.0 - std::cos(angle)) / angle2;
    b = (angle - std::sin(angle)) / (angle2 * angle);
  }
  const Eigen::Matrix3d hat = cross_matrix(omega);
  return Eigen::Matrix3d::Identity() + a * hat + b * hat * hat;
}

}  // namespace

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

Eigen::Matrix3d rotation_of(const Eigen::Vector3d& rotation_vector) {
  const double angle2 = rotation_vector.squaredNorm();
  double a = 0.0, b = 0.0;
  if (angle2 < 1e-6) {
    a = 1.0 - angle2 / 6.0 * (1.0 - angle2 / 20.0);
    b = 0.5 - angle2 / 24.0 * (1.0 - angle2 / 30.0);
  } else {
    const double angle = std::sqrt(angle2);
    a = std::sin(angle) / angle;
    b = (1.0 - std::cos(angle)) / angle2;
  }
  const Eigen::Matrix3d hat = cross_matrix(rotation_vector);
  return Eigen::Matrix3d::Identity() + a * hat + b * hat * hat;
}

BackboneKinematics::BackboneKinematics(const StrainBasis& basis)
    : rotations(static_cast<std::size_t>(basis.stations()), Eigen::Matrix3d::Identity()),
      positions(static_cast<std::size_t>(basis.stations()), Eigen::Vector3d::Zero()),
      turns(static_cast<std::size_t>(basis.stations()) - 1),
      rotation_jacobian(Eigen::MatrixXd::Zero(3 * basis.stations(), 3 * basis.functions())),
      position_jacobian(Eigen::MatrixXd::Zero(3 * basis.stations(), 3 * basis.functions())) {}

void BackboneKinematics::update(const StrainBasis& basis, const Eigen::VectorXd& q, double length_m) {
  constexpr int kIntervals = StrainBasis::kIntervals;
  const double size = basis.element_size();
  for (int e = 0; e < basis.elements(); ++e) {
    for (int i = 0; i < kIntervals; ++i) {
      const auto k = static_cast<std::size_t>(e * kIntervals + i);
      const auto& [b1, b2] = basis.at_gauss(e, i);
      const double h = size * (basis.points()[static_cast<std::size_t>(i) + 1] -
                               basis.points()[static_cast<std::size_t>(i)]);
      const Eigen::Vector3d w1 = strain(q, e, b1), w2 = strain(q, e, b2);
      const double c = kSqrt3Over12 * h * h;
      const Eigen::Vector3d omega = 0.5 * h * (w1 + w2) + c * w1.cross(w2);
      rotations[k + 1].noalias() = rotations[k] * rotation_of(omega);

      const Eigen::Matrix3d outer = rotations[k] * left_jacobian(omega);
      const Eigen::Matrix3d a1 = outer * (0.5 * h * Eigen::Matrix3d::Identity() - c * cross_matrix(w2));
      const Eigen::Matrix3d a2 = outer * (0.5 * h * Eigen::Matrix3d::Identity() + c * cross_matrix(w1));
      for (int m = 0; m < 4; ++m)
        turns[k].middleCols<3>(3 * m) =
            b1[static_cast<std::size_t>(m)] * a1 + b2[static_cast<std::size_t>(m)] * a2;
    }
    const auto first = static_cast<std::size_t>(e * kIntervals);
    for (int i = 1; i <= kIntervals; ++i) {
      Eigen::Vector3d p = positions[first];
      for (int j = 0; j <= kIntervals; ++j)
        p += length_m * size * basis.integration()(i, j) *
             rotations[first + static_cast<std::size_t>(j)].col(2);
      positions[first + static_cast<std::size_t>(i)] = p;
    }
  }
}

void BackboneKinematics::update_jacobians(const StrainBasis& basis, double length_m) {
  constexpr int kIntervals = StrainBasis::kIntervals;
  Eigen::MatrixXd tangents(3 * StrainBasis::kPoints, 3 * basis.functions());
  for (int e = 0; e < basis.elements(); ++e) {
    // Only coefficients up to this element's own matter for its stations.
    const int columns = 3 * (e + 4), first = e * kIntervals;
    for (int i = 0; i < kIntervals; ++i) {
      const int k = first + i;
      auto next = rotation_jacobian.block(3 * (k + 1), 0, 3, columns);
      next = rotation_jacobian.block(3 * k, 0, 3, columns);
      next.rightCols<12>() += turns[static_cast<std::size_t>(k)];
    }
    for (int j = 0; j <= kIntervals; ++j)
      tangents.block(3 * j, 0, 3, columns).noalias() =
          -cross_matrix(rotations[static_cast<std::size_t>(first + j)].col(2)) *
          rotation_jacobian.block(3 * (first + j), 0, 3, columns);
    const double scale = length_m * basis.element_size();
    for (int i = 1; i <= kIntervals; ++i) {
      auto row = position_jacobian.block(3 * (first + i), 0, 3, columns);
      row = position_jacobian.block(3 * first, 0, 3, columns);
      for (int j = 0; j <= kIntervals; ++j)
        row += scale * basis.integration()(i, j) * tangents.block(3 * j, 0, 3, columns);
    }
  }
}

Eigen::Matrix3d BackboneKinematics::rotation_at(const StrainBasis& basis, const Eigen::VectorXd& q,
                                                double fraction) const {
  const int e = basis.element_of(fraction);
  const double xi = fraction * basis.elements() - e;
  int i = 0;
  while (i + 1 < StrainBasis::kIntervals && basis.points()[static_cast<std::size_t>(i) + 1] <= xi) ++i;
  const double from = (e + basis.points()[static_cast<std::size_t>(i)]) * basis.element_size();
  const double h = fraction - from, offset = 0.5 * h / std::sqrt(3.0);
  const Eigen::Vector3d w1 = strain(q, e, basis.evaluate(e, from + 0.5 * h - offset));
  const Eigen::Vector3d w2 = strain(q, e, basis.evaluate(e, from + 0.5 * h + offset));
  return rotations[static_cast<std::size_t>(e * StrainBasis::kIntervals + i)] *
         rotation_of(0.5 * h * (w1 + w2) + kSqrt3Over12 * h * h * w1.cross(w2));
}

Eigen::Vector3d BackboneKinematics::position_at(const StrainBasis& basis, double length_m,
                                                double fraction) const {
  const int e = basis.element_of(fraction);
  const auto first = static_cast<std::size_t>(e * StrainBasis::kIntervals);
  const auto integral = basis.integrated_lagrange(fraction * basis.elements() - e);
  Eigen::Vector3d p = positions[first];
  for (int j = 0; j < StrainBasis::kPoints; ++j)
    p +=
        length_m * basis.element_size() * integral(j) * rotations[first + static_cast<std::size_t>(j)].col(2);
  return p;
}

}  // namespace softarm::rig
