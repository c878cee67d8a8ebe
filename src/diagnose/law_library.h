// What a discovered law may be made of: moments that go with what drives or loads the arm.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "joint_model.h"

namespace softarm::diagnose {

/// A term without sizes: values of effects::learned_moment(), with the range that these trials have.
struct LibraryTerm {
  model::Values values;
  /// By trial and block: what it goes with, in the SI unit of it: at each piece of the arm where it has a
  /// direction, else (value, 0) once; empty where the block has no prediction.
  std::vector<std::vector<Eigen::Matrix2Xd>> regressor;
};

/// Inputs, products, plays, lags, payload, attitude, the actuation's moment and the curvature, as far as they
/// vary in these trials.
/// @param at shapes and inputs of these predictions
std::vector<LibraryTerm> law_library(const JointModel& model, const Linearised& at, unsigned jobs);

/// The same moments all along the arm and, one each more, rising from base to tip.
std::vector<model::Values> with_rising(const model::Values& values);

/// Moments of the pieces, (x, y) of each in turn, by size 1 of the two sizes: columns of 2 x pieces rows.
Eigen::MatrixX2d unit_moments(const model::FineRod& rod, const model::Values& values,
                              const Eigen::Matrix2Xd& regressor);

}  // namespace softarm::diagnose
