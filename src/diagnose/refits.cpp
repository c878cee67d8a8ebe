#include "refits.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "evidence_data.h"
#include "floor.h"
#include "math/linear_algebra.h"
#include "policy.h"
#include "ranges.h"
#include "resamples.h"

namespace softarm::diagnose {
namespace {

using model::Present;

constexpr int kRefitIterations = 4, kDropIterations = 6, kFinishIterations = 20;
constexpr int kLastIterations = 3, kLastWholeIterations = 1;  // whole derivatives cost a prediction each
constexpr double kRefitTolerance = 0.2;                       // of a step against the standard deviations

std::vector<Eigen::Index> rows_of_effect(const Linearised& at, std::size_t effect, bool sizes) {
  std::vector<Eigen::Index> rows;
  for (std::size_t j = 0; j < at.columns.size(); ++j) {
    const JointUnknown& c = at.columns[j];
    if (c.kind == JointUnknown::Kind::kEffect && c.index == static_cast<int>(effect) &&
        (c.parameter < at.at.effects[effect].effect->info().sizes) == sizes)
      rows.push_back(static_cast<Eigen::Index>(j));
  }
  return rows;
}

/// Square of the z of an effect's sizes in a fit, residuals taken for independent. Its other numbers are
/// held: without the effect they mean nothing, and cannot make up for it.
double square_of_sizes(const Linearised& at, std::size_t effect) {
  const std::vector<Eigen::Index> rows = rows_of_sizes(at, effect);
  const Eigen::VectorXd sizes = math::rows_of(at.unknowns(), rows);
  std::vector<bool> held(at.columns.size(), false);
  for (const Eigen::Index j : rows_of_shapes(at, effect)) held[static_cast<std::size_t>(j)] = true;
  Eigen::MatrixXd information = at.information;
  Eigen::VectorXd gradient = at.gradient;
  hold(held, information, gradient);
  return sizes.dot(
      math::solve_symmetric(math::block_of(math::inverse_of_symmetric(information), rows), sizes));
}

/// The last effect's sizes against their own spread: what may as well be 0 is not named.
double z_of_sizes(const Linearised& at) {
  return std::sqrt(std::max(0.0, square_of_sizes(at, at.at.effects.size() - 1) / inflation(at)));
}

JointModel::FitOptions refit_options(int iterations) {
  JointModel::FitOptions how;
  how.iterations = iterations;
  how.tolerance = kRefitTolerance;
  return how;
}

/// A refit, and what is said of it.
/// @param near of the model without the effect, or of the same in another order: its derivatives by the rod
void fit_from(JointModel& model, const JointParameters& from,
              const std::vector<std::vector<model::Predicted>>& start, JointModel::FitOptions how,
              const Linearised& near, Refitted& r) {
  how.whole = false;
  how.near = near.complete && !how.damped ? &near : nullptr;
  r.fit = model.fit(from, how, &start);
  r.evidence.reset();
  r.unseen = unseen(model, r.fit);
  r.physical = !at_limit(r.fit, r.fit.at.effects.size() - 1);
  r.converged = r.fit.converged;
}

/// The last steps of a fit, by derivatives of its own.
/// @param begins a fit at these parameters; nullptr: none is known
Standing settled(JointModel& model, const JointParameters& at,
                 const std::vector<std::vector<model::Predicted>>& predicted, const Linearised* begins) {
  JointModel::FitOptions how =
      refit_options(model.needs_whole_derivatives(at) ? kLastWholeIterations : kLastIterations);
  how.derivatives = JointModel::Derivatives::kWhole;
  how.known = true;
  how.begins = begins;
  Standing standing;
  standing.fit = model.fit(at, how, &predicted);
  standing.unseen = unseen(model, standing.fit);
  return standing;
}

/// Probability of a gain on unseen trials, were others like these recorded: the share of the Bayesian
/// bootstrap of the trials (Rubin 1981). What rests on one trial of many is not there in all of them. By
/// plain errors: Huber's weights would take what acts seldom, a wall or a core that slips, for outliers.
double gains_elsewhere(const Unseen& without, const Unseen& with) {
  const Eigen::MatrixXd weights = bootstrap_weights(with.rms_m.size());
  Eigen::VectorXd gain(weights.rows());
  for (std::size_t t = 0; t < with.rms_m.size(); ++t)
    gain[static_cast<Eigen::Index>(t)] = std::pow(without.rms_m[t], 2) - std::pow(with.rms_m[t], 2);
  return ((gain.transpose() * weights).array() > 0.0).cast<double>().mean();
}

/// Evidence about a fit. Of the candidates only those are looked at that are new, or have other values than
/// before.
/// @param make evidence with some of the candidates
template <typename Make>
const EvidenceData& evidence_with(const std::vector<Present>& candidates, const Make& make,
                                  std::optional<KnownEvidence>& known) {
  if (!known) {
    known = KnownEvidence{make(candidates), candidates};
    return known->data;
  }
  std::vector<Present> anew;
  std::vector<const model::Effect*> stay;
  for (const Present& candidate : candidates) {
    const bool same =
        std::any_of(known->candidates.begin(), known->candidates.end(), [&](const Present& before) {
          return before.effect == candidate.effect && before.values == candidate.values;
        });
    if (same)
      stay.push_back(candidate.effect);
    else
      anew.push_back(candidate);
  }
  std::vector<Signature>& effects = known->data.effects;
  effects.erase(std::remove_if(effects.begin(), effects.end(),
                               [&](const Signature& s) {
                                 return std::find(stay.begin(), stay.end(), s.effect) == stay.end();
                               }),
                effects.end());
  if (!anew.empty())
    for (Signature& s : make(anew).effects) effects.push_back(std::move(s));
  known->candidates = candidates;
  return known->data;
}

}  // namespace

bool at_limit(const Linearised& at, std::size_t effect) {
  const Present& present = at.at.effects[effect];
  const Eigen::VectorXd variance = math::inverse_of_symmetric(at.information).diagonal() * inflation(at);
  const auto determined = [&](std::size_t k) {
    for (std::size_t j = 0; j < at.columns.size(); ++j) {
      const JointUnknown& c = at.columns[j];
      if (c.kind != JointUnknown::Kind::kEffect || c.index != static_cast<int>(effect) ||
          c.parameter != static_cast<int>(k))
        continue;
      const double sd = c.scale * std::sqrt(variance[static_cast<Eigen::Index>(j)]);
      return std::abs(present.values[static_cast<Eigen::Index>(k)]) > kPolicy.selection.identifiable_sd * sd;
    }
    return true;
  };
  const model::Info& info = present.effect->info();
  for (std::size_t k = 0; k < info.parameters.size(); ++k) {
    const model::Parameter& p = info.parameters[k];
    if (p.counts || k >= static_cast<std::size_t>(info.sizes)) continue;
    const double value = present.values[static_cast<Eigen::Index>(k)];
    const double near = 1e-6 * (p.high - p.low);
    if (((value <= p.low + near && p.low != 0.0) || value >= p.high - near) && determined(k)) return true;
  }
  return false;
}

const Refitted* refit_of(const Round& round, const model::Effect* effect) {
  const auto found = std::find_if(round.refitted.begin(), round.refitted.end(),
                                  [&](const Refitted& r) { return r.effect == effect; });
  return found == round.refitted.end() ? nullptr : &*found;
}

void without_fits(Round& round) {
  for (Refitted& r : round.refitted) {
    Linearised fit;
    fit.at = std::move(r.fit.at);
    fit.given_up = r.fit.given_up;  // what did not converge is told, but for these
    r.fit = std::move(fit);
    r.unseen.residual.clear();
    r.evidence.reset();
  }
}

bool is_upon(const Refitted& refit, const std::vector<Present>& effects) {
  const std::vector<Present>& all = refit.fit.at.effects;
  return all.size() == effects.size() + 1 &&
         std::equal(effects.begin(), effects.end(), all.begin(),
                    [](const Present& a, const Present& b) { return a.effect == b.effect; });
}

std::vector<Present> candidates_of(const Round& round) {
  std::vector<Present> candidates;
  for (const Screened& s : round.screened) {
    Present candidate{s.effect, s.values};
    if (const Refitted* r = refit_of(round, s.effect)) candidate = r->fit.at.effects.back();
    candidates.push_back(std::move(candidate));
  }
  return candidates;
}

const EvidenceData& evidence_about(JointModel& model, Standing& current,
                                   const std::vector<Present>& candidates, unsigned jobs) {
  const auto about_fit = [&](const std::vector<Present>& some) {
    return evidence_data(model, current.fit, some, jobs);
  };
  return evidence_with(candidates, about_fit, current.evidence);
}

Posterior posterior_of(JointModel& model, Standing& current, Round& round, unsigned jobs) {
  const std::vector<Present> candidates = candidates_of(round);
  std::vector<RefitEvidence> refits;
  for (Refitted& r : round.refitted) {
    const auto about_refit = [&](const std::vector<Present>& some) {
      return evidence_of_refit(model, r.fit, current.fit, some, jobs);
    };
    refits.push_back({r.effect, r.fit.own_derivatives ? evidence_with(candidates, about_refit, r.evidence)
                                                      : evidence_of_refit(model, r.fit, current.fit)});
  }
  return posterior(evidence_about(model, current, candidates, jobs), refits, jobs);
}

std::vector<Eigen::Index> rows_of_sizes(const Linearised& at, std::size_t effect) {
  return rows_of_effect(at, effect, true);
}

std::vector<Eigen::Index> rows_of_shapes(const Linearised& at, std::size_t effect) {
  return rows_of_effect(at, effect, false);
}

double trivial_m(const JointModel& model) {
  return kPolicy.selection.trivial * model.arm().total_length_m();
}

std::size_t most_effects(const JointModel& model, const Standing& current, const Options& options) {
  const auto most = static_cast<std::size_t>(std::max(0, options.most_effects));
  const double left_m2 = std::pow(current.unseen.total_rms_m, 2) - floor_of(model).white_m2;
  const bool much = left_m2 > std::pow(kPolicy.words.small * model.arm().total_length_m(), 2);
  return much ? most : std::min(most, kPolicy.selection.few_effects);
}

std::vector<std::size_t> worth_a_refit(const JointModel& model, const std::vector<Screened>& screened,
                                       const Options& options) {
  std::vector<std::size_t> list;
  for (std::size_t i = 0; i < screened.size(); ++i) {
    const Screened& s = screened[i];
    if (s.z < kPolicy.selection.screen_z || s.leftover_m < trivial_m(model)) continue;
    list.push_back(i);
  }
  // What falls on unseen trials counts, but a first-order estimate may overshoot there.
  std::stable_sort(list.begin(), list.end(), [&](std::size_t a, std::size_t b) {
    const auto worth = [&](std::size_t i) {
      return screened[i].gain + std::max(0.0, screened[i].unseen_gain);
    };
    return worth(a) > worth(b);
  });
  if (list.size() > static_cast<std::size_t>(options.refits))
    list.resize(static_cast<std::size_t>(options.refits));
  // Refits cost most of the time: two always, others where they come near.
  while (list.size() > kPolicy.selection.always_refitted &&
         screened[list.back()].gain < kPolicy.selection.near_best * screened[list.front()].gain)
    list.pop_back();
  return list;
}

void begin_from(JointModel& model, const Standing& current, const Linearised& from,
                std::vector<Screened>& screened) {
  const Present& present = from.at.effects.back();
  const auto s = std::find_if(screened.begin(), screened.end(),
                              [&](const Screened& one) { return one.effect == present.effect; });
  if (s == screened.end() || !(from.square < current.fit.square)) return;
  const Eigen::VectorXd unknowns = current.fit.unknowns();
  s->values = present.values;
  s->sizes = present.values.head(present.effect->info().sizes);
  s->absorbed = unknowns - from.unknowns().head(unknowns.size());
  s->gain = std::max(s->gain, current.fit.square - from.square);
  s->z = std::max(s->z, std::sqrt(s->gain / inflation(current.fit)));
  s->leftover_m = moved_m(current.unseen, unseen(model, from));
}

Refitted refit(JointModel& model, const Standing& current, const Screened& s,
               const std::vector<Refitted>& before) {
  Refitted r;
  r.effect = s.effect;
  JointParameters p = current.fit.at;
  // What the unknowns are expected to give back; those of effects that came in since are the last.
  const Eigen::VectorXd x = current.fit.unknowns().head(s.absorbed.size()) - s.absorbed;
  for (Eigen::Index j = 0; j < x.size(); ++j)
    set_unknown(p, current.fit.columns[static_cast<std::size_t>(j)], x[j]);
  p.effects.push_back({s.effect, s.values});
  JointModel::FitOptions how = refit_options(kRefitIterations);
  how.from = &current.fit;
  double best = current.fit.square;
  for (const Refitted& other : before) best = std::min(best, other.fit.square);
  if (best < current.fit.square)
    how.most_square = current.fit.square - kPolicy.selection.leads * (current.fit.square - best);
  fit_from(model, p, current.fit.predicted, how, current.fit, r);
  return r;
}

Refitted refitted_last(JointModel& model, const Linearised& fit, std::size_t effect) {
  JointParameters p = fit.at;
  std::rotate(p.effects.begin() + static_cast<std::ptrdiff_t>(effect),
              p.effects.begin() + static_cast<std::ptrdiff_t>(effect) + 1, p.effects.end());
  Refitted r;
  r.effect = p.effects.back().effect;
  JointModel::FitOptions how = refit_options(kRefitIterations);
  how.known = true;
  fit_from(model, p, fit.predicted, how, fit, r);
  return r;
}

void finish_leaders(JointModel& model, const Standing& current, std::vector<Refitted>& refitted) {
  std::vector<bool> finished;
  for (const Refitted& r : refitted) finished.push_back(r.converged);
  for (;;) {
    double least = std::numeric_limits<double>::infinity(), expected = least;
    std::size_t next = refitted.size();
    for (std::size_t i = 0; i < refitted.size(); ++i) {
      const Linearised& fit = refitted[i].fit;
      least = std::min(least, fit.square);
      if (finished[i]) continue;
      const double end = expected_square(fit);
      if (end >= expected) continue;
      expected = end;
      next = i;
    }
    if (!(expected < least)) return;
    Refitted& r = refitted[next];
    const std::vector<std::vector<model::Predicted>> start = std::move(r.fit.predicted);
    JointModel::FitOptions how = refit_options(kFinishIterations);
    how.known = true;
    how.damped = r.fit.damped;
    fit_from(model, r.fit.at, start, how, current.fit, r);
    finished[next] = true;
  }
}

void refit_what_is_alike(JointModel& model, const Standing& current, const std::vector<Screened>& screened,
                         std::vector<Refitted>& refitted) {
  const auto by_square = [](const Refitted& a, const Refitted& b) { return a.fit.square < b.fit.square; };
  const auto first = std::min_element(refitted.begin(), refitted.end(), by_square);
  if (first == refitted.end() || !(first->fit.square < current.fit.square)) return;
  const JointParameters at = first->fit.at;
  const std::vector<std::vector<model::Predicted>> start = first->fit.predicted;
  for (const Screened& s : screened) {
    const Present& other = at.effects.back();
    const std::optional<model::Values> values = s.effect->like(*other.effect, other.values, model.rod());
    if (!values) continue;
    Refitted r;
    r.effect = s.effect;
    JointParameters p = at;
    p.effects.back() = {s.effect, *values};
    for (const JointUnknown& c : model.columns(p)) set_unknown(p, c, value_of(p, c) / c.scale);  // in range
    JointModel::FitOptions how = refit_options(kFinishIterations);
    how.damped = true;
    fit_from(model, p, start, how, current.fit, r);
    const auto known = std::find_if(refitted.begin(), refitted.end(),
                                    [&](const Refitted& one) { return one.effect == s.effect; });
    if (known == refitted.end())
      refitted.push_back(std::move(r));
    else if (by_square(r, *known))
      *known = std::move(r);
  }
}

Standing standing_on(JointModel& model, const Linearised& fit) {
  return settled(model, fit.at, fit.predicted, &fit);
}

Standing standing_at(JointModel& model, const JointParameters& at,
                     const std::vector<std::vector<model::Predicted>>& predicted) {
  return settled(model, at, predicted, nullptr);
}

void linearise_leaders(JointModel& model, const Standing& current, std::vector<Refitted>& refitted) {
  const auto best =
      std::min_element(refitted.begin(), refitted.end(),
                       [](const Refitted& a, const Refitted& b) { return a.fit.square < b.fit.square; });
  if (best == refitted.end()) return;
  const double least = best->fit.square,
               most = std::min(current.fit.square - kPolicy.selection.leads * (current.fit.square - least),
                               least + 2.0 * inflation(best->fit) * kPolicy.selection.hopeless);
  for (Refitted& r : refitted) {
    if (r.fit.own_derivatives || r.fit.square > most) continue;
    model.take_own_derivatives(r.fit, true);
    r.evidence.reset();
    r.unseen = unseen(model, r.fit);
  }
}

Standing refit_without(JointModel& model, const Standing& current, std::size_t effect) {
  JointParameters p = current.fit.at;
  p.effects.erase(p.effects.begin() + static_cast<std::ptrdiff_t>(effect));
  JointModel::FitOptions how = refit_options(kDropIterations);
  how.near = &current.fit;
  how.whole = false;
  Standing without;
  without.fit = model.fit(p, how, &current.fit.predicted);
  without.unseen = unseen(model, without.fit);
  return without;
}

std::optional<Standing> at_better_constants(JointModel& model, const Standing& current,
                                            const std::vector<Refitted>& refitted) {
  const double enough = (1.0 - kPolicy.selection.other_optimum) * current.fit.square;
  const Refitted* best = nullptr;
  for (const Refitted& r : refitted) {
    if (r.fit.square < enough && z_of_sizes(r.fit) < kPolicy.selection.rival_z &&
        (best == nullptr || r.fit.square < best->fit.square))
      best = &r;
  }
  if (best == nullptr) return std::nullopt;
  Standing without = refit_without(model, {best->fit, {}}, best->fit.at.effects.size() - 1);
  if (!(without.fit.square < enough)) return std::nullopt;
  return standing_on(model, without.fit);
}

double moved_without_m(const Standing& current, std::size_t effect) {
  return current.unseen.total_rms_m *
         std::sqrt(square_of_sizes(current.fit, effect) / current.unseen.total_chi2);
}

double moved_m(const Unseen& without, const Unseen& with) {
  return std::sqrt(std::max(0.0, std::pow(without.total_rms_m, 2) - std::pow(with.total_rms_m, 2)));
}

void compare(const Standing& current, const Posterior& posterior, std::vector<Refitted>& refitted) {
  double least = current.unseen.total_chi2, phi = inflation(current.fit);
  for (const Refitted& r : refitted) {
    if (r.unseen.total_chi2 < least) {
      least = r.unseen.total_chi2;
      phi = inflation(r.fit);
    }
  }
  for (Refitted& r : refitted) {
    const double fall = current.unseen.total_chi2 - r.unseen.total_chi2;
    r.z = std::min(std::sqrt(std::max(0.0, fall / phi)), z_of_sizes(r.fit));
    r.gain = 0.5 * fall / phi;
    r.moved_m = moved_m(current.unseen, r.unseen);
    r.elsewhere = gains_elsewhere(current.unseen, r.unseen);
    // Both over the same resamples: where the one fails, so does the other.
    r.probability = std::min(posterior.of(r.effect), r.elsewhere);
  }
  std::stable_sort(refitted.begin(), refitted.end(),
                   [](const Refitted& a, const Refitted& b) { return a.gain > b.gain; });
}

}  // namespace softarm::diagnose
