#include "evidence.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "flexible.h"
#include "math/parallel.h"
#include "policy.h"

namespace softarm::diagnose {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using model::Effect;

namespace {

// Shares of a direction's variance that a kernel may have: a grid as fine as evidence needs, geometric in
// what is left white.
constexpr double kShares[] = {0.0, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95, 0.98, 0.99, 0.997, 0.999};
constexpr double kLeastEigenvalue = 1e-9;  // of a kernel with a unit diagonal: rounding
constexpr std::size_t kOverTime = 0;       // of kernels_of()
constexpr std::size_t kOfLaws = 1;         // of kernels_of(): over what drives the arm, as laws go with it
constexpr Index kSmoothCourses = 8;        // of that: the others turn faster than laws do
constexpr int kNoiseIterations = 2;        // of noise and coefficients by turns: the second changes little

/// Correlated over time, within a trial.
MatrixXd time_kernel(const EvidenceData& data) {
  const Index n = data.residual.rows();
  MatrixXd k = MatrixXd::Identity(n, n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < i; ++j) {
      if (data.trial[static_cast<std::size_t>(i)] == data.trial[static_cast<std::size_t>(j)])
        k(i, j) = k(j, i) = std::exp(-std::abs(data.t_s[i] - data.t_s[j]) / kPolicy.fit.stretch_s);
    }
  }
  return k;
}

/// Of what drives the arm. What is the same in all trials is where a body is, an effect: no error of laws
/// that goes with what drives the arm.
MatrixXd feature_kernel(const MatrixXd& distances2, double reach) {
  const Index n = distances2.rows();
  const MatrixXd k = (-0.5 / (reach * reach) * distances2.array()).exp();
  const VectorXd mean = k.rowwise().mean();
  return k - mean.replicate(1, n) - mean.transpose().replicate(n, 1) + MatrixXd::Constant(n, n, mean.mean());
}

/// Over a trial, over the order of the trials, and smoothly over what drives the arm: those together of unit
/// variance.
MatrixXd courses_of(const EvidenceData& data, const math::BlockEigensystem& over_features) {
  const Index n = data.residual.rows(), smooth = std::min(kSmoothCourses, n);
  MatrixXd courses(n, 2 + smooth);
  courses.col(0) = data.t_s;
  for (Index i = 0; i < n; ++i) courses(i, 1) = static_cast<double>(data.trial[static_cast<std::size_t>(i)]);
  for (auto course : {courses.col(0), courses.col(1)}) {
    const bool same = course.isConstant(course[0]);
    course.array() -= course.mean();
    course *= same ? 0.0 : std::sqrt(static_cast<double>(n)) / course.norm();
  }
  const VectorXd variances = over_features.values.tail(smooth) * static_cast<double>(n);
  courses.rightCols(smooth) = over_features.vectors.front().rightCols(smooth) *
                              (variances / over_features.values.tail(smooth).sum()).cwiseSqrt().asDiagonal();
  return courses;
}

/// What signatures, and effects of the fit along the courses, move in each principal direction.
std::vector<MatrixXd> by_direction(const std::vector<const Signature*>& signatures,
                                   const std::vector<MatrixXd>& done, const Bases& bases, unsigned jobs) {
  const Index n = bases.courses.rows(), m = bases.directions.cols(), courses = bases.courses.cols();
  const auto first = static_cast<Index>(signatures.size());
  const Index columns = first + static_cast<Index>(done.size()) * courses;
  std::vector<MatrixXd> list(static_cast<std::size_t>(m), MatrixXd(n, columns));
  math::in_parallel(signatures.size() + done.size(), jobs, [&](std::size_t i) {
    const bool form = i >= signatures.size();
    const MatrixXd turned = (form ? done[i - signatures.size()] : signatures[i]->moves) * bases.directions;
    const auto column = static_cast<Index>(i);
    for (Index d = 0; d < m; ++d) {
      MatrixXd& to = list[static_cast<std::size_t>(d)];
      if (form)
        to.middleCols(first + (column - first) * courses, courses) =
            turned.col(d).asDiagonal() * bases.courses;
      else
        to.col(column) = turned.col(d);
    }
  });
  return list;
}

double sd_of_background(double left, double unknown_sd, double background) {
  return std::hypot(unknown_sd, 1.0 / std::hypot(1.0 / kPolicy.posterior.most_background, left / background));
}

/// Log marginal likelihood under these sums, coefficients having this mean and precision beforehand.
double log_integral(const NormalEquations& sums, const VectorXd& precision, const VectorXd& mean,
                    VectorXd& coefficients) {
  if (precision.size() == 0) return -0.5 * (sums.log_determinant + sums.square);
  MatrixXd information = sums.information;
  information.diagonal() += precision;
  const VectorXd score = sums.score + precision.cwiseProduct(mean);
  const Eigen::LLT<MatrixXd> factor(information);
  coefficients = factor.solve(score);
  const double least = sums.square + precision.dot(mean.cwiseAbs2()) - score.dot(coefficients);
  const double log_posterior = 2.0 * factor.matrixLLT().diagonal().array().log().sum();
  return -0.5 * (sums.log_determinant + least + log_posterior - precision.array().log().sum());
}

/// Sets about one fit, by their places in the list.
struct AboutOne {
  const LinearGaussianModel* about = nullptr;
  std::vector<std::size_t> sets;
};

std::vector<AboutOne> by_fit(const std::vector<Evaluated>& list) {
  std::vector<AboutOne> fits;
  for (std::size_t i = 0; i < list.size(); ++i) {
    auto fit = std::find_if(fits.begin(), fits.end(),
                            [&](const AboutOne& known) { return known.about == list[i].about; });
    if (fit == fits.end()) fit = fits.insert(fits.end(), AboutOne{list[i].about, {}});
    fit->sets.push_back(i);
  }
  return fits;
}

/// Noise of greatest likelihood at the coefficients that the sets have.
void adapt_noise(const std::vector<AboutOne>& fits, unsigned jobs, std::vector<Evaluated>& list) {
  const std::size_t directions = fits.front().about->directions();
  std::vector<MatrixXd> coefficients;
  for (const AboutOne& fit : fits) {
    MatrixXd columns(fit.about->coefficients(), static_cast<Index>(fit.sets.size()));
    for (std::size_t s = 0; s < fit.sets.size(); ++s)
      columns.col(static_cast<Index>(s)) = list[fit.sets[s]].marginal.coefficients;
    coefficients.push_back(std::move(columns));
  }
  for (Evaluated& set : list) set.marginal.noise.resize(directions);
  math::in_parallel(fits.size() * directions, jobs, [&](std::size_t i) {
    const AboutOne& fit = fits[i / directions];
    const std::size_t d = i % directions;
    const std::vector<DirectionNoise> noise = fit.about->noise_of(d, coefficients[i / directions]);
    for (std::size_t s = 0; s < fit.sets.size(); ++s) list[fit.sets[s]].marginal.noise[d] = noise[s];
  });
}

}  // namespace

