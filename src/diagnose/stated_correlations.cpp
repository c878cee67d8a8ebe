#include "stated_correlations.h"

#include <cmath>

#include "math/linear_algebra.h"
#include "policy.h"

namespace softarm::diagnose {
namespace {

using Eigen::MatrixXd;

/// With no mixture of the numbers surer than a file can state: round-off may even have left one negative.
MatrixXd not_surer_than_stated(const MatrixXd& correlations) {
  const math::Eigensystem system = math::eigensystem_of(correlations);
  const MatrixXd limited = system.vectors * system.values.cwiseMax(kPolicy.stated.surest).asDiagonal() *
                           system.vectors.transpose();
  const Eigen::VectorXd over_sd = limited.diagonal().cwiseSqrt().cwiseInverse();
  return over_sd.asDiagonal() * limited * over_sd.asDiagonal();
}

MatrixXd rounded_to(int digits, const MatrixXd& correlations) {
  const double units = std::pow(10.0, digits);
  MatrixXd rounded = MatrixXd::Identity(correlations.rows(), correlations.cols());
  for (Eigen::Index i = 0; i < rounded.rows(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      const double value = units * correlations(i, j);
      if (std::abs(value) >= kPolicy.stated.left_out)
        rounded(i, j) = rounded(j, i) = std::round(value) / units;
    }
  }
  return rounded;
}

/// Whether all mixtures have nearly the same variance: by the eigenvalues of one in the measure of the other.
bool say_the_same(const MatrixXd& a, const MatrixXd& b) {
  math::CholeskyFactor measure;
  measure.compute(b);
  const MatrixXd half = measure.whiten(a);
  const Eigen::VectorXd ratios = math::eigensystem_of(measure.whiten(half.transpose())).values;
  const double most = kPolicy.stated.same_variance;
  return ratios.minCoeff() >= 1.0 / most && ratios.maxCoeff() <= most;
}

}  // namespace

MatrixXd stated_correlations(const MatrixXd& correlations) {
  if (correlations.rows() < 2 || !correlations.allFinite())
    return MatrixXd::Identity(correlations.rows(), correlations.cols());
  const MatrixXd whole = not_surer_than_stated(correlations);
  for (int digits = kPolicy.stated.fewest_digits; digits < kPolicy.stated.most_digits; ++digits) {
    MatrixXd rounded = rounded_to(digits, whole);
    if (say_the_same(rounded, whole)) return rounded;
  }
  return rounded_to(kPolicy.stated.most_digits, whole);
}

}  // namespace softarm::diagnose
