#include "deciders.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "diagnose/first_fits.h"
#include "diagnose/policy.h"
#include "diagnose/rivals.h"
#include "diagnose/screen.h"
#include "group_lasso.h"
#include "math/parallel.h"

namespace softarm::prove {

using diagnose::EffectList;
using diagnose::JointModel;
using diagnose::JointUnknown;
using diagnose::kPolicy;
using diagnose::Linearised;
using diagnose::Options;
using diagnose::Posterior;
using diagnose::Refitted;
using diagnose::Round;
using diagnose::Screened;
using diagnose::Standing;
using Eigen::VectorXd;
using model::Effect;

namespace {

constexpr double kNothing = -1e300;  // of a difference of BIC

JointModel::FitOptions of_refits() {
  JointModel::FitOptions how;
  how.tolerance = 0.2;
  how.whole = false;
  return how;
}

/// Which unknowns of a fit are numbers of its effects, from one on.
std::vector<bool> numbers_of(const Linearised& at, std::size_t from) {
  std::vector<bool> own;
  for (const JointUnknown& column : at.columns)
    own.push_back(column.kind == JointUnknown::Kind::kEffect && column.index >= static_cast<int>(from));
  return own;
}

/// Nothing more, each refit, and the best of the others.
std::vector<Weighed> with_one_more(const JointModel& model, const Look& look, unsigned jobs) {
  EffectList leaders;
  std::vector<std::size_t> order(look.rough.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return look.rough[a] < look.rough[b]; });
  for (const std::size_t i : order) {
    const Effect* effect = look.round.screened[i].effect;
    const EffectList& candidates = look.bic->candidates();
    if (refit_of(look, effect) == nullptr &&
        std::find(candidates.begin(), candidates.end(), effect) != candidates.end() &&
        leaders.size() < kPolicy.posterior.leaders)
      leaders.push_back(effect);
  }
  const std::size_t refits = look.round.refitted.size();
  std::vector<Weighed> models(1 + refits + leaders.size(), look.bic->none());
  math::in_parallel(models.size() - 1, jobs, [&](std::size_t i) {
    models[1 + i] = i < refits ? weighed(model, look, look.round.refitted[i].fit)
                               : look.bic->linear({leaders[i - refits]});
  });
  return models;
}

std::vector<std::string> ids(const EffectList& effects) {
  std::vector<std::string> list;
  for (const Effect* effect : effects) list.push_back(effect->info().id);
  return list;
}

/// What each effect of a fit is worth, see Bic::supports(); those that are too small to matter nothing.
std::vector<double> supports(const JointModel& model, const Look& look, const Standing& standing) {
  const Linearised& fit = standing.fit;
  EffectList effects;
  for (const model::Present& present : fit.at.effects) effects.push_back(present.effect);
  std::vector<int> owner;
  for (const JointUnknown& column : fit.columns)
    owner.push_back(column.kind == JointUnknown::Kind::kEffect ? column.index : -1);
  const VectorXd x = fit.unknowns();
  VectorXd absent = VectorXd::Zero(x.size());
  for (std::size_t e = 0; e < effects.size(); ++e)
    for (const Eigen::Index row : diagnose::rows_of_sizes(fit, e)) absent[row] = -x[row];
  std::vector<double> worth =
      look.bic->supports(effects, evidence_of_refit(model, fit, look.standing.fit), owner, absent);
  for (std::size_t e = 0; e < effects.size(); ++e)
    if (diagnose::moved_without_m(standing, e) < diagnose::trivial_m(model)) worth[e] = kNothing;
  return worth;
}

/// Takes out, the least one first, what is not worth its numbers, or too small to matter, beside the others.
void drop_unsupported(JointModel& model, const Look& look, Standing& standing) {
  while (standing.fit.at.effects.size() > 1) {
    const std::vector<double> worth = supports(model, look, standing);
    const auto least = std::min_element(worth.begin(), worth.end());
    if (*least > 0.0) return;
    const auto which = static_cast<std::size_t>(least - worth.begin());
    standing = diagnose::standing_on(model, diagnose::refit_without(model, standing, which).fit);
  }
}

}  // namespace

void begin_at(JointModel& model, const Linearised& fit) {
  model.set_misfit(std::max(1.0, fit.square / std::max(1, fit.rows)));
}

Weighed weighed(const JointModel& model, const Look& look, const Linearised& refit) {
  const std::size_t before = look.standing.fit.at.effects.size();
  EffectList effects;
  for (std::size_t e = before; e < refit.at.effects.size(); ++e)
    effects.push_back(refit.at.effects[e].effect);
  return look.bic->refitted(effects, evidence_of_refit(model, refit, look.standing.fit),
                            numbers_of(refit, before));
}

