#include "discovered_law.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "effects/learned_moment.h"
#include "law_design.h"
#include "law_selection.h"
#include "law_words.h"
#include "math/linear_algebra.h"
#include "policy.h"
#include "ranges.h"
#include "sequences.h"

namespace softarm::diagnose {
namespace {

using effects::learned_moment;
using effects::LearnedMoment;
using Eigen::Index;
using Eigen::VectorXd;

constexpr int kFoldIterations = 3, kIterations = 4;
constexpr double kTolerance = 0.1;  // of a step, in standard deviations

std::vector<std::size_t> all_trials(const JointModel& model) {
  std::vector<std::size_t> all(model.trials().size());
  std::iota(all.begin(), all.end(), 0U);
  return all;
}

std::vector<Index> indices(const std::vector<StableTerm>& terms) {
  std::vector<Index> list;
  for (const StableTerm& one : terms) list.push_back(one.term);
  return list;
}

/// The parameters with the law's terms behind the effects, at the sizes that the linear problem says.
JointParameters with_law(JointParameters parameters, const LawDesign& design,
                         const std::vector<StableTerm>& terms, const Folds& folds) {
  const VectorXd sizes = sizes_of(design.sums, indices(terms), folds);
  const auto& numbers = learned_moment().info().parameters;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    model::Values values = design.terms[static_cast<std::size_t>(terms[i].term)];
    for (const LearnedMoment::Index which : {LearnedMoment::kX, LearnedMoment::kY}) {
      const model::Parameter& size = numbers[which];
      values[which] = std::clamp(size.usual * sizes[2 * static_cast<Index>(i) + which], size.low, size.high);
    }
    parameters.effects.push_back({&learned_moment(), values});
  }
  return parameters;
}

/// @param near whose derivatives will do; nullptr: its own
Linearised fit(JointModel& model, const JointParameters& start, int iterations,
               const std::vector<std::vector<model::Predicted>>& from, const Linearised* near = nullptr) {
  JointModel::FitOptions how;
  how.iterations = iterations;
  how.tolerance = kTolerance;
  how.whole = false;
  how.near = near;
  return model.fit(start, how, &from);
}

/// Errors of predictions that were not fitted.
struct Errors {
  double distances_m = 0.0, frames = 0.0, most_m = 0.0;  ///< plain, of every frame
  double squares_m2 = 0.0, weight = 0.0;                 ///< by precision
  double mean_m() const { return frames > 0.0 ? distances_m / frames : 0.0; }
  double mean_square_m2() const { return weight > 0.0 ? squares_m2 / weight : 0.0; }
};

void add_errors(const JointModel& model, std::size_t t, const std::vector<model::Predicted>& predicted,
                Errors& errors) {
  for (std::size_t k = 0; k < predicted.size(); ++k) {
    if (!model.uses(t, k) || !predicted[k].solved) continue;
    const std::vector<model::Seen>& bodies = model.trials()[t].blocks[k].bodies;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const double off_m = (bodies[i].p_base - predicted[k].p.col(static_cast<Index>(i))).norm();
      const double weight = 1.0 / std::pow(model.sd_m(t, k, bodies[i]), 2);
      errors.distances_m += bodies[i].frames * off_m;
      errors.most_m = std::max(errors.most_m, off_m);
      errors.frames += bodies[i].frames;
      errors.squares_m2 += weight * off_m * off_m;
      errors.weight += weight;
    }
  }
}

/// Without a law and with one, each fold by true refits to the others.
struct HeldOut {
  Errors before, after;
};

/// Adds the errors of one fold's trials at these parameters.
void predict_fold(JointModel& model, const JointParameters& at,
                  const std::vector<std::vector<model::Predicted>>& start,
                  const std::vector<std::size_t>& fold, Errors& errors) {
  std::vector<std::vector<model::Predicted>> predicted;
  model.predict(at, &start, predicted);
  for (const std::size_t t : fold) add_errors(model, t, predicted[t], errors);
}

HeldOut held_out(JointModel& model, const Linearised& extended, const LawDesign& design,
                 const std::vector<std::size_t>& sequences, unsigned jobs) {
  HeldOut out;
  const std::vector<std::size_t> all = all_trials(model);
  for (const std::vector<std::size_t>& fold : folds_of(sequences, all, kPolicy.law.folds)) {
    std::vector<std::size_t> others;
    for (const std::size_t t : all)
      if (std::find(fold.begin(), fold.end(), t) == fold.end()) others.push_back(t);
    const Folds inner = folds_of(sequences, others, kPolicy.law.folds);
    const std::vector<StableTerm> terms = stable_terms(design.sums, inner, jobs);
    model.look_at(others);
    const JointParameters without =
        fit(model, extended.at, kFoldIterations, extended.predicted, &extended).at;
    // Where none is found there, it predicts as before.
    const JointParameters with = terms.empty() ? without
                                               : fit(model, with_law(without, design, terms, inner),
                                                     kFoldIterations, extended.predicted, &extended)
                                                     .at;
    model.look_at(fold);
    predict_fold(model, without, extended.predicted, fold, out.before);
    predict_fold(model, with, extended.predicted, fold, out.after);
    model.look_at({});
  }
  return out;
}

