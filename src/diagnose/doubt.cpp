#include "doubt.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "evidence_data.h"
#include "math/linear_algebra.h"
#include "policy.h"
#include "refits.h"
#include "unseen.h"
#include "widening.h"

namespace softarm::diagnose {
namespace {

/// Log density at nothing of sizes that lie anywhere between those of the fit and those of the posterior
/// about it, which knows of correlated errors and small departures: where the two differ, neither is known to
/// be the better.
double log_density_at_nothing(const Eigen::VectorXd& fitted, const Eigen::VectorXd& posterior,
                              const Eigen::MatrixXd& covariance) {
  constexpr int kSteps = 8;
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
  std::vector<double> logs;
  for (int i = 0; i <= kSteps; ++i) {
    const Eigen::VectorXd size = fitted + (posterior - fitted) * i / kSteps;
    logs.push_back(-0.5 * size.dot(factor.solve(size)));
  }
  const double most = *std::max_element(logs.begin(), logs.end());
  double sum = 0.0;
  for (const double log : logs) sum += std::exp(log - most);
  return most + std::log(sum / (kSteps + 1)) - factor.matrixLLT().diagonal().array().log().sum();
}

/// Sizes by the posterior, less the fit's, and their covariance, all where the effect's other numbers are
/// those of the fit.
struct Sizes {
  Eigen::VectorXd shift;
  Eigen::MatrixXd covariance;
};

Sizes at_the_shapes_of(const Linearised& at, std::size_t e, const Gaussian& unknowns) {
  std::vector<Eigen::Index> rows = rows_of_sizes(at, e);
  const auto n = static_cast<Eigen::Index>(rows.size());
  const std::vector<Eigen::Index> shapes = rows_of_shapes(at, e);
  const auto others = static_cast<Eigen::Index>(shapes.size());
  rows.insert(rows.end(), shapes.begin(), shapes.end());
  const Eigen::VectorXd shift = math::rows_of(unknowns.mean, rows);
  const Eigen::MatrixXd precision = math::inverse_of_symmetric(math::block_of(unknowns.covariance, rows));
  Sizes sizes;
  sizes.covariance = math::inverse_of_symmetric(precision.topLeftCorner(n, n));
  sizes.shift = shift.head(n) + sizes.covariance * precision.topRightCorner(n, others) * shift.tail(others);
  return sizes;
}

void widen(const Eigen::VectorXd& times, Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd root = times.cwiseSqrt();
  covariance = root.asDiagonal() * covariance * root.asDiagonal();
}

/// Probability of an effect of the fit given all the others that are in it: the density that its sizes have
/// at nothing, before the data and after them (Savage and Dickey; Dickey 1971), and the odds of an effect.
/// Its other numbers (a place, a time) mean nothing where its sizes are nothing: these are looked at where
/// those are the fit's. Else a share that is known only as a product with a width would seem to be nothing at
/// times. And where it does nothing it has no form that does: such an effect is looked at on its law.
/// What is not known of an effect in any arm is nothing of its own: its sizes are looked at beside that.
/// @param between folds, where the effect's shapes are the fit's
double still_there(const Linearised& at, std::size_t e, std::size_t catalogue, const Posterior& posterior,
                   const Spreads& between, const Widening& widening, double unknown_inertia) {
  const std::vector<Eigen::Index> rows = rows_of_sizes(at, e);
  const Eigen::VectorXd fitted = math::rows_of(at.unknowns(), rows);
  Sizes sizes = at_the_shapes_of(at, e, posterior.on_its_law.at(e));
  widen(widening.times(between, rows, sizes.covariance.diagonal()), sizes.covariance);
  Eigen::VectorXd later = fitted + sizes.shift;
  double log_before = 0.0;  // density at nothing
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const JointUnknown& c = at.columns[static_cast<std::size_t>(rows[i])];
    double& size = later[static_cast<Eigen::Index>(i)];
    size = std::clamp(size, c.low / c.scale, c.high / c.scale);  // what is linear knows of no range
    log_before -= std::log(c.prior_sd);
    const model::Present& present = at.at.effects[e];
    model::Values step = model::Values::Zero(present.values.size());
    step[c.parameter] = c.scale;
    const auto k = static_cast<Eigen::Index>(i);
    sizes.covariance(k, k) += std::pow(unknown_sd(unknown_inertia, *present.effect, step), 2);
  }
  const double log_odds = log_before - log_density_at_nothing(fitted, later, sizes.covariance) +
                          counts_as(*at.at.effects[e].effect) *
                              std::log(kPolicy.posterior.expected / static_cast<double>(catalogue));
  return 1.0 / (1.0 + std::exp(-log_odds));
}

Widening widen_all(const Spreads& between, Eigen::MatrixXd& covariance) {
  std::vector<Eigen::Index> all(static_cast<std::size_t>(covariance.rows()));
  std::iota(all.begin(), all.end(), Eigen::Index{0});
  const Widening widening(between, covariance);
  widen(widening.times(between, all, covariance.diagonal()), covariance);
  return widening;
}

}  // namespace

Between between_folds(const JointModel& model, const Linearised& at) {
  Between between;
  std::vector<bool> held(at.columns.size(), false);
  between.unknowns = between_folds(model, at, held);
  for (std::size_t e = 0; e < at.at.effects.size(); ++e) {
    std::vector<bool> shapes = held;
    for (const Eigen::Index j : rows_of_shapes(at, e)) shapes[static_cast<std::size_t>(j)] = true;
    between.at_shapes.push_back(between_folds(model, at, shapes));
  }
  return between;
}

Doubt doubt_about(const Linearised& at, const Posterior& posterior, const Posterior& without_rivals,
                  const Between& between, std::size_t catalogue, double unknown_inertia) {
  Doubt doubt;
  doubt.still_there.assign(at.at.effects.size(), 1.0);
  if (posterior.unknowns.covariance.rows() != at.information.rows()) {
    doubt.covariance = inflation(at) * math::inverse_of_symmetric(at.information);
    widen_all(between.unknowns, doubt.covariance);
    return doubt;
  }
  const Gaussian& u = posterior.unknowns;
  doubt.covariance = u.covariance + u.mean * u.mean.transpose();
  const Widening widening = widen_all(between.unknowns, doubt.covariance);
  const bool are_others = without_rivals.unknowns.covariance.rows() == at.information.rows();
  const Posterior& of_class = are_others ? without_rivals : posterior;
  for (std::size_t e = 0; e < doubt.still_there.size(); ++e)
    doubt.still_there[e] =
        still_there(at, e, catalogue, of_class, between.at_shapes.at(e), widening, unknown_inertia);
  return doubt;
}

}  // namespace softarm::diagnose
