#include "bic.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnose/policy.h"

namespace softarm::prove {

using diagnose::EffectList;
using diagnose::EvidenceData;
using diagnose::kPolicy;
using diagnose::NormalEquations;
using diagnose::Signature;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using model::Effect;

namespace {

constexpr double kHeld = 1e-6;  // of a usual size: a prior as narrow holds a number where it is

bool holds(const EffectList& list, const Effect* effect) {
  return std::find(list.begin(), list.end(), effect) != list.end();
}

/// Of all coefficients, before the data.
struct Prior {
  VectorXd mean, precision;
};

/// @param p count of the coefficients
Prior prior_of(const EvidenceData& data, const std::vector<bool>& free, double background, Index p) {
  Prior prior{VectorXd::Zero(p), VectorXd::Zero(p)};
  Index j = 0;
  for (const Signature& s : data.unknowns) {
    prior.mean[j] = s.mean;
    prior.precision[j++] = 1.0 / (s.prior_sd * s.prior_sd);
  }
  for (const Signature& s : data.effects) {
    const double sd = free[static_cast<std::size_t>(j)] ? s.prior_sd : background_sd(s, background);
    prior.precision[j++] = 1.0 / (sd * sd);
  }
  if (data.done.empty()) return prior;
  const Index courses = (p - j) / static_cast<Index>(data.done.size());
  for (const MatrixXd& done : data.done) {  // what is absent does nothing otherwise
    const double sd = done.isZero() ? kHeld : kPolicy.posterior.form;
    prior.precision.segment(j, courses).setConstant(1.0 / (sd * sd));
    j += courses;
  }
  return prior;
}

std::size_t count_of_effects(const EvidenceData& data) {
  EffectList each;
  for (const Signature& s : data.effects)
    if (!holds(each, s.effect)) each.push_back(s.effect);
  return each.size();
}

}  // namespace

double price(const EvidenceData& data, const EffectList& effects) {
  const double of_number = std::log(static_cast<double>(data.residual.size()));
  const double of_effect =
      -2.0 * std::log(kPolicy.posterior.expected / static_cast<double>(count_of_effects(data)));
  double sum = 0.0;
  for (const Effect* effect : effects) {
    const std::vector<model::Parameter>& all = effect->info().parameters;
    const auto fitted =
        std::count_if(all.begin(), all.end(), [](const model::Parameter& p) { return !p.counts && !p.held; });
    const auto own = std::find_if(data.effects.begin(), data.effects.end(),
                                  [&](const Signature& s) { return s.effect == effect; });
    const double choices = own == data.effects.end() ? 0.0 : 2.0 * own->log_choices;
    sum += static_cast<double>(fitted) * of_number + diagnose::counts_as(*effect) * of_effect + choices;
  }
  return sum;
}

std::vector<bool> sizes_of(const EvidenceData& data, const EffectList& effects) {
  std::vector<bool> sizes(data.unknowns.size(), false);
  for (const Signature& s : data.effects) sizes.push_back(holds(effects, s.effect));
  return sizes;
}

double deviance(const EvidenceData& data, const NormalEquations& sums, const std::vector<bool>& free,
                double background) {
  const Prior prior = prior_of(data, free, background, sums.score.size());
  MatrixXd information = sums.information;
  information.diagonal() += prior.precision;
  const VectorXd score = sums.score + prior.precision.cwiseProduct(prior.mean);
  // What is integrated out comes first: its determinant is that of the factor's corner.
  const auto is_free = [&](std::size_t j) { return j < free.size() && free[j]; };
  std::vector<Index> order;
  for (const bool wanted : {false, true})
    for (std::size_t j = 0; j < static_cast<std::size_t>(score.size()); ++j)
      if (is_free(j) == wanted) order.push_back(static_cast<Index>(j));
  const Eigen::LLT<MatrixXd> factor(math::block_of(information, order));
  const double least = sums.square + prior.precision.dot(prior.mean.cwiseAbs2()) -
                       factor.matrixL().solve(math::rows_of(score, order)).squaredNorm();
  const Index others = score.size() - std::count(free.begin(), free.end(), true);
  double log_determinant = sums.log_determinant;
  for (Index j = 0; j < others; ++j)
    log_determinant += 2.0 * std::log(factor.matrixLLT()(j, j)) -
                       std::log(prior.precision[order[static_cast<std::size_t>(j)]]);
  return log_determinant + least;
}

diagnose::Posterior weights(const std::vector<Weighed>& models) {
  diagnose::Posterior posterior;
  double least = 1e300, sum = 0.0;
  for (const Weighed& m : models) least = std::min(least, m.bic);
  for (const Weighed& m : models) {
    const double weight = std::exp(-0.5 * (m.bic - least));
    const auto same = std::find_if(posterior.sets.begin(), posterior.sets.end(),
                                   [&](const diagnose::EffectSet& set) { return set.effects == m.effects; });
    if (same == posterior.sets.end())
      posterior.sets.push_back({m.effects, weight});
    else
      same->probability = std::max(same->probability, weight);
  }
  for (const diagnose::EffectSet& set : posterior.sets) sum += set.probability;
  for (diagnose::EffectSet& set : posterior.sets) set.probability /= sum;
  std::stable_sort(posterior.sets.begin(), posterior.sets.end(),
                   [](const diagnose::EffectSet& a, const diagnose::EffectSet& b) {
                     return a.probability > b.probability;
                   });
  return posterior;
}

Bic::Bic(EvidenceData data) : data_(std::move(data)), bases_(bases_of(data_)), linear_(data_, bases_) {
  for (const Signature& s : data_.effects)
    if (s.left * s.prior_sd > kPolicy.selection.trivial && !holds(candidates_, s.effect))
      candidates_.push_back(s.effect);
  none_.background = kPolicy.posterior.background[0];
  // Twice, as noise and background go together; what is compared with it begins from both.
  for (int turn = 0; turn < 2; ++turn) none_ = weighed(data_, linear_, {}, sizes_of(data_, {}), none_);
  sums_ = linear_.normal_equations(none_.noise);
}

double Bic::rough(const EffectList& effects) const {
  return deviance(data_, sums_, sizes_of(data_, effects), none_.background) + price(data_, effects);
}

Weighed Bic::weighed(const EvidenceData& data, const diagnose::LinearGaussianModel& linear,
                     const EffectList& beside, std::vector<bool> free, Weighed from) const {
  diagnose::Marginal marginal = linear.evaluate(beside, from.background, from.noise);
  from.noise = std::move(marginal.noise);
  from.coefficients = std::move(marginal.coefficients);
  const NormalEquations sums = linear.normal_equations(from.noise);
  from.bic = 1e300;
  for (const double background : kPolicy.posterior.background) {
    const double here = deviance(data, sums, free, background);
    if (here >= from.bic) continue;
    from.bic = here;
    from.background = background;
  }
  return from;
}

Weighed Bic::linear(const EffectList& effects) const {
  Weighed of = weighed(data_, linear_, effects, sizes_of(data_, effects), none_);
  of.effects = effects;
  of.bic += price(data_, effects);
  return of;
}

void Bic::add_background(const EffectList& effects, EvidenceData& refit) const {
  refit.effects.clear();
  for (const Signature& s : data_.effects)
    if (!holds(effects, s.effect)) refit.effects.push_back(s);
}

std::vector<double> Bic::supports(const EffectList& effects, EvidenceData refit,
                                  const std::vector<int>& owner, const VectorXd& absent) const {
  add_background(effects, refit);
  const diagnose::LinearGaussianModel about(refit, bases_);
  const NormalEquations sums =
      about.normal_equations(about.evaluate({}, none_.background, none_.noise).noise);
  std::vector<bool> free(owner.size() + refit.effects.size(), false);
  for (std::size_t j = 0; j < owner.size(); ++j) free[j] = owner[j] >= 0;
  const double with = deviance(refit, sums, free, none_.background);
  std::vector<double> list;
  for (std::size_t e = 0; e < effects.size(); ++e) {
    EvidenceData without = refit;
    for (std::size_t j = 0; j < owner.size(); ++j) {
      if (owner[j] != static_cast<int>(e)) continue;
      without.unknowns[j].mean = absent[static_cast<Index>(j)];
      without.unknowns[j].prior_sd = kHeld;
    }
    if (e < without.done.size()) without.done[e].setZero();
    list.push_back(deviance(without, sums, free, none_.background) - with - price(data_, {effects[e]}));
  }
  return list;
}

Weighed Bic::refitted(const EffectList& effects, EvidenceData refit, const std::vector<bool>& own) const {
  add_background(effects, refit);
  std::vector<bool> free = own;
  free.resize(own.size() + refit.effects.size(), false);
  const diagnose::LinearGaussianModel about(refit, bases_);
  Weighed of = weighed(refit, about, {}, free, none_);
  of.effects = effects;
  of.bic += price(data_, effects);
  return of;
}

Grouped Bic::grouped() const {
  // With A the information, P the prior's precision and V the covariance of noise, constants, background and
  // forms: X^T V^-1 X = P - P (A + P)^-1 P, X^T V^-1 (y - X mean) = P (A + P)^-1 (X^T N^-1 y - A mean).
  const Prior prior = prior_of(data_, sizes_of(data_, {}), none_.background, sums_.score.size());
  const MatrixXd covariance = linear_.estimate(sums_, {}, none_.background).covariance;
  const VectorXd x = covariance * (sums_.score - sums_.information * prior.mean);
  Grouped grouped;
  std::vector<Index> rows;
  grouped.effects = candidates_;
  for (const Effect* effect : candidates_) {
    grouped.columns.emplace_back();
    for (std::size_t e = 0; e < data_.effects.size(); ++e) {
      if (data_.effects[e].effect != effect) continue;
      grouped.columns.back().push_back(static_cast<Index>(rows.size()));
      rows.push_back(static_cast<Index>(data_.unknowns.size() + e));
    }
  }
  const VectorXd p = math::rows_of(prior.precision, rows);
  grouped.gram = -math::block_of(covariance, rows).cwiseProduct(p * p.transpose());
  grouped.gram.diagonal() += p;
  grouped.score = p.cwiseProduct(math::rows_of(x, rows));
  return grouped;
}

}  // namespace softarm::prove