double background_sd(const Signature& effect, double background) {
  return sd_of_background(effect.left, effect.unknown_sd, background);
}

std::vector<MatrixXd> kernels_of(const EvidenceData& data) {
  std::vector<MatrixXd> kernels{time_kernel(data)};
  const MatrixXd distances2 = mean_distances2(data.features);
  for (const double reach : kPolicy.flexible.reach) kernels.push_back(feature_kernel(distances2, reach));
  return kernels;
}

Bases bases_of(const EvidenceData& data, unsigned jobs) {
  Bases bases;
  bases.directions = math::eigensystem_of(data.residual.transpose() * data.residual).vectors;
  const std::vector<MatrixXd> kernels = kernels_of(data);
  bases.kernels.resize(kernels.size());
  math::in_parallel(kernels.size(), jobs, [&](std::size_t k) {
    bases.kernels[k] = k == kOverTime ? math::blocks_of(kernels[k]) : math::one_block_of(kernels[k]);
    bases.kernels[k].values = bases.kernels[k].values.cwiseMax(kLeastEigenvalue);
  });
  bases.courses = courses_of(data, bases.kernels[kOfLaws]);
  return bases;
}

void LinearGaussianModel::add(const Signature& signature) {
  mean_.push_back(signature.mean);
  sd_.push_back(signature.prior_sd);
  left_.push_back(signature.left);
  unknown_sd_.push_back(signature.unknown_sd);
  log_weight_ += signature.log_weight;
  effect_.push_back(signature.effect);
  if (signature.effect != nullptr && (each_.empty() || each_.back() != signature.effect))
    each_.push_back(signature.effect);
}

