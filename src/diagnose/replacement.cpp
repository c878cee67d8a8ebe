#include "replacement.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "evidence_data.h"
#include "policy.h"
#include "rivals.h"

namespace softarm::diagnose {
namespace {

using model::Effect;

bool has(const EffectList& list, const Effect* effect) {
  return std::find(list.begin(), list.end(), effect) != list.end();
}

const Refitted& taken_of(const Round& round) {
  return round.refitted[static_cast<std::size_t>(round.taken)];
}

/// By effect of the model: what does nearly the same and is not in the model, the most alike first.
using ToCompare = std::vector<std::vector<Screened>>;

/// Of what is alike to an effect of the model, those that are to be compared with it, as the round that took
/// it had them.
std::vector<Screened> compared_with_it(std::vector<Alike> alike, const Round& round) {
  std::stable_sort(alike.begin(), alike.end(),
                   [](const Alike& a, const Alike& b) { return a.correlation > b.correlation; });
  std::vector<Screened> list;
  for (const Alike& other : alike) {
    const bool nearly = has(round.rivals, other.effect) || other.correlation > kPolicy.selection.rival_cosine;
    const bool looked_at = std::any_of(round.screened.begin(), round.screened.end(),
                                       [&](const Screened& s) { return s.effect == other.effect; });
    if (!nearly || !looked_at || list.size() == kPolicy.selection.most_compared) continue;
    list.push_back(screened_of(round, other.effect));
    if (const Refitted* r = refit_of(round, other.effect))
      list.back().values = r->fit.at.effects.back().values;
  }
  return list;
}

/// @param screened what is not in the model
ToCompare to_compare(JointModel& model, Standing& current, const Selection& selection,
                     const std::vector<Screened>& screened, const Options& options) {
  Round beside;
  beside.screened = screened;
  const EvidenceData& data = evidence_about(model, current, candidates_of(beside), options.jobs);
  ToCompare others;
  for (std::size_t e = 0; e < current.fit.at.effects.size(); ++e) {
    // The last came upon all others.
    const bool last = e + 1 == current.fit.at.effects.size();
    others.push_back(
        last ? std::vector<Screened>()
             : compared_with_it(alike_to(current.fit, data, e), selection.rounds[selection.round_of[e]]));
  }
  return others;
}

/// The effect, as the model has it, and those others, each fitted upon the model without it, from where that
/// is.
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
  const Effect* own = current.fit.at.effects[e].effect;
  Round round;
  round.screened = screened;
  for (Screened s : with) {
    s.absorbed = absorbed;
    const bool listed = std::any_of(screened.begin(), screened.end(),
                                    [&](const Screened& other) { return other.effect == s.effect; });
    if (!listed) round.screened.push_back(s);
    round.refitted.push_back(s.effect == own ? refitted_last(model, current.fit, e)
                                             : refit(model, without, s, round.refitted));
  }
  finish_leaders(model, without, round.refitted);
  linearise_leaders(model, without, round.refitted);
  round.posterior = posterior_of(model, without, round, options.jobs);
  compare(without, round.posterior, round.refitted);
  return round;
}

/// A round as if it had taken another effect, which explains what the one that it took did.
void retake(Round& round, const Refitted& other, const Round& compared) {
  const Refitted before = *refit_of(compared, taken_of(round).effect);
  const auto is_either = [&](const Effect* effect) {
    return effect == before.effect || effect == other.effect;
  };
  for (EffectList* list : {&round.rivals, &round.nearly_as_good})
    list->erase(std::remove_if(list->begin(), list->end(), is_either), list->end());
  Refitted taken = taken_of(round);
  taken.effect = other.effect;
  taken.probability = other.probability;
  taken.converged = other.converged;
  taken.fit = other.fit;
  round.refitted.erase(std::remove_if(round.refitted.begin(), round.refitted.end(),
                                      [&](const Refitted& r) { return is_either(r.effect); }),
                       round.refitted.end());
  round.refitted.insert(round.refitted.begin(), {std::move(taken), before});
  round.taken = 0;
  round.posterior = compared.posterior;
}

/// What a comparison says may be there in place of what a round took becomes its rival.
void add_rivals(Round& round, const Round& compared) {
  const Effect* taken = taken_of(round).effect;
  for (const Refitted& r : compared.refitted) {
    if (r.effect != taken && !has(round.rivals, r.effect) &&
        compared.posterior.instead(r.effect, taken) >= kPolicy.posterior.rival)
      round.rivals.push_back(r.effect);
  }
}

}  // namespace

const Refitted* likelier_than(const Effect* effect, const Round& compared) {
  const double own = refit_of(compared, effect)->probability;
  const Refitted* best = nullptr;
  double most = compared.posterior.of(effect);
  for (const Refitted& r : compared.refitted) {
    if (r.effect == effect || !r.physical || r.fit.given_up || !(r.probability > own)) continue;
    const double instead = compared.posterior.instead(r.effect, effect);
    if (!(instead > most)) continue;
    best = &r;
    most = instead;
  }
  return best;
}

bool put_likelier_in_place(JointModel& model, Standing& current, Selection& selection, const Options& options,
                           const std::function<void(double, const std::string&)>& progress) {
  if (current.fit.at.effects.size() < 2) return false;
  std::vector<Screened> screened = selection.rounds.back().screened;
  ToCompare others = to_compare(model, current, selection, screened, options);
  bool any = false;
  for (std::size_t e = 0; e < others.size(); ++e) {
    if (others[e].empty()) continue;
    Round& of = selection.rounds[selection.round_of[e]];
    const Effect* effect = current.fit.at.effects[e].effect;
    const auto left = std::count_if(others.begin() + static_cast<std::ptrdiff_t>(e), others.end(),
                                    [](const std::vector<Screened>& list) { return !list.empty(); });
    progress(static_cast<double>(left), "comparing " + effect->info().id + " with what does nearly the same");
    std::vector<Screened> list = others[e];
    Screened own = screened_of(of, effect);
    own.values = current.fit.at.effects[e].values;
    list.insert(list.begin(), own);
    Round compared = compared_with(model, current, e, list, screened, options);
    if (const Refitted* other = likelier_than(effect, compared)) {
      JointParameters p = other->fit.at;  // in the same place, as what it explains is
      std::rotate(p.effects.begin() + static_cast<std::ptrdiff_t>(e), p.effects.end() - 1, p.effects.end());
      current = standing_at(model, p, other->fit.predicted);
      // What is not in the model is another from here on.
      screened.erase(std::remove_if(screened.begin(), screened.end(),
                                    [&](const Screened& s) { return s.effect == other->effect; }),
                     screened.end());
      screened.push_back(std::move(own));
      without_fits(compared);
      retake(of, *other, compared);
      others = to_compare(model, current, selection, screened, options);
      any = true;
    }
    add_rivals(of, compared);
  }
  return any;
}

}  // namespace softarm::diagnose
