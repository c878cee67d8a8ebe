// The modes of vibration of an arm about an equilibrium.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "math/linear_algebra.h"
#include "vibration.h"

namespace softarm::model {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kLeastStiffness = 0.02;  // of a mode's own, where the same shapes have other walls
constexpr double kNoNegative = 1e-6;      // of the largest flexibility: one below 0 by less is none

}  // namespace

Modes modes_of(const Flexibility& f, const Rest& rest, int count) {
  const Index n = rest.masses_kg.size();
  VectorXd root(3 * n);
  for (Index j = 0; j < n; ++j) root.segment<3>(3 * j).setConstant(std::sqrt(rest.masses_kg[j]));
  const MatrixXd symmetric = 0.5 * (f.positions + f.positions.transpose());
  const math::Eigensystem system = math::eigensystem_of(root.asDiagonal() * symmetric * root.asDiagonal());
  Modes modes;
  if (!(system.values[0] > -kNoNegative * system.values[3 * n - 1])) return modes;
  const Index r = std::min<Index>(count, 3 * n);
  const MatrixXd vectors = system.vectors.rightCols(r);
  modes.stiffness = system.values.tail(r).cwiseInverse();
  modes.shape = root.cwiseInverse().asDiagonal() * vectors;
  modes.project = (root.asDiagonal() * vectors).transpose();
  // The forces of inertia that hold a mode, and how sections turn under them.
  const MatrixXd forces = modes.project.transpose() * modes.stiffness.asDiagonal();
  const MatrixXd turned = f.rotations * forces;
  modes.bodies = f.bodies * forces;
  modes.lengths_m = rest.lengths_m;
  modes.curvature.resize(3 * n, r);
  for (Index j = 0; j < n; ++j) {
    MatrixXd change = turned.middleRows<3>(3 * j);
    if (j > 0) change -= turned.middleRows<3>(3 * (j - 1));
    modes.curvature.middleRows<3>(3 * j) =
        f.q[static_cast<std::size_t>(j)].conjugate().toRotationMatrix() * change / rest.lengths_m[j];
  }
  modes.elastic = modes.elastic_of(rest);
  return modes;
}

VectorXd Modes::elastic_of(const Rest& rest) const {
  VectorXd sum = VectorXd::Zero(stiffness.size());
  for (Index j = 0; j < lengths_m.size(); ++j) {
    // The same displacements over a longer piece turn it less, and that along more of it.
    const double shorter = lengths_m[j] / rest.lengths_m[j];
    sum += curvature.middleRows<2>(3 * j).colwise().squaredNorm().transpose() *
           (std::pow(shorter, 4) * rest.lengths_m[j] / rest.compliance[j]);
  }
  return sum;
}

Modes::Springs Modes::springs_of(const Rest& rest, const Sluggishness& sluggish) const {
  VectorXd mass = VectorXd::Zero(stiffness.size());
  for (Index j = 0; j < lengths_m.size(); ++j)
    mass += rest.masses_kg[j] * shape.middleRows<3>(3 * j).colwise().squaredNorm().transpose();
  const VectorXd walls = elastic_of(rest);
  mass *= 1.0 + sluggish.mass_share;
  // An equilibrium that the arm rests in holds it, and a wall takes energy: what the quotient, or a step of a
  // parameter, makes of shapes of another equilibrium must not grow without bound.
  return {(stiffness - elastic + walls).cwiseMax(kLeastStiffness * stiffness).cwiseQuotient(mass),
          std::max(sluggish.lag_s, 0.0) * walls.cwiseQuotient(mass)};
}

}  // namespace softarm::model
