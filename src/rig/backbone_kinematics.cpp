#include "backbone_kinematics.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace softarm::rig {
namespace {

constexpr double kSqrt3Over12 = 0.14433756729740643;

Eigen::Vector3d strain(const Eigen::VectorXd& q, int first_function, const LocalBasis& basis) {
  Eigen::Vector3d w = Eigen::Vector3d::Zero();
  for (int m = 0; m < 4; ++m)
    w += basis[static_cast<std::size_t>(m)] * q.segment<3>(3 * (first_function + m));
  return w;
}

/// I + a [v]x + b [v]x [v]x.
Eigen::Matrix3d combination(const Eigen::Vector3d& v, double v2, double a, double b) {
  Eigen::Matrix3d m = b * v * v.transpose();
  m.diagonal().array() += 1.0 - b * v2;
  m(0, 1) -= a * v.z();
  m(0, 2) += a * v.y();
  m(1, 2) -= a * v.x();
  m(1, 0) += a * v.z();
  m(2, 0) -= a * v.y();
  m(2, 1) += a * v.x();
  return m;
}

/// exp(Omega), and the left Jacobian of SO(3): d exp(Omega) exp(-Omega) = J dOmega.
struct Turn {
  explicit Turn(const Eigen::Vector3d& omega) {
    const double t = omega.squaredNorm();
    double a = 0.0, b = 0.0, c = 0.0;  // sin t / t, (1 - cos t) / t^2, (t - sin t) / t^3
    if (t < kSeriesBelow) {
      a = 1.0 - t / 6.0 * (1.0 - t / 20.0 * (1.0 - t / 42.0 * (1.0 - t / 72.0)));
      b = 0.5 - t / 24.0 * (1.0 - t / 30.0 * (1.0 - t / 56.0 * (1.0 - t / 90.0)));
      c = 1.0 / 6.0 - t / 120.0 * (1.0 - t / 42.0 * (1.0 - t / 72.0 * (1.0 - t / 110.0)));
    } else {
      const double angle = std::sqrt(t), sine = std::sin(angle);
      a = sine / angle;
      b = (1.0 - std::cos(angle)) / t;
      c = (angle - sine) / (t * angle);
    }
    rotation = combination(omega, t, a, b);
    jacobian = combination(omega, t, b, c);
  }
  static constexpr double kSeriesBelow = 0.06;  // rad^2: five terms are exact to rounding
  Eigen::Matrix3d rotation, jacobian;
};

}  // namespace

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

Eigen::Matrix3d rotation_of(const Eigen::Vector3d& rotation_vector) {
  return Turn(rotation_vector).rotation;
}

BackboneKinematics::BackboneKinematics(const RodMesh& mesh, const Eigen::Quaterniond& base_attitude)
    : base(base_attitude.toRotationMatrix()),
      compliances(mesh.pieces().size(), Eigen::Vector3d::Zero()),
      node_forces(static_cast<std::size_t>(StrainBasis::kPoints * mesh.elements()), Eigen::Vector3d::Zero()),
      tangents(node_forces),
      rotations(static_cast<std::size_t>(mesh.stations()), base),
      positions(static_cast<std::size_t>(mesh.stations()), Eigen::Vector3d::Zero()),
      turns(static_cast<std::size_t>(mesh.stations()) - 1),
      rotation_jacobian(Eigen::MatrixXd::Zero(3 * mesh.stations(), 3 * mesh.functions())),
      position_jacobian(Eigen::MatrixXd::Zero(3 * mesh.stations(), 3 * mesh.functions())) {}

