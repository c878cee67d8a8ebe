// What else could decide, on the same fit and the same signatures as the diagnosis: the proof's baselines.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "softarm/identify/identify.h"

namespace softarm::prove {

struct Named {
  std::string effect;
  std::optional<double> probability;  ///< absent: the method has none
};

struct Decision {
  std::string method;
  bool alarm = false;                ///< something is there
  std::vector<Named> effects;        ///< what it names, best first
  std::vector<std::string> ranking;  ///< best first, as many as it ranks
};

/// Candidates of a linear model: unit signatures orthogonal to the arm's constants, and how many numbers each
/// was fitted with.
struct Candidates {
  std::vector<std::string> names;
  Eigen::MatrixXd gram;   ///< of the signatures
  Eigen::VectorXd score;  ///< signature . residual, in standard deviations
  Eigen::VectorXi numbers;
  double rows = 0.0;  ///< of the residual
};

/// Forward steps while the Bayesian information criterion falls, samples taken for independent.
Decision bic_stepwise(const Candidates& candidates);

/// Coordinate descent along a path of penalties; the one with the least BIC.
Decision lasso(const Candidates& candidates);

/// Solves min 1/2 x^T G x - s^T x + penalty |x|_1 by coordinate descent, from `start`.
Eigen::VectorXd lasso_at(const Eigen::MatrixXd& gram, const Eigen::VectorXd& score, double penalty,
                         Eigen::VectorXd start);

/// All four: per_frame (residuals of fits frame by frame), bic, lasso, gp (a flexible model alone: it never
/// names).
/// @param held, tied constants, as `softarm diagnose` takes them
std::vector<Decision> decide(const arm::Arm& arm, const std::vector<trial::Trial>& trials, unsigned jobs,
                             const std::vector<std::string>& held = {},
                             const std::vector<std::string>& tied = {});

}  // namespace softarm::prove
