#include "published_shooting.h"

#include <unsupported/Eigen/NonLinearOptimization>

namespace softarm::published {
namespace {

/// The problem at one share of the load, as MINPACK wants it.
struct ShootingProblem {
  const Shot& residual;
  double share = 1.0;

  int operator()(const Eigen::VectorXd& at, Eigen::VectorXd& value) const {
    value = residual(share, at);
    return value.allFinite() ? 0 : -1;  // negative: MINPACK stops
  }
  /// Central differences with one step for all: a step in proportion to the unknown, MINPACK's own, is lost
  /// in rounding where the unknown is all but zero.
  int df(const Eigen::VectorXd& at, Eigen::MatrixXd& jacobian) const {
    constexpr double kStep = 1e-5;
    Eigen::VectorXd moved = at;
    for (Eigen::Index i = 0; i < at.size(); ++i) {
      moved[i] = at[i] + kStep;
      const Eigen::VectorXd above = residual(share, moved);
      moved[i] = at[i] - kStep;
      jacobian.col(i) = (above - residual(share, moved)) / (2.0 * kStep);
      moved[i] = at[i];
    }
    return jacobian.allFinite() ? 0 : -1;
  }
};

}  // namespace

bool follow_root(const Shot& residual, Eigen::VectorXd& x, double tolerance) {
  const Eigen::VectorXd start = x;
  for (const int steps : {4, 16, 64}) {
    x = start;
    bool found = true;
    for (int i = 1; found && i <= steps; ++i) {
      ShootingProblem problem{residual, static_cast<double>(i) / steps};
      // Where rank-one updates of the Jacobian have no more to give, a fresh one goes on.
      found = false;
      for (int attempt = 0; !found && attempt < 4 && x.allFinite(); ++attempt) {
        Eigen::HybridNonLinearSolver<ShootingProblem> solver(problem);
        solver.parameters.xtol = 1e-14;
        solver.solve(x);
        found = x.allFinite() && residual(problem.share, x).norm() < tolerance;
      }
    }
    if (found) return true;
  }
  return false;
}

}  // namespace softarm::published