const Refitted* refit_of(const Look& look, const Effect* effect) {
  const auto known = std::find_if(look.round.refitted.begin(), look.round.refitted.end(),
                                  [&](const Refitted& r) { return r.effect == effect; });
  return known == look.round.refitted.end() ? nullptr : &*known;
}

std::vector<std::string> ranking_of(const Look& look, const Posterior& posterior) {
  std::vector<std::size_t> order(look.round.screened.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const double of_a = posterior.of(look.round.screened[a].effect);
    const double of_b = posterior.of(look.round.screened[b].effect);
    return of_a != of_b ? of_a > of_b : look.rough[a] < look.rough[b];
  });
  std::vector<std::string> names;
  for (const std::size_t i : order) names.push_back(look.round.screened[i].effect->info().id);
  return names;
}

void put_first(const std::vector<Named>& effects, std::vector<std::string>& ranking) {
  std::vector<std::string> order;
  for (const Named& named : effects) order.push_back(named.effect);
  for (const std::string& name : ranking)
    if (std::find(order.begin(), order.end(), name) == order.end()) order.push_back(name);
  ranking = std::move(order);
}

std::vector<std::string> instead_of(const Look& look, const Posterior& posterior, const Effect* effect) {
  EffectList list;
  for (const Screened& s : look.round.screened)
    if (s.effect != effect && posterior.instead(s.effect, effect) >= kPolicy.posterior.rival)
      list.push_back(s.effect);
  return ids(list);
}

Linearised refit_with(JointModel& model, const Look& look, const EffectList& effects) {
  const Linearised& at = look.standing.fit;
  const VectorXd expected = look.bic->linear(effects).coefficients, x = at.unknowns();
  diagnose::JointParameters from = at.at;
  for (std::size_t j = 0; j < at.columns.size(); ++j) {
    const auto i = static_cast<Eigen::Index>(j);
    diagnose::set_unknown(from, at.columns[j], x[i] + expected[i]);
  }
  for (const Effect* effect : effects) {
    const auto known = std::find_if(look.candidates.begin(), look.candidates.end(),
                                    [&](const model::Present& one) { return one.effect == effect; });
    from.effects.push_back(*known);
    Eigen::Index column = x.size();
    int size = 0;
    for (const diagnose::Signature& s : look.bic->data().effects) {
      if (s.effect == effect) {
        const model::Parameter& p = effect->info().parameters[static_cast<std::size_t>(size)];
        from.effects.back().values[size++] = std::clamp(expected[column] * p.usual, p.low, p.high);
      }
      ++column;
    }
  }
  return model.fit(from, of_refits(), &at.predicted);
}

Look look(JointModel& model, Standing standing, const Linearised* delayed, const Options& options,
          bool may_move) {
  Look look;
  begin_at(model, standing.fit);
  look.round.screened = diagnose::screen(model, standing.fit, options.jobs, [](double) {});
  if (delayed != nullptr) diagnose::begin_from(model, standing, *delayed, look.round.screened);
  for (const std::size_t i : diagnose::worth_a_refit(model, look.round.screened, options))
    look.round.refitted.push_back(diagnose::refit(model, standing, look.round.screened[i]));
  diagnose::finish_leaders(model, standing, look.round.refitted);
  if (may_move)
    if (std::optional<Standing> better = diagnose::at_better_constants(model, standing, look.round.refitted))
      return prove::look(model, std::move(*better), delayed, options, false);
  look.candidates = diagnose::candidates_of(look.round);
  diagnose::EvidenceData data = evidence_data(model, standing.fit, look.candidates, options.jobs);
  look.standing = std::move(standing);
  look.rough.assign(look.round.screened.size(), 0.0);
  if (data.residual.rows() < kPolicy.posterior.fewest_instants || data.effects.empty()) return look;
  look.bic = std::make_unique<Bic>(std::move(data));
  math::in_parallel(look.rough.size(), options.jobs,
                    [&](std::size_t i) { look.rough[i] = look.bic->rough({look.round.screened[i].effect}); });
  look.models = with_one_more(model, look, options.jobs);
  return look;
}

