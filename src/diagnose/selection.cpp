#include "selection.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "background.h"
#include "doubt.h"
#include "policy.h"
#include "refits.h"
#include "rivals.h"

namespace softarm::diagnose {
namespace {

using model::Present;

constexpr double kClearlyThere = 4.0;  // of what is trivial: to first order, so no fit without it is needed

/// Takes the round's best into the model.
void take(JointModel& model, const Refitted& best, Standing& current) {
  current = {best.fit, best.unseen};
  if (!model.has_configuration_dependent_load(current.fit.at)) return;
  current.fit = model.linearise(best.fit.at, &best.fit.predicted, JointModel::Derivatives::kWhole);
  current.fit.converged = best.converged;
  current.unseen = unseen(model, current.fit);
}

/// What was screened, each at the values of its refit where it had one.
std::vector<Present> candidates_of(const Round& round) {
  std::vector<Present> candidates;
  for (const Screened& s : round.screened) {
    Present candidate{s.effect, s.values};
    for (const Refitted& r : round.refitted)
      if (r.effect == s.effect) candidate = r.fit.at.effects.back();
    candidates.push_back(std::move(candidate));
  }
  return candidates;
}

Posterior posterior_of(JointModel& model, Standing& current, const Round& round, unsigned jobs) {
  std::vector<RefitEvidence> refits;
  for (const Refitted& r : round.refitted)
    refits.push_back({r.effect, evidence_of_refit(model, r.fit, current.fit)});
  return posterior(evidence_data(model, current.fit, candidates_of(round), jobs), refits, jobs);
}

/// One round: screen, refits of what explains most, the posterior, refits of what is more probable than not.
/// @param may_move whether the model so far may come to better constants, from which the round begins again
Round look(JointModel& model, Standing& current, bool refits, bool may_move, const Options& options,
           const std::function<void(double, const std::string&)>& progress) {
  Round round;
  model.set_misfit(std::max(1.0, current.fit.square / std::max(1, current.fit.rows)));
  progress(0.0, "screening the catalogue");
  round.screened = screen(model, current.fit, options.jobs, [](double) {});
  const std::vector<std::size_t> worth =
      refits ? worth_a_refit(model, round.screened, options) : std::vector<std::size_t>{};
  for (std::size_t i = 0; i < worth.size(); ++i) {
    const Screened& s = round.screened[worth[i]];
    progress(0.1 + 0.8 * static_cast<double>(i) / static_cast<double>(worth.size()),
             "refitting with " + s.effect->info().id);
    round.refitted.push_back(refit(model, current, s));
  }
  if (may_move) {
    if (std::optional<Standing> better = at_better_constants(model, current, round.refitted)) {
      current = std::move(*better);
      round = look(model, current, refits, false, options, progress);
      round.anew = true;
      return round;
    }
  }
  progress(0.9, "how probable all of them are");
  round.posterior = posterior_of(model, current, round, options.jobs);
  for (const Screened& s : round.screened) {
    const bool known = std::any_of(round.refitted.begin(), round.refitted.end(),
                                   [&](const Refitted& r) { return r.effect == s.effect; });
    if (!refits || known || round.posterior.of(s.effect) < kPolicy.posterior.rival ||
        of_class(round, s.effect) < kPolicy.posterior.named)
      continue;
    progress(0.95, "refitting with " + s.effect->info().id);
    round.refitted.push_back(refit(model, current, s));
  }
  compare(current, round.posterior, round.refitted);
  round.taken = best_of(model, round);
  if (round.taken >= 0) round.rivals = rivals_of(round);
  return round;
}

/// Takes what is as good as certain beside the round's best, each after a fit of its own.
/// @param taken called with each of them: a round of its own
void take_beside(JointModel& model, const Round& round, Standing& current, std::size_t most,
                 const std::function<void(Round)>& taken) {
  EffectList list{round.refitted[static_cast<std::size_t>(round.taken)].effect};
  for (const Screened& s : round.screened) {
    if (list.size() >= most) return;
    if (!is_certain_beside(round, s, list)) continue;
    Round own;
    own.screened = round.screened;
    own.posterior = round.posterior;
    own.refitted.push_back(refit(model, current, s));
    compare(current, own.posterior, own.refitted);
    own.taken = best_of(model, own);
    if (own.taken < 0 || !own.refitted.front().converged) continue;
    own.rivals = rivals_of(own);
    take(model, own.refitted.front(), current);
    list.push_back(s.effect);
    taken(std::move(own));
  }
}

/// Fits are large, and not looked at again.
void without_fits(Round& round) {
  for (Refitted& r : round.refitted) {
    JointParameters at = std::move(r.fit.at);
    r.fit = {};
    r.fit.at = std::move(at);
    r.unseen.residual.clear();
  }
}

/// What was screened last, but for what may be mistaken for effects of the model.
Round without_rivals(const Selection& selection) {
  Round alone;
  for (const Screened& s : selection.rounds.back().screened) {
    const bool rival = std::any_of(selection.round_of.begin(), selection.round_of.end(), [&](std::size_t r) {
      const EffectList& rivals = selection.rounds[r].rivals;
      return std::find(rivals.begin(), rivals.end(), s.effect) != rivals.end();
    });
    if (!rival) alone.screened.push_back(s);
  }
  return alone;
}

/// Takes out of the model again what has become superfluous.
/// @return whether there was any
bool drop_superfluous(JointModel& model, Standing& current, std::vector<std::size_t>& round_of) {
  bool dropped = false;
  for (std::size_t e = 0; current.fit.at.effects.size() > 1 && e < current.fit.at.effects.size();) {
    if (moved_without_m(current, e) > kClearlyThere * trivial_m(model)) {
      ++e;
      continue;
    }
    Standing without = refit_without(model, current, e);
    if (moved_m(without.unseen, current.unseen) >= trivial_m(model)) {
      ++e;
      continue;
    }
    current = std::move(without);
    round_of.erase(round_of.begin() + static_cast<std::ptrdiff_t>(e));
    dropped = true;
    e = 0;
  }
  return dropped;
}

/// What the model ends with.
struct Ending {
  double background = 0.0;
  Unseen unseen;
};

/// How sure every effect of the model is, all others given.
/// @param of_all the posterior about this model
void add_doubt_about(JointModel& model, Standing& current, const Posterior& of_all, const Options& options,
                     Selection& selection) {
  const Round alone = without_rivals(selection);
  const std::size_t catalogue = selection.rounds.front().screened.size();
  add_doubt(current.fit, of_all,
            alone.screened.size() < selection.rounds.back().screened.size()
                ? posterior_of(model, current, alone, options.jobs)
                : of_all,
            catalogue, selection);
}

/// Takes out again what has become superfluous, then, while true refits predict unseen trials no better than
/// the arm's constants alone do, what is least sure.
Ending end_with_what_predicts(JointModel& model, Standing& current, Selection& selection,
                              const Options& options) {
  Round last;
  last.screened = selection.rounds.back().screened;
  Posterior of_all = selection.rounds.back().posterior;
  if (drop_superfluous(model, current, selection.round_of))
    of_all = posterior_of(model, current, last, options.jobs);
  for (;;) {
    add_doubt_about(model, current, of_all, options, selection);
    if (current.fit.at.effects.empty()) return {of_all.background, selection.baseline_unseen};
    Unseen unseen = refitted_unseen(model, current.fit);
    if (unseen.total_rms_m < selection.baseline_unseen.total_rms_m)
      return {of_all.background, std::move(unseen)};
    const auto least = std::min_element(selection.still_there.begin(), selection.still_there.end()) -
                       selection.still_there.begin();
    current = refit_without(model, current, static_cast<std::size_t>(least));
    selection.round_of.erase(selection.round_of.begin() + least);
    of_all = posterior_of(model, current, last, options.jobs);
  }
}

}  // namespace

Selection select(JointModel& model, Linearised baseline, const Options& options,
                 const std::function<void(double, const std::string&)>& progress) {
  Selection selection;
  selection.baseline_unseen = refitted_unseen(model, baseline);
  selection.baseline = baseline;
  Standing current{std::move(baseline), {}};
  current.unseen = unseen(model, current.fit);
  selection.first_order_rms_m = current.unseen.total_rms_m;
  const double share = 1.0 / (options.most_effects + 1);
  const auto most = static_cast<std::size_t>(std::max(0, options.most_effects));
  for (bool taken = true; taken;) {
    const std::size_t n = selection.round_of.size();
    Round round = look(model, current, n < most, true, options, [&](double done, const std::string& what) {
      progress((static_cast<double>(n) + done) * share, what);
    });
    if (round.anew && n == 0) {
      selection.baseline_unseen = refitted_unseen(model, current.fit);
      selection.baseline = current.fit;
      selection.first_order_rms_m = current.unseen.total_rms_m;
    }
    taken = round.taken >= 0;
    std::vector<Round> beside;
    if (taken) {
      take(model, round.refitted[static_cast<std::size_t>(round.taken)], current);
      take_beside(model, round, current, most - n, [&](Round own) { beside.push_back(std::move(own)); });
    }
    beside.insert(beside.begin(), std::move(round));
    for (Round& one : beside) {
      if (taken) selection.round_of.push_back(selection.rounds.size());
      without_fits(one);
      selection.rounds.push_back(std::move(one));
    }
  }
  const Ending ending = end_with_what_predicts(model, current, selection, options);
  selection.extended = std::move(current.fit);
  selection.extended_unseen = ending.unseen;
  selection.with_background =
      with_background(model, selection.extended, candidates_of(selection.rounds.back()), ending.background,
                      selection.extended_unseen, options.jobs);
  selection.inflation = inflation(selection.extended);
  return selection;
}

}  // namespace softarm::diagnose
