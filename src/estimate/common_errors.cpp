#include "common_errors.h"

namespace softarm::estimate {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Columns of x, for e.
MatrixXd columns_of_passing(const FrameLaw& law) {
  MatrixXd e = MatrixXd::Zero(law.centre.size(), static_cast<Index>(law.passing.size()));
  for (std::size_t i = 0; i < law.passing.size(); ++i) e(law.passing[i], static_cast<Index>(i)) = 1.0;
  return e;
}

/// of(A y), with y's information.
Evidence in_terms_of(const MatrixXd& a, const Evidence& of) {
  return {a.transpose() * of.information * a, a.transpose() * of.weighted};
}

/// Without `count` rows and columns from `first` on: their parameters are zero.
Evidence where_zero(const Evidence& of, Index first, Index count) {
  const Index n = of.weighted.size(), rest = n - first - count;
  Evidence left{MatrixXd(n - count, n - count), VectorXd(n - count)};
  left.information.topLeftCorner(first, first) = of.information.topLeftCorner(first, first);
  left.information.topRightCorner(first, rest) = of.information.topRightCorner(first, rest);
  left.information.bottomLeftCorner(rest, first) = of.information.bottomLeftCorner(rest, first);
  left.information.bottomRightCorner(rest, rest) = of.information.bottomRightCorner(rest, rest);
  left.weighted << of.weighted.head(first), of.weighted.tail(rest);
  return left;
}

}  // namespace

Evidence evidence_on_errors(const FrameLaw& law, const Evidence& bodies, double repeats) {
  const Index n = law.centre.size(), m = bodies.weighted.size() - n;
  const auto k = static_cast<Index>(law.passing.size());
  Evidence xb{bodies.information, bodies.weighted - bodies.information.leftCols(n) * law.centre};
  VectorXd jitter = VectorXd::Zero(n + m);
  jitter.head(n) = repeats * law.jitter_variance;
  integrate_out(jitter, xb);
  MatrixXd a = MatrixXd::Zero(n + m, n + k + m);
  a.topLeftCorner(n, n) = law.shared;
  a.block(0, n, n, k) = columns_of_passing(law);
  a.topRightCorner(n, law.gains.cols()) = law.gains;
  a.bottomRightCorner(m, m).setIdentity();
  return in_terms_of(a, xb);
}

Evidence beyond_posture(const Evidence& of_posture, const CommonErrors& errors) {
  const Index k = errors.passing.size(), m = errors.posture.size(), n = of_posture.weighted.size() - k - m;
  VectorXd variance(n + k + m);
  variance << VectorXd::Zero(n), errors.passing, errors.posture;
  Evidence left = of_posture;
  integrate_out(variance, left);
  return where_zero(left, n, k);
}

Evidence belief_with_offsets(const FrameLaw& law, const CommonErrors& errors, const Evidence& lasting,
                             const Evidence* of_posture) {
  const Index n = law.centre.size(), k = errors.passing.size(), m = errors.posture.size();
  Evidence zb = lasting;
  VectorXd variance(n + m);
  variance << VectorXd::Zero(n), errors.posture;
  integrate_out(variance, zb);
  Evidence all{MatrixXd::Zero(n + k + m, n + k + m), VectorXd::Zero(n + k + m)};
  all.information.topLeftCorner(n, n) = zb.information.topLeftCorner(n, n);
  all.information.topRightCorner(n, m) = zb.information.topRightCorner(n, m);
  all.information.bottomLeftCorner(m, n) = zb.information.bottomLeftCorner(m, n);
  all.information.bottomRightCorner(m, m) = zb.information.bottomRightCorner(m, m);
  all.information.diagonal().segment(n, k) = errors.passing.cwiseInverse();
  all.weighted << zb.weighted.head(n), VectorXd::Zero(k), zb.weighted.tail(m);
  if (of_posture != nullptr) {
    all.information += of_posture->information;
    all.weighted += of_posture->weighted;
  }
  // With y = x - centre less its jitter: z = shared^-1 (y - e - gains).
  MatrixXd a = MatrixXd::Identity(n + k + m, n + k + m);
  a.topLeftCorner(n, n) = law.shared.inverse();
  const MatrixXd inverse = a.topLeftCorner(n, n);
  a.block(0, n, n, k) = -inverse * columns_of_passing(law);
  a.topRightCorner(n, law.gains.cols()) = -inverse * law.gains;
  Evidence y = in_terms_of(a, all);
  variance.resize(n + k + m);
  variance << law.jitter_variance, VectorXd::Constant(k, -1.0), VectorXd::Zero(m);
  integrate_out(variance, y);
  return where_zero(y, n, k);
}

Evidence without_last(Evidence of, Index count) {
  const Index n = of.weighted.size() - count;
  VectorXd variance = VectorXd::Zero(n + count);
  variance.tail(count).setConstant(-1.0);
  integrate_out(variance, of);
  return {of.information.topLeftCorner(n, n), of.weighted.head(n)};
}

}  // namespace softarm::estimate
