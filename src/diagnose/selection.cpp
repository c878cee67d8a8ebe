#include "selection.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "background.h"
#include "ending.h"
#include "policy.h"
#include "refits.h"
#include "rivals.h"

namespace softarm::diagnose {
namespace {

using Progress = std::function<void(double, const std::string&)>;

// What is left, as multiples of the time of the constants' fits: as of untidy cases with nine trials.
constexpr double kFirstScreen = 0.37, kScreen = 0.24, kRefit = 0.4, kUsualRefits = 4.0, kFirstLeaders = 0.4,
                 kLeaders = 0.8, kPosterior = 0.95;
constexpr double kRound = kScreen + kUsualRefits * kRefit + kLeaders + kPosterior,
                 kLastRound = kScreen + kPosterior;       // that finds nothing worth a refit
constexpr double kAfterFirst = 1.3, kAfterOthers = 0.45;  // rounds that do, if one more effect is taken
// One effect of the model with what does nearly the same: fits without it, and of some three upon that. Every
// other effect that others came after has such.
constexpr double kComparison = 2.0 * kRefit + 2.0 * kRefit + kFirstLeaders + kPosterior, kCompared = 0.5;
constexpr double kEnding = 0.4;

/// After the last round. @param beside effects of the model beside one
double ending(double beside) {
  return beside * kCompared * kComparison + kEnding;
}

/// After this round, if it takes an effect.
double rounds_left(bool first) {
  const double after = first ? kAfterFirst : kAfterOthers;
  return after * kRound + kLastRound + ending(first ? after : 1.0 + after);
}

/// Refits of what is more probable than not, or one of a class that is, and was not refitted.
bool refit_the_probable(JointModel& model, const Standing& current, Round& round, const Progress& progress) {
  bool any = false;
  for (const Screened& s : round.screened) {
    if (refit_of(round, s.effect) != nullptr || round.posterior.of(s.effect) < kPolicy.posterior.rival ||
        of_class(round, s.effect) < kPolicy.posterior.named)
      continue;
    progress(kPosterior + rounds_left(false), "refitting with " + s.effect->info().id);
    round.refitted.push_back(refit(model, current, s, round.refitted));
    any = true;
  }
  return any;
}

/// One round: screen, refits of what explains most, the posterior, refits of what is more probable than not.
/// @param first of all rounds
/// @param may_move whether the model so far may come to better constants, from which the round begins again
/// @param delayed a fit with one effect more, from which its refit begins; null: none
Round look(JointModel& model, Standing& current, bool first, bool refits, bool may_move,
           const Linearised* delayed, KnownSignatures& signatures, const Options& options,
           const Progress& progress) {
  Round round;
  model.set_misfit(std::max(1.0, current.fit.square / std::max(1, current.fit.rows)));
  const double leaders = first ? kFirstLeaders : kLeaders, after = rounds_left(first);
  progress(first ? kFirstScreen + kUsualRefits * kRefit + leaders + kPosterior + after : kRound + after,
           "screening the catalogue");
  round.screened = screen(
      model, current.fit, options.jobs, [](double) {}, &signatures);
  if (delayed != nullptr) begin_from(model, current, *delayed, round.screened);
  const std::vector<std::size_t> worth =
      refits ? worth_a_refit(model, round.screened, options) : std::vector<std::size_t>{};
  for (std::size_t i = 0; i < worth.size(); ++i) {
    const Screened& s = round.screened[worth[i]];
    progress(static_cast<double>(worth.size() - i) * kRefit + leaders + kPosterior + after,
             "refitting with " + s.effect->info().id);
    round.refitted.push_back(refit(model, current, s, round.refitted));
  }
  if (!worth.empty()) progress(leaders + kPosterior + after, "refitting with what explains most");
  finish_leaders(model, current, round.refitted);
  refit_what_is_alike(model, current, round.screened, round.refitted);
  if (may_move) {
    if (std::optional<Standing> better = at_better_constants(model, current, round.refitted)) {
      current = std::move(*better);
      round = look(model, current, first, refits, false, delayed, signatures, options, progress);
      round.anew = true;
      return round;
    }
  }
  linearise_leaders(model, current, round.refitted);
  progress(kPosterior + (worth.empty() ? ending(first ? 0.0 : kAfterOthers) : after),
           "computing probabilities");
  round.posterior = posterior_of(model, current, round, options.jobs);
  while (refits && refit_the_probable(model, current, round, progress)) {
    linearise_leaders(model, current, round.refitted);
    round.posterior = posterior_of(model, current, round, options.jobs);
  }
  compare(current, round.posterior, round.refitted);
  round.taken = best_of(model, round);
  if (round.taken >= 0) set_rivals(round);
  return round;
}

/// However little is left, what is certain to be there is not left out.
bool is_any_certain(const Round& round) {
  return std::any_of(round.screened.begin(), round.screened.end(), [&](const Screened& s) {
    return round.posterior.of(s.effect) >= kPolicy.posterior.certain;
  });
}

/// Takes what is as good as certain beside the round's best, each after a fit of its own.
/// @param before effects of the model before the round
/// @param taken called with each of them: a round of its own
void take_beside(JointModel& model, const Round& round, Standing& current, std::size_t before,
                 const Options& options, const std::function<void(Round)>& taken) {
  EffectList list{round.refitted[static_cast<std::size_t>(round.taken)].effect};
  for (const Screened& s : round.screened) {
    if (before + list.size() >= most_effects(model, current, options)) return;
    if (!is_certain_beside(round, s, list)) continue;
    Round own;
    own.screened = round.screened;
    own.posterior = round.posterior;
    own.refitted.push_back(refit(model, current, s));
    compare(current, own.posterior, own.refitted);
    own.taken = best_of(model, own);
    if (own.taken < 0 || !own.refitted.front().converged) continue;
    set_rivals(own);
    current = standing_on(model, own.refitted.front().fit);
    list.push_back(s.effect);
    taken(std::move(own));
  }
}

}  // namespace

Selection select(JointModel& model, Linearised baseline, const std::optional<Linearised>& delayed,
                 const Options& options, const std::function<void(double, const std::string&)>& progress) {
  Selection selection;
  selection.baseline_unseen = refitted_unseen(model, baseline);
  selection.baseline = baseline;
  Standing current{std::move(baseline), {}};
  current.unseen = unseen(model, current.fit);
  selection.first_order_rms_m = current.unseen.total_rms_m;
  KnownSignatures signatures;
  for (bool taken = true; taken;) {
    const std::size_t n = selection.round_of.size();
    const auto look_here = [&](bool refits) {
      return look(model, current, n == 0, refits, true, n == 0 && delayed ? &*delayed : nullptr, signatures,
                  options, progress);
    };
    const bool refits = n < most_effects(model, current, options);
    Round round = look_here(refits);
    if (!refits && n < static_cast<std::size_t>(std::max(0, options.most_effects)) && is_any_certain(round))
      round = look_here(true);
    const bool lost = n >= kPolicy.selection.most_stand_ins && round.taken >= 0 &&
                      is_lost(model, current, round, selection, options);
    if (lost) round.taken = -1;
    if (round.anew && n == 0) {
      selection.baseline_unseen = refitted_unseen(model, current.fit);
      selection.baseline = current.fit;
      selection.first_order_rms_m = current.unseen.total_rms_m;
    }
    taken = !lost && take_best(model, round, current);
    std::vector<Round> beside;
    if (taken) {
      take_beside(model, round, current, n, options, [&](Round own) { beside.push_back(std::move(own)); });
    }
    beside.insert(beside.begin(), std::move(round));
    for (Round& one : beside) {
      if (taken) selection.round_of.push_back(selection.rounds.size());
      without_fits(one);
      selection.rounds.push_back(std::move(one));
    }
  }
  const Ending ended = end_with_what_predicts(model, current, selection, options,
                                              [&](double comparisons, const std::string& what) {
                                                progress(comparisons * kComparison + kEnding, what);
                                              });
  selection.extended = std::move(current.fit);
  selection.extended_unseen = ended.unseen;
  selection.with_background =
      with_background(model, selection.extended, candidates_of(selection.rounds.back()), ended.background,
                      selection.extended_unseen, options.jobs);
  selection.inflation = inflation(selection.extended);
  return selection;
}

}  // namespace softarm::diagnose
