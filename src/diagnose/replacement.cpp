#include "replacement.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "policy.h"
#include "rivals.h"

namespace softarm::diagnose {
namespace {

using model::Effect;

constexpr std::size_t kMostCompared = 2;  // with one effect: each costs a refit

bool has(const EffectList& list, const Effect* effect) {
  return std::find(list.begin(), list.end(), effect) != list.end();
}

const Refitted& taken_of(const Round& round) {
  return round.refitted[static_cast<std::size_t>(round.taken)];
}

/// What does nearly the same as what a round took and is not in the model, best first.
std::vector<Screened> doing_nearly_the_same(const JointParameters& at, const Round& round) {
  const Screened& own = screened_of(round, taken_of(round).effect);
  std::vector<Screened> list;
  for (const Screened& s : round.screened) {
    const bool there = std::any_of(at.effects.begin(), at.effects.end(),
                                   [&](const model::Present& present) { return present.effect == s.effect; });
    const double cosine = std::abs(s.direction.dot(own.direction));
    if (there || !(has(round.rivals, s.effect) || cosine > kPolicy.selection.rival_cosine)) continue;
    list.push_back(s);
    for (const Refitted& r : round.refitted)
      if (r.effect == s.effect) list.back().values = r.fit.at.effects.back().values;
  }
  std::stable_sort(list.begin(), list.end(),
                   [](const Screened& a, const Screened& b) { return a.gain > b.gain; });
  if (list.size() > kMostCompared) list.resize(kMostCompared);
  return list;
}

/// The effect and those others, each fitted upon the model without it, from where the model is.
Round compared_with(JointModel& model, const Standing& current, std::size_t e,
                    const std::vector<Screened>& with, const std::vector<Screened>& screened,
                    const Options& options) {
  Standing without = standing_on(model, refit_without(model, current, e).fit);
  const Eigen::VectorXd known = current.fit.unknowns();
  std::vector<double> others;
  for (std::size_t j = 0; j < current.fit.columns.size(); ++j) {
    const JointUnknown& c = current.fit.columns[j];
    if (c.kind != JointUnknown::Kind::kEffect || c.index != static_cast<int>(e))
      others.push_back(known[static_cast<Eigen::Index>(j)]);
  }
  const Eigen::VectorXd absorbed =
      without.fit.unknowns() -
      Eigen::Map<const Eigen::VectorXd>(others.data(), static_cast<Eigen::Index>(others.size()));
  Round round;
  round.screened = screened;
  for (Screened s : with) {
    s.absorbed = absorbed;
    const bool listed = std::any_of(screened.begin(), screened.end(),
                                    [&](const Screened& other) { return other.effect == s.effect; });
    if (!listed) round.screened.push_back(s);
    round.refitted.push_back(refit(model, without, s, round.refitted));
  }
  finish_leaders(model, without, round.refitted);
  linearise_leaders(model, without, round.refitted);
  round.posterior = posterior_of(model, without, round, options.jobs);
  compare(without, round.posterior, round.refitted);
  return round;
}

/// The likeliest in the effect's place; nullptr: the effect itself.
const Refitted* likelier_than(const Effect* effect, const Round& round) {
  const Refitted* best = nullptr;
  double most = 0.0;
  for (const Refitted& r : round.refitted) {
    if (r.effect == effect || !r.physical || r.fit.given_up) continue;
    const double instead = round.posterior.instead(r.effect, effect);
    if (instead > most && instead > round.posterior.instead(effect, r.effect)) {
      best = &r;
      most = instead;
    }
  }
  return best;
}

/// A round as if it had taken another effect, which explains what the one that it took did.
void retake(Round& round, const Refitted& other, const Posterior& posterior) {
  const Effect* before = taken_of(round).effect;
  const auto forget = [&](EffectList& list) {
    list.erase(std::remove(list.begin(), list.end(), other.effect), list.end());
  };
  forget(round.rivals);
  forget(round.nearly_as_good);
  if (posterior.instead(before, other.effect) >= kPolicy.posterior.rival) round.rivals.push_back(before);
  Refitted taken = taken_of(round);
  taken.effect = other.effect;
  taken.probability = other.probability;
  taken.fit = Linearised();
  taken.fit.at = other.fit.at;
  round.refitted.erase(
      std::remove_if(round.refitted.begin(), round.refitted.end(),
                     [&](const Refitted& r) { return r.effect == other.effect || r.effect == before; }),
      round.refitted.end());
  round.refitted.insert(round.refitted.begin(), std::move(taken));
  round.taken = 0;
  round.posterior = posterior;
}

}  // namespace

bool put_likelier_in_place(JointModel& model, Standing& current, Selection& selection,
                           const Options& options) {
  const std::vector<Screened> screened = selection.rounds.back().screened;
  bool any = false;
  // The last came upon all others.
  for (std::size_t e = 0; e + 1 < current.fit.at.effects.size(); ++e) {
    Round& of = selection.rounds[selection.round_of[e]];
    std::vector<Screened> list = doing_nearly_the_same(current.fit.at, of);
    if (list.empty()) continue;
    const Effect* effect = current.fit.at.effects[e].effect;
    Screened own = screened_of(of, effect);
    own.values = current.fit.at.effects[e].values;
    list.insert(list.begin(), own);
    const Round round = compared_with(model, current, e, list, screened, options);
    if (const Refitted* other = likelier_than(effect, round)) {
      JointParameters p = other->fit.at;  // in the same place, as what it explains is
      std::rotate(p.effects.begin() + static_cast<std::ptrdiff_t>(e), p.effects.end() - 1, p.effects.end());
      current = standing_at(model, p, other->fit.predicted);
      retake(of, *other, round.posterior);
      any = true;
      continue;
    }
    for (const Refitted& r : round.refitted) {
      if (r.effect != effect && !has(of.rivals, r.effect) &&
          round.posterior.instead(r.effect, effect) >= kPolicy.posterior.rival)
        of.rivals.push_back(r.effect);
    }
  }
  return any;
}

}  // namespace softarm::diagnose