void BackboneKinematics::update(const RodMesh& mesh, const Eigen::VectorXd& q,
                                const std::vector<double>& lengths_m, double load) {
  constexpr int kIntervals = StrainBasis::kIntervals;
  if (mesh.leading_functions() > 0) {
    const Turn turn(q.head<3>());
    rotations[0] = base * turn.rotation;
    base_turn = base * turn.jacobian;
    base_turn.col(2).setZero();
  }
  for (int e = 0; e < mesh.elements(); ++e) {
    const RodMesh::Element& element = mesh.element(e);
    const StrainBasis& basis = mesh.piece_of(e).basis;
    for (int i = 0; i < kIntervals; ++i) {
      const auto k = static_cast<std::size_t>(e * kIntervals + i);
      const auto& [b1, b2] = basis.at_gauss(element.local, i);
      const double h = element.size * (mesh.points()[static_cast<std::size_t>(i) + 1] -
                                       mesh.points()[static_cast<std::size_t>(i)]);
      const Eigen::Vector3d w1 = strain(q, element.first_function, b1);
      const Eigen::Vector3d w2 = strain(q, element.first_function, b2);
      const double c = kSqrt3Over12 * h * h;
      const Eigen::Vector3d omega = 0.5 * h * (w1 + w2) + c * w1.cross(w2);
      const Turn turn(omega);
      rotations[k + 1].noalias() = rotations[k] * turn.rotation;
      const Eigen::Matrix3d outer = rotations[k] * turn.jacobian;
      // A row of `outer` times [w]x is that row crossed with w.
      for (int row = 0; row < 3; ++row) {
        const Eigen::Vector3d o = outer.row(row);
        turns[k].first.row(row) = 0.5 * h * o - c * o.cross(w2);
        turns[k].second.row(row) = 0.5 * h * o + c * o.cross(w1);
      }
    }
    const auto first = static_cast<std::size_t>(e * kIntervals);
    const auto node = static_cast<std::size_t>(e * StrainBasis::kPoints);
    const Eigen::Vector3d& compliance = compliances[static_cast<std::size_t>(element.piece)];
    for (std::size_t j = 0; j < StrainBasis::kPoints; ++j) {
      const Eigen::Matrix3d& r = rotations[first + j];
      const Eigen::Vector3d force = load * r.transpose() * node_forces[node + j];
      tangents[node + j] = r.col(2) + r * compliance.cwiseProduct(force);
    }
    const double length_m = lengths_m[static_cast<std::size_t>(element.piece)] * element.size;
    for (int i = 1; i <= kIntervals; ++i) {
      Eigen::Vector3d p = positions[first];
      for (int j = 0; j <= kIntervals; ++j)
        p += length_m * mesh.integration()(i, j) * tangents[node + static_cast<std::size_t>(j)];
      positions[first + static_cast<std::size_t>(i)] = p;
    }
  }
}

Eigen::Matrix<double, 12, 1> BackboneKinematics::work_of(const RodMesh& mesh, int interval,
                                                         const Eigen::Vector3d& moment) const {
  const int e = interval / StrainBasis::kIntervals;
  const auto& [b1, b2] =
      mesh.piece_of(e).basis.at_gauss(mesh.element(e).local, interval % StrainBasis::kIntervals);
  const GaussTurns& t = turns[static_cast<std::size_t>(interval)];
  const Eigen::Vector3d first = t.first.transpose() * moment, second = t.second.transpose() * moment;
  Eigen::Matrix<double, 12, 1> work;
  for (int m = 0; m < 4; ++m)
    work.segment<3>(3 * m) =
        b1[static_cast<std::size_t>(m)] * first + b2[static_cast<std::size_t>(m)] * second;
  return work;
}

BackboneKinematics::LocalJacobian BackboneKinematics::turns_of(const RodMesh& mesh, int interval) const {
  const int e = interval / StrainBasis::kIntervals;
  const auto& [b1, b2] =
      mesh.piece_of(e).basis.at_gauss(mesh.element(e).local, interval % StrainBasis::kIntervals);
  const GaussTurns& t = turns[static_cast<std::size_t>(interval)];
  LocalJacobian all;
  for (int m = 0; m < 4; ++m)
    all.middleCols<3>(3 * m) =
        b1[static_cast<std::size_t>(m)] * t.first + b2[static_cast<std::size_t>(m)] * t.second;
  return all;
}