LinearGaussianModel::LinearGaussianModel(const EvidenceData& data, const Bases& bases, unsigned jobs,
                                         const LinearGaussianModel* others, const Effect* but)
    : forms_of_(data.done.size()), courses_(bases.courses.cols()) {
  std::vector<const Signature*> turning;  // those that no other model has turned
  for (const Signature& signature : data.unknowns) turning.push_back(&signature);
  std::vector<Index> turned;  // columns of the other model
  for (const Signature* signature : turning) add(*signature);
  if (others == nullptr) {
    for (const Signature& signature : data.effects) {
      turning.push_back(&signature);
      add(signature);
    }
  } else {
    for (std::size_t j = 0; j < others->effect_.size(); ++j) {
      if (others->effect_[j] == nullptr || others->effect_[j] == but) continue;
      turned.push_back(static_cast<Index>(j));
      add({others->effect_[j],
           others->mean_[j],
           others->sd_[j],
           {},
           others->left_[j],
           others->unknown_sd_[j]});
    }
  }
  const Index forms = static_cast<Index>(forms_of_) * courses_;
  for (Index c = 0; c < forms; ++c) add({nullptr, 0.0, kPolicy.posterior.form, {}});
  const std::vector<MatrixXd> own = by_direction(turning, data.done, bases, jobs);
  const MatrixXd residual = data.residual * bases.directions;
  for (const math::BlockEigensystem& eigen : bases.kernels) {
    turned_.push_back(spectra_of(eigen.values));
    turned_.back().signatures.resize(own.size());
    turned_.back().residual = eigen.turned(residual);
  }
  math::in_parallel(bases.kernels.size() * own.size(), jobs, [&](std::size_t i) {
    const std::size_t k = i / own.size(), d = i % own.size();
    const MatrixXd columns = bases.kernels[k].turned(own[d]);
    const Index before = columns.cols() - forms, from_others = static_cast<Index>(turned.size());
    MatrixXd& all = turned_[k].signatures[d];
    all.resize(columns.rows(), columns.cols() + from_others);
    all.leftCols(before) = columns.leftCols(before);
    for (Index j = 0; j < from_others; ++j)
      all.col(before + j) = others->turned_[k].signatures[d].col(turned[static_cast<std::size_t>(j)]);
    all.rightCols(forms) = columns.rightCols(forms);
  });
}

LinearGaussianModel::InBasis LinearGaussianModel::spectra_of(const VectorXd& eigenvalues) {
  InBasis in;
  in.eigenvalues = eigenvalues;
  in.inverse_spectra.resize(eigenvalues.size(), std::size(kShares));
  in.log_spectra.resize(std::size(kShares));
  for (std::size_t s = 0; s < std::size(kShares); ++s) {
    const Eigen::ArrayXd spectrum = (1.0 - kShares[s]) + kShares[s] * eigenvalues.array();
    in.inverse_spectra.col(static_cast<Index>(s)) = spectrum.inverse();
    in.log_spectra[static_cast<Index>(s)] = spectrum.log().sum();
  }
  return in;
}

std::vector<DirectionNoise> LinearGaussianModel::noise_of(std::size_t direction,
                                                          const MatrixXd& coefficients) const {
  const Index sets = coefficients.cols();
  std::vector<DirectionNoise> list(static_cast<std::size_t>(sets));
  std::vector<double> best(list.size(), -1e300);
  const auto count = static_cast<double>(turned_[0].residual.rows());
  for (std::size_t kernel = 0; kernel < turned_.size(); ++kernel) {
    const InBasis& turned = turned_[kernel];
    MatrixXd left = turned.residual.col(static_cast<Index>(direction)).replicate(1, sets);
    if (sets == 1)  // else Eigen copies the signatures for a product of matrices
      left.col(0).noalias() -= turned.signatures[direction] * coefficients.col(0);
    else
      left.noalias() -= turned.signatures[direction] * coefficients;
    const MatrixXd means = turned.inverse_spectra.transpose() * left.cwiseAbs2() / count;
    for (std::size_t i = 0; i < list.size(); ++i) {
      for (std::size_t s = 0; s < std::size(kShares); ++s) {
        const double share = kShares[s], mean = means(static_cast<Index>(s), static_cast<Index>(i));
        const double variance = std::max(mean, kPolicy.posterior.least_white / (1.0 - share));
        const double log = -0.5 * (count * std::log(variance) + turned.log_spectra[static_cast<Index>(s)] +
                                   count * mean / variance);
        if (log <= best[i]) continue;
        best[i] = log;
        list[i] = {kernel, share, variance};
      }
    }
  }
  for (const DirectionNoise& noise : list) unit_sums(direction, noise.kernel, noise.share);
  return list;
}

