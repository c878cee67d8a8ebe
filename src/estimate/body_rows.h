// What the bodies of a frame say, to first order.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "prior.h"
#include "problem.h"
#include "white_noise.h"

namespace softarm::estimate {

/// What each body's coordinates are off by, b: in its section frame, its place and, where the method uses its
/// tangent, two turns about x and y.
Eigen::Index offsets_of_body(const arm::EstimatorOptions& options);

/// Behind what bodies are off by: by how much the gravity that the rod feels is off, m/s^2, in the base
/// frame. The arm's inertia is such an error.
constexpr Eigen::Index kMotions = 3;

/// Blocks of three rows, a position or a tangent each: model less measured is
///   model + J (x - x_0, b) - measured.
/// Every body has its blocks, in the order of the arm; those that a frame lacks have no weight.
struct BodyRows {
  Eigen::VectorXd x;         ///< x_0
  Eigen::VectorXd model;     ///< at x_0
  Eigen::VectorXd measured;  ///< as many
  Eigen::MatrixXd j;
  Eigen::VectorXd weight;  ///< of each block: 1 / variance of its noise from frame to frame; 0: not seen

  Eigen::Index blocks() const { return weight.size(); }
  /// How far a block is off, in standard deviations, at d = (x - x_0, b).
  double distance(Eigen::Index block, const Eigen::VectorXd& d) const;
  /// Of (x, b), by these measurements and weights, three a block.
  Evidence evidence(const Eigen::VectorXd& of_measured, const Eigen::VectorXd& weights) const;
  Evidence evidence() const;
};

/// At the last evaluation of the problem, x.
/// @param errors how many b has; behind those of the bodies they do nothing here, but for the last: as many
/// as the effects have, see EffectsAt
BodyRows body_rows(const Problem& problem, const Eigen::VectorXd& x, const WhiteNoise& noise,
                   Eigen::Index offsets, Eigen::Index bodies, Eigen::Index errors);

}  // namespace softarm::estimate
