#include "widening.h"

#include <algorithm>
#include <cmath>

#include "math/distributions.h"
#include "policy.h"

namespace softarm::diagnose {
namespace {

/// What is told by other things than the trials, or rests at an end of its range, says nothing of factors.
constexpr double kLeastExpected = 1e-3;

/// An unknown's spread over what the posterior lets expect.
double ratio_of(const Spread& spread, Eigen::Index row, double variance) {
  return spread.expected[row] > kLeastExpected ? spread.variance[row] / (spread.expected[row] * variance)
                                               : 0.0;
}

/// Of Fisher's F, up to a constant of the freedom that is observed with.
double log_density(double ratio, double observed, double scale, double freedom) {
  const double x = ratio / scale;
  return std::lgamma(0.5 * (observed + freedom)) - std::lgamma(0.5 * freedom) +
         0.5 * observed * std::log(observed * x / freedom) -
         0.5 * (observed + freedom) * std::log1p(observed * x / freedom);
}

}  // namespace

std::vector<Widening::Usual> Widening::usual_of(const Spread& spread, const Eigen::MatrixXd& covariance) {
  if (spread.variance.size() == 0) return {};
  std::vector<Eigen::Index> told;
  std::vector<double> ratio;
  for (Eigen::Index j = 0; j < covariance.rows(); ++j) {
    const double r = ratio_of(spread, j, covariance(j, j));
    if (!(r > 0.0)) continue;
    told.push_back(j);
    ratio.push_back(r);
  }
  if (told.empty()) return {};  // nothing says what is usual
  // Squares of what is correlated are correlated by its square: so many unknowns count as one.
  double shared = 0.0;
  for (const Eigen::Index j : told) {
    for (const Eigen::Index k : told)
      shared += std::pow(covariance(j, k), 2) / (covariance(j, j) * covariance(k, k));
  }
  const double each = static_cast<double>(told.size()) / shared;
  std::vector<Usual> usual;
  for (double freedom = 0.5; freedom < 1e3; freedom *= 2.0) {
    for (double scale = 1.0 / 64.0; scale < 2e4; scale *= std::sqrt(2.0)) {
      double sum = 0.0;
      for (std::size_t i = 0; i < told.size(); ++i)
        sum += log_density(ratio[i], spread.freedom[told[i]], scale, freedom);
      const double before = std::log(scale) / std::log(kPolicy.posterior.wrong_variance);
      usual.push_back({scale, freedom, each * sum - 0.5 * before * before});
    }
  }
  double most = usual.front().weight, total = 0.0;
  for (const Usual& u : usual) most = std::max(most, u.weight);
  for (Usual& u : usual) total += u.weight = std::exp(u.weight - most);
  for (Usual& u : usual) u.weight /= total;
  return usual;
}

Widening::Widening(const Spreads& spreads, const Eigen::MatrixXd& covariance)
    : by_sequence_(usual_of(spreads.by_sequence, covariance)),
      by_session_(usual_of(spreads.by_session, covariance)),
      by_both_(usual_of(spreads.by_both, covariance)) {}

Eigen::VectorXd Widening::moderated(const Spread& spread, const std::vector<Usual>& usual,
                                    const std::vector<Eigen::Index>& rows, const Eigen::VectorXd& variance) {
  Eigen::VectorXd times = Eigen::VectorXd::Ones(variance.size());
  if (usual.empty() || spread.variance.size() == 0) return times;
  // As wide as the interval as which sizes are told.
  constexpr double kSd = kPolicy.words.interval_sd;
  const double up_to = 1.0 - 0.5 * math::normal_two_sided(kSd);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Eigen::Index row = rows[i], at = static_cast<Eigen::Index>(i);
    const double observed = spread.freedom[row], ratio = ratio_of(spread, row, variance[at]);
    double factor = 0.0, freedom = 0.0, t2 = 1.0;
    for (const Usual& u : usual) {
      if (u.freedom != freedom) {
        freedom = u.freedom;
        t2 = std::pow(math::students_t_quantile(freedom + observed, up_to) / kSd, 2);
      }
      factor += u.weight * t2 * (u.freedom * u.scale + observed * ratio) / (u.freedom + observed);
    }
    times[at] += std::min(spread.expected[row], 1.0) * (factor - 1.0);
  }
  return times;
}

Eigen::VectorXd Widening::times(const Spreads& spreads, const std::vector<Eigen::Index>& rows,
                                const Eigen::VectorXd& variance) const {
  const Eigen::VectorXd by_sequence = moderated(spreads.by_sequence, by_sequence_, rows, variance);
  const Eigen::VectorXd by_session = moderated(spreads.by_session, by_session_, rows, variance);
  const bool cross = !by_sequence_.empty() && !by_session_.empty();
  const Eigen::VectorXd both = cross ? moderated(spreads.by_both, by_both_, rows, variance)
                                     : Eigen::VectorXd(by_sequence.cwiseMin(by_session));
  return (by_sequence + by_session - by_sequence.cwiseMin(by_session).cwiseMin(both)).cwiseMax(1.0);
}

}  // namespace softarm::diagnose