const NormalEquations& LinearGaussianModel::unit_sums(std::size_t direction, std::size_t kernel,
                                                      double share) const {
  const auto key = std::make_tuple(direction, kernel, share);
  {
    const std::lock_guard<std::mutex> lock(known_mutex_);
    const auto known = known_.find(key);
    if (known != known_.end()) return known->second;
  }
  const InBasis& turned = turned_[kernel];
  const VectorXd variance = (1.0 - share) + share * turned.eigenvalues.array();
  const VectorXd root = variance.cwiseSqrt().cwiseInverse();
  const MatrixXd x = root.asDiagonal() * turned.signatures[direction];
  const VectorXd y = root.cwiseProduct(turned.residual.col(static_cast<Index>(direction)));
  NormalEquations sums{MatrixXd::Zero(x.cols(), x.cols()), x.transpose() * y, y.squaredNorm(),
                       variance.array().log().sum()};
  sums.information.selfadjointView<Eigen::Lower>().rankUpdate(x.transpose());
  const std::lock_guard<std::mutex> lock(known_mutex_);
  return known_.emplace(key, std::move(sums)).first->second;
}

NormalEquations LinearGaussianModel::normal_equations(const std::vector<DirectionNoise>& noise) const {
  const auto p = static_cast<Index>(mean_.size());
  const auto n = static_cast<double>(turned_[0].residual.rows());
  NormalEquations sums{MatrixXd::Zero(p, p), VectorXd::Zero(p), 0.0, 0.0};
  for (std::size_t d = 0; d < noise.size(); ++d) {
    const NormalEquations& unit = unit_sums(d, noise[d].kernel, noise[d].share);
    sums.information += unit.information / noise[d].variance;
    sums.score += unit.score / noise[d].variance;
    sums.square += unit.square / noise[d].variance;
    sums.log_determinant += unit.log_determinant + n * std::log(noise[d].variance);
  }
  sums.information.triangularView<Eigen::StrictlyUpper>() = sums.information.transpose();
  return sums;
}

VectorXd LinearGaussianModel::precision(const EffectList& present, double background) const {
  VectorXd precision(static_cast<Index>(sd_.size()));
  for (std::size_t j = 0; j < sd_.size(); ++j) {
    const Effect* effect = effect_[j];
    const bool spike =
        effect != nullptr && std::find(present.begin(), present.end(), effect) == present.end();
    precision[static_cast<Index>(j)] =
        1.0 / std::pow(spike ? sd_of_background(left_[j], unknown_sd_[j], background) : sd_[j], 2);
  }
  return precision;
}

Gaussian LinearGaussianModel::estimate(const NormalEquations& sums, const EffectList& present,
                                       double background) const {
  const VectorXd precision = this->precision(present, background);
  MatrixXd information = sums.information;
  information.diagonal() += precision;
  Gaussian estimate;
  estimate.covariance = math::inverse_of_symmetric(information);
  estimate.mean = estimate.covariance * (sums.score + precision.cwiseProduct(mean()));
  return estimate;
}

Gaussian LinearGaussianModel::on_its_law(const Gaussian& estimate, std::size_t effect) const {
  const Index first = estimate.mean.size() - static_cast<Index>(forms_of_ - effect) * courses_;
  const MatrixXd& all = estimate.covariance;
  const MatrixXd with_forms = all.middleRows(first, courses_);
  const MatrixXd of_forms = with_forms.middleCols(first, courses_);
  const MatrixXd gain = math::SymmetricSolver(of_forms).solve_columns(with_forms).transpose();
  return {estimate.mean - gain * estimate.mean.segment(first, courses_), all - gain * with_forms};
}

double LinearGaussianModel::integrate(const NormalEquations& sums, const EffectList& present,
                                      double background, VectorXd& coefficients) const {
  return log_weight_ + log_integral(sums, precision(present, background), mean(), coefficients);
}

std::vector<Index> LinearGaussianModel::rows(bool of_effects) const {
  std::vector<Index> rows;
  for (std::size_t j = 0; j < effect_.size(); ++j)
    if ((effect_[j] != nullptr) == of_effects) rows.push_back(static_cast<Index>(j));
  return rows;
}