void BackboneKinematics::update_jacobians(const RodMesh& mesh, const std::vector<double>& lengths_m) {
  constexpr int kIntervals = StrainBasis::kIntervals;
  Eigen::MatrixXd turned(3 * StrainBasis::kPoints, 3 * mesh.functions());
  if (mesh.leading_functions() > 0) rotation_jacobian.topLeftCorner<3, 3>() = base_turn;
  for (int e = 0; e < mesh.elements(); ++e) {
    // Only coefficients up to this element's own matter for its stations.
    const RodMesh::Element& element = mesh.element(e);
    const int columns = 3 * (element.first_function + 4), first = e * kIntervals;
    for (int i = 0; i < kIntervals; ++i) {
      const int k = first + i;
      auto next = rotation_jacobian.block(3 * (k + 1), 0, 3, columns);
      next = rotation_jacobian.block(3 * k, 0, 3, columns);
      next.rightCols<12>() += turns_of(mesh, k);
    }
    for (int j = 0; j <= kIntervals; ++j)
      turned.block(3 * j, 0, 3, columns).noalias() =
          -cross_matrix(tangents[static_cast<std::size_t>(e * StrainBasis::kPoints + j)]) *
          rotation_jacobian.block(3 * (first + j), 0, 3, columns);
    const double scale = lengths_m[static_cast<std::size_t>(element.piece)] * element.size;
    for (int i = 1; i <= kIntervals; ++i) {
      auto row = position_jacobian.block(3 * (first + i), 0, 3, columns);
      row = position_jacobian.block(3 * first, 0, 3, columns);
      for (int j = 0; j <= kIntervals; ++j)
        row += scale * mesh.integration()(i, j) * turned.block(3 * j, 0, 3, columns);
    }
  }
}

Eigen::Matrix3d BackboneKinematics::rotation_at(const RodMesh& mesh, const Eigen::VectorXd& q,
                                                const RodPlace& place) const {
  const RodMesh::Element& element = mesh.element(place.element);
  const StrainBasis& basis = mesh.piece_of(place.element).basis;
  const double xi = mesh.within_element(place);
  int i = 0;
  while (i + 1 < StrainBasis::kIntervals && mesh.points()[static_cast<std::size_t>(i) + 1] <= xi) ++i;
  const double from = (element.local + mesh.points()[static_cast<std::size_t>(i)]) * element.size;
  const double h = place.fraction - from, offset = 0.5 * h / std::sqrt(3.0);
  const Eigen::Vector3d w1 =
      strain(q, element.first_function, basis.evaluate(element.local, from + 0.5 * h - offset));
  const Eigen::Vector3d w2 =
      strain(q, element.first_function, basis.evaluate(element.local, from + 0.5 * h + offset));
  return rotations[static_cast<std::size_t>(place.element * StrainBasis::kIntervals + i)] *
         rotation_of(0.5 * h * (w1 + w2) + kSqrt3Over12 * h * h * w1.cross(w2));
}

Eigen::Vector3d BackboneKinematics::position_at(const RodMesh& mesh, const std::vector<double>& lengths_m,
                                                const RodPlace& place) const {
  const RodMesh::Element& element = mesh.element(place.element);
  const auto first = static_cast<std::size_t>(place.element * StrainBasis::kIntervals);
  const auto node = static_cast<std::size_t>(place.element * StrainBasis::kPoints);
  const auto integral = mesh.piece_of(place.element).basis.integrated_lagrange(mesh.within_element(place));
  const double length_m = lengths_m[static_cast<std::size_t>(element.piece)] * element.size;
  Eigen::Vector3d p = positions[first];
  for (int j = 0; j < StrainBasis::kPoints; ++j)
    p += length_m * integral(j) * tangents[node + static_cast<std::size_t>(j)];
  return p;
}

}  // namespace softarm::rig
