#include "free_tip.h"

#include <ceres/tiny_solver.h>

#include <algorithm>

#include "math/so3.h"
#include "math/tiny_solver_tolerance.h"

namespace softarm::estimate {
namespace {

/// Parameters of the problem, then a rotation vector of the tip away from its start.
class FreeTip {
 public:
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Eigen::Dynamic };

  FreeTip(const Problem& problem, const Eigen::Quaterniond& q_start, double base_sd_rad)
      : problem_(problem), q_start_(q_start), base_sd_rad_(base_sd_rad) {
    rows_ = 3;
    for (const Observation& o : problem.observations()) rows_ += o.used ? (o.tangent ? 6 : 3) : 0;
    rows_ += (problem.NumParameters() - 1) / kSegmentParameters;
  }

  int NumResiduals() const { return rows_; }
  int NumParameters() const { return problem_.NumParameters() + 3; }

  Eigen::Quaterniond tip(const double* x) const {
    return (math::exp_so3(Eigen::Map<const Eigen::Vector3d>(x + problem_.NumParameters())) * q_start_)
        .normalized();
  }

  bool operator()(const double* x, double* residuals, double* jacobian) const {
    if (!problem_.evaluate_free_tip(x, tip(x), base_sd_rad_, residuals, jacobian, rows_)) {
      std::fill(residuals, residuals + rows_, 1e8);
      if (jacobian != nullptr) std::fill(jacobian, jacobian + rows_ * NumParameters(), 0.0);
      return true;
    }
    if (jacobian != nullptr) {
      // By the rotation vector itself: its left Jacobian, the inverse of the inverse.
      const Eigen::Map<const Eigen::Vector3d> turn(x + problem_.NumParameters());
      Eigen::Map<Eigen::MatrixXd> j(jacobian, rows_, NumParameters());
      j.rightCols<3>() = (j.rightCols<3>() * math::left_jacobian_inverse(turn).inverse()).eval();
    }
    return true;
  }

 private:
  const Problem& problem_;
  const Eigen::Quaterniond q_start_;
  const double base_sd_rad_;
  int rows_ = 0;
};

}  // namespace

bool refine_with_free_tip(const Problem& problem, Start& start) {
  const int count = problem.NumParameters();
  // The base is drawn to its place in two steps: loosely, so that the shape is found, then as firmly as the
  // markers.
  for (const double base_sd_rad : {0.05, 0.002}) {
    const FreeTip function(problem, start.q_tip, base_sd_rad);
    Eigen::VectorXd x = Eigen::VectorXd::Zero(count + 3);
    x.head(count) = start.x;
    ceres::TinySolver<FreeTip> solver;
    solver.options.max_num_iterations = 60;
    math::set_function_tolerance(solver.options, 1e-6);
    solver.Solve(function, &x);  // a start, converged or not: the fit from it is judged
    if (!x.allFinite()) return false;
    start.q_tip = function.tip(x.data());
    start.x = x.head(count);
  }
  return true;
}

}  // namespace softarm::estimate