NormalEquations LinearGaussianModel::over_effects(const NormalEquations& sums) const {
  const std::vector<Index> own = rows(true), others = rows(false);
  // As Cholesky does it with these first: what it comes to for the effects is what it would go on with.
  const VectorXd precision = math::rows_of(this->precision({}, 1.0), others);
  const VectorXd means = math::rows_of(mean(), others);
  MatrixXd information = math::block_of(sums.information, others);
  information.diagonal() += precision;
  const Eigen::LLT<MatrixXd> factor(information);
  MatrixXd mixed(information.rows(), static_cast<Index>(own.size()));
  for (std::size_t j = 0; j < own.size(); ++j)
    mixed.col(static_cast<Index>(j)) = math::rows_of(sums.information.col(own[j]), others);
  factor.matrixL().solveInPlace(mixed);
  VectorXd score = math::rows_of(sums.score, others) + precision.cwiseProduct(means);
  factor.matrixL().solveInPlace(score);
  return {math::block_of(sums.information, own) - mixed.transpose() * mixed,
          math::rows_of(sums.score, own) - mixed.transpose() * score,
          sums.square + precision.dot(means.cwiseAbs2()) - score.squaredNorm(),
          sums.log_determinant + 2.0 * factor.matrixLLT().diagonal().array().log().sum() -
              precision.array().log().sum()};
}

double LinearGaussianModel::integrate_effects(const NormalEquations& sums, const EffectList& present,
                                              double background) const {
  const std::vector<Index> own = rows(true);
  VectorXd unused;
  return log_weight_ + log_integral(sums, math::rows_of(precision(present, background), own),
                                    math::rows_of(mean(), own), unused);
}

Marginal LinearGaussianModel::evaluate(const EffectList& present, double background,
                                       const std::vector<DirectionNoise>& noise) const {
  std::vector<Evaluated> one{{this, present, background}};
  diagnose::evaluate(one, noise, 1);
  return std::move(one.front().marginal);
}

VectorXd LinearGaussianModel::log_by_instant(const Marginal& marginal, const Bases& bases) const {
  const Index n = turned_[0].residual.rows();
  VectorXd log = VectorXd::Zero(n);
  for (std::size_t kernel = 0; kernel < turned_.size(); ++kernel) {
    const InBasis& turned = turned_[kernel];
    std::vector<std::size_t> own;
    for (std::size_t d = 0; d < marginal.noise.size(); ++d)
      if (marginal.noise[d].kernel == kernel) own.push_back(d);
    if (own.empty()) continue;
    MatrixXd left(n, own.size()), over_variance(n, own.size());
    for (std::size_t i = 0; i < own.size(); ++i) {
      const DirectionNoise& noise = marginal.noise[own[i]];
      const auto column = static_cast<Index>(i);
      const Eigen::ArrayXd variance =
          noise.variance * ((1.0 - noise.share) + noise.share * turned.eigenvalues.array());
      left.col(column) =
          turned.residual.col(static_cast<Index>(own[i])) - turned.signatures[own[i]] * marginal.coefficients;
      over_variance.col(column) = left.col(column).array() / variance;
      log.array() -= 0.5 * variance.log().mean();
    }
    const math::BlockEigensystem& eigen = bases.kernels[kernel];
    log -= 0.5 * eigen.back(left).cwiseProduct(eigen.back(over_variance)).rowwise().sum();
  }
  return log;
}

void evaluate(std::vector<Evaluated>& list, const std::vector<DirectionNoise>& noise, unsigned jobs) {
  if (list.empty()) return;
  const std::vector<AboutOne> fits = by_fit(list);
  const auto integrate = [&] {
    math::in_parallel(list.size(), jobs, [&](std::size_t i) {
      Evaluated& set = list[i];
      set.marginal.log = set.about->integrate(set.about->normal_equations(set.marginal.noise), set.present,
                                              set.background, set.marginal.coefficients);
    });
  };
  for (Evaluated& set : list) set.marginal = {0.0, VectorXd::Zero(set.about->coefficients()), noise};
  if (noise.empty()) adapt_noise(fits, jobs, list);
  for (int i = 0; i < kNoiseIterations; ++i) {
    integrate();
    adapt_noise(fits, jobs, list);
  }
  integrate();
}

}  // namespace softarm::diagnose