Decision bic_stepwise(JointModel& model, const Look& first, const Options& options) {
  begin_at(model, first.standing.fit);
  Decision decision;
  decision.method = "bic";
  decision.ranking = ranking_of(first, weights(first.models));
  const Look* now = &first;
  Look own;
  Standing standing;
  while (now->bic) {
    Round round = now->round;
    round.posterior = weights(now->models);
    diagnose::compare(now->standing, round.posterior, round.refitted);
    round.taken = diagnose::best_of(model, round);
    if (round.taken < 0) break;
    const Refitted& best = round.refitted[static_cast<std::size_t>(round.taken)];
    diagnose::set_rivals(round);
    EffectList instead = round.rivals;
    instead.insert(instead.end(), round.nearly_as_good.begin(), round.nearly_as_good.end());
    decision.effects.push_back({best.effect->info().id, best.probability, ids(instead)});
    standing = diagnose::standing_on(model, best.fit);
    if (decision.effects.size() >= diagnose::most_effects(model, standing, options)) break;
    own = look(model, standing, nullptr, options);
    now = &own;
  }
  if (decision.effects.size() > 1) {
    drop_unsupported(model, first, standing);
    const auto is_gone = [&](const Named& named) {
      return std::none_of(standing.fit.at.effects.begin(), standing.fit.at.effects.end(),
                          [&](const model::Present& p) { return p.effect->info().id == named.effect; });
    };
    decision.effects.erase(std::remove_if(decision.effects.begin(), decision.effects.end(), is_gone),
                           decision.effects.end());
  }
  // What is named itself is not there instead of another.
  for (Named& named : decision.effects)
    named.confusable_with.erase(std::remove_if(named.confusable_with.begin(), named.confusable_with.end(),
                                               [&](const std::string& other) {
                                                 return std::any_of(
                                                     decision.effects.begin(), decision.effects.end(),
                                                     [&](const Named& one) { return one.effect == other; });
                                               }),
                                named.confusable_with.end());
  decision.alarm = !decision.effects.empty();
  put_first(decision.effects, decision.ranking);
  return decision;
}

Decision group_lasso(JointModel& model, const Look& first, const Options& options) {
  begin_at(model, first.standing.fit);
  Decision decision;
  decision.method = "lasso";
  decision.ranking = ranking_of(first, weights(first.models));
  if (!first.bic) return decision;
  std::vector<Weighed> models = first.models, path;
  for (const EffectList& set :
       group_lasso_path(first.bic->grouped(), diagnose::most_effects(model, first.standing, options)))
    path.push_back(first.bic->linear(set));
  std::stable_sort(path.begin(), path.end(),
                   [](const Weighed& a, const Weighed& b) { return a.bic < b.bic; });
  double least = first.bic->none().bic;
  Standing standing;
  std::size_t refits = 0;
  for (const Weighed& set : path) {
    const Refitted* known = set.effects.size() == 1 ? refit_of(first, set.effects.front()) : nullptr;
    if (known == nullptr && refits == kPolicy.selection.always_refitted) continue;
    refits += known == nullptr ? 1 : 0;
    Linearised fit = known != nullptr ? known->fit : refit_with(model, first, set.effects);
    models.push_back(weighed(model, first, fit));
    if (models.back().bic >= least) continue;
    least = models.back().bic;
    standing.fit = std::move(fit);
  }
  if (!standing.fit.at.effects.empty()) {
    standing.unseen = diagnose::unseen(model, standing.fit);
    const std::size_t before = standing.fit.at.effects.size();
    drop_unsupported(model, first, standing);
    if (standing.fit.at.effects.size() < before) models.push_back(weighed(model, first, standing.fit));
  }
  if (diagnose::moved_m(first.standing.unseen, standing.unseen) >= diagnose::trivial_m(model)) {
    const Posterior posterior = weights(models);
    for (const model::Present& present : standing.fit.at.effects)
      decision.effects.push_back({present.effect->info().id, posterior.of(present.effect),
                                  instead_of(first, posterior, present.effect)});
    std::stable_sort(decision.effects.begin(), decision.effects.end(),
                     [](const Named& a, const Named& b) { return a.probability > b.probability; });
  }
  decision.alarm = !decision.effects.empty();
  put_first(decision.effects, decision.ranking);
  return decision;
}

std::vector<Decision> decide(const arm::Arm& arm, const std::vector<trial::Trial>& trials, unsigned jobs,
                             const std::vector<std::string>& held, const std::vector<std::string>& tied) {
  Options options;
  options.jobs = jobs;
  model::Preparation how;
  how.block_s = options.block_s;
  how.as_recorded = true;
  const model::Prepared prepared = model::prepare(arm, trials, how);
  JointModel model(arm, prepared.trials, jobs, held, tied);
  diagnose::FirstFits fits = diagnose::first_fits(model, [] {});
  Standing standing{std::move(fits.baseline), {}};
  standing.unseen = diagnose::unseen(model, standing.fit);
  const Look first = look(model, std::move(standing), fits.delayed ? &*fits.delayed : nullptr, options);
  std::vector<Decision> decisions{per_frame(model, first), bic_stepwise(model, first, options),
                                  group_lasso(model, first, options), flexible(model, first, jobs)};
  for (Decision& decision : decisions) decision.alarm = decision.alarm || decisions.back().alarm;
  return decisions;
}

}  // namespace softarm::prove