/// Of the law's last terms: the standard deviations of both sizes.
Eigen::Vector2d sd_of(const Law& law, std::size_t effect) {
  Eigen::Vector2d sd = Eigen::Vector2d::Zero();
  for (std::size_t j = 0; j < law.fit.columns.size(); ++j) {
    const JointUnknown& c = law.fit.columns[j];
    const auto i = static_cast<Index>(j);
    if (c.kind == JointUnknown::Kind::kEffect && c.index == static_cast<int>(effect) && c.parameter < 2)
      sd[c.parameter] = c.scale * std::sqrt(std::max(0.0, law.covariance(i, i)));
  }
  return sd;
}

/// The effect whose orthogonal signature is most like the law's.
void compare_with_catalogue(const Selection& selection, const Linearised& extended, const LawDesign& design,
                            const std::vector<StableTerm>& terms, const Folds& folds, DiscoveredLaw& said) {
  const VectorXd sizes = sizes_of(design.sums, indices(terms), folds);
  VectorXd mixed = VectorXd::Zero(extended.information.rows());
  std::vector<VectorXd> moves;
  for (std::size_t t = 0; t < design.columns.size(); ++t) {
    moves.push_back(VectorXd::Zero(design.columns[t].rows()));
    for (std::size_t i = 0; i < terms.size(); ++i)
      moves[t] += design.columns[t].middleCols<2>(design.sums.first(terms[i].term)) *
                  sizes.segment<2>(2 * static_cast<Index>(i));
    mixed += extended.derivative[t].transpose() * moves[t];
  }
  const VectorXd absorbed = math::solve_symmetric(information_within_ranges(extended), mixed);
  double square = 0.0;
  for (std::size_t t = 0; t < moves.size(); ++t) {
    moves[t] -= extended.derivative[t] * absorbed;
    square += moves[t].squaredNorm();
  }
  for (const Screened& s : selection.rounds.back().screened) {
    double product = 0.0;
    Index row = 0;
    for (const VectorXd& of_trial : moves) {
      if (row + of_trial.size() <= s.direction.size())
        product += of_trial.dot(s.direction.segment(row, of_trial.size()));
      row += of_trial.size();
    }
    const double cosine = square > 0.0 ? std::abs(product) / std::sqrt(square) : 0.0;
    if (cosine < std::max(said.cosine, kPolicy.law.resembles)) continue;
    said.cosine = cosine;
    said.resembles = s.effect->info().id;
  }
}

}  // namespace

std::optional<Law> discover_law(JointModel& model, Selection& selection, double learnt, double noise_floor_m,
                                unsigned jobs) {
  Linearised& extended = selection.extended;
  const std::vector<std::size_t>& sequences = model.sequences();
  const std::size_t different = 1 + *std::max_element(sequences.begin(), sequences.end());
  if (different < kPolicy.law.fewest_sequences) return std::nullopt;
  const LawDesign design = law_design(model, extended, jobs);
  const Folds folds = folds_of(sequences, all_trials(model), kPolicy.law.folds);
  const std::vector<StableTerm> terms = stable_terms(design.sums, folds, jobs);
  const double least = std::max(kPolicy.law.of_flexible * learnt, kPolicy.law.least_share);
  // Refits cost most of the time: to first order it must be half of what it must be in the end.
  if (terms.empty() || held_out_gain(design.sums, indices(terms), folds) < 0.5 * least * extended.square)
    return std::nullopt;
  const HeldOut unseen = held_out(model, extended, design, sequences, jobs);
  const double before_m2 = unseen.before.mean_square_m2(), after_m2 = unseen.after.mean_square_m2();
  const double taken_m2 = before_m2 - after_m2;
  if (!(unseen.after.mean_m() < unseen.before.mean_m()) || !(taken_m2 > least * before_m2))
    return std::nullopt;

  Law law;
  law.fit = fit(model, with_law(extended.at, design, terms, folds), kIterations, extended.predicted);
  law.covariance = inflation(law.fit) * math::inverse_of_symmetric(law.fit.information);
  const double beyond_m2 = before_m2 - noise_floor_m * noise_floor_m;
  DiscoveredLaw& said = law.said;
  said.held_out_mean_before_m = unseen.before.mean_m();
  said.held_out_mean_after_m = unseen.after.mean_m();
  said.held_out_max_before_m = unseen.before.most_m;
  said.held_out_max_after_m = unseen.after.most_m;
  said.share = beyond_m2 > 0.0 ? std::clamp(taken_m2 / beyond_m2, 0.0, 1.0) : 1.0;
  if (learnt > 0.0) said.share_of_flexible = taken_m2 / (learnt * before_m2);
  said.sequences = different;
  const std::size_t first = extended.at.effects.size();
  for (std::size_t i = 0; i < terms.size(); ++i)
    said.terms.push_back(law_term(model.arm(), law.fit.at.effects[first + i].values, sd_of(law, first + i),
                                  terms[i].stability));
  compare_with_catalogue(selection, extended, design, terms, folds, said);
  said.sentence = sentence_of(said);
  said.source = effects::learned_moment().info().source;
  return law;
}

}  // namespace softarm::diagnose
