#include "ranking.h"

#include <algorithm>

#include "policy.h"
#include "rivals.h"

namespace softarm::diagnose {
namespace {

using model::Effect;

/// What the screen says of a candidate.
Candidate candidate_of(const Screened& s) {
  const model::Info& info = s.effect->info();
  Candidate c;
  c.id = info.id;
  c.description = info.description;
  c.collinearity = s.collinearity;
  c.z = s.z;
  c.size_m = s.size_m;
  c.symbol = info.parameters.front().symbol;
  c.unit = info.parameters.front().unit;
  c.estimate = s.values[0];
  c.smallest_detectable = kPolicy.verdict.detectable_z * s.sd[0];
  c.detectable = s.usual_z >= kPolicy.verdict.detectable_z;
  return c;
}

Candidate candidate_of(const Round& round, const Effect* effect) {
  const auto found = std::find_if(round.screened.begin(), round.screened.end(),
                                  [&](const Screened& s) { return s.effect == effect; });
  return found == round.screened.end() ? Candidate{} : candidate_of(*found);
}

/// Whether a round took it, so that it was in the model.
bool was_taken(const Selection& selection, const Effect* effect) {
  return std::any_of(selection.rounds.begin(), selection.rounds.end(), [&](const Round& round) {
    return round.taken >= 0 && round.refitted[static_cast<std::size_t>(round.taken)].effect == effect;
  });
}

/// One that is not in the model, by the last screen.
Candidate left_aside(const JointModel& model, const Selection& selection, const Screened& s) {
  const double trivial_m = kPolicy.selection.trivial * model.arm().total_length_m();
  Candidate c = candidate_of(s);
  // Not refitted: as far as other trials say so, and never more probable than what is named.
  if (s.unseen_gain > 0.0)
    c.probability = std::min(selection.rounds.back().posterior.of(s.effect), kPolicy.posterior.named);
  bool trivial = s.z >= kPolicy.selection.least_z && s.leftover_m < trivial_m;
  if (const Refitted* r = refit_of(selection.rounds.back(), s.effect)) {
    // Of being there at a size that matters. What was not taken though it is more probable stands in for
    // something, or predicts no better by derivatives of its own.
    c.probability = std::min(r->probability, kPolicy.posterior.named);
    trivial = r->z >= kPolicy.selection.least_z && r->moved_m < trivial_m;
    if (r->moved_m < trivial_m || !r->physical) c.probability = 0.0;
    c.possible = r->physical;
    c.log_score = r->gain / std::max(1, selection.extended.rows / 3);
  }
  c.finding = !c.detectable ? Finding::kCannotTell : trivial ? Finding::kTrivial : Finding::kAbsent;
  return c;
}

}  // namespace

std::vector<Candidate> ranking_of(const JointModel& model, const Selection& selection) {
  std::vector<Candidate> list;
  const auto known = [&](const Effect* effect) {
    return std::any_of(list.begin(), list.end(),
                       [&](const Candidate& c) { return c.id == effect->info().id; });
  };
  const Linearised& extended = selection.extended;
  const double bodies = std::max(1, extended.rows / 3);
  for (std::size_t e = 0; e < extended.at.effects.size(); ++e) {
    const Round& round = selection.rounds[selection.round_of[e]];
    const Refitted& r = round.refitted[static_cast<std::size_t>(round.taken)];
    Candidate c = candidate_of(round, r.effect);
    c.finding = Finding::kPresent;
    c.probability = r.probability;
    c.z = r.z;
    c.estimate = extended.at.effects[e].values[0];
    c.log_score = r.gain / bodies;
    list.push_back(std::move(c));
  }
  const auto add_rivals = [&](std::size_t n, const EffectList& rivals) {
    for (const Effect* rival : rivals) {
      if (known(rival)) continue;
      const Round& round = round_with_rival(selection, n, rival);
      Candidate c = candidate_of(round, rival);
      c.finding = Finding::kRival;
      c.probability = round.posterior.of(rival);
      // It was taken, and taken out again for the one that stays.
      if (was_taken(selection, rival)) c.probability = std::min(c.probability, kPolicy.posterior.named);
      if (const Refitted* r = refit_of(round, rival)) {
        c.z = r->z;
        c.log_score = r->gain / bodies;
      }
      list.push_back(std::move(c));
    }
  };
  for (const std::size_t n : selection.round_of) add_rivals(n, selection.rounds[n].rivals);
  for (const std::size_t n : selection.round_of) add_rivals(n, selection.rounds[n].nearly_as_good);
  std::vector<Candidate> others;
  for (const Screened& s : selection.rounds.back().screened)
    if (!known(s.effect)) others.push_back(left_aside(model, selection, s));
  std::stable_sort(others.begin(), others.end(), [](const Candidate& a, const Candidate& b) {
    return a.probability != b.probability ? a.probability > b.probability : a.z > b.z;
  });
  list.insert(list.end(), others.begin(), others.end());
  return list;
}

}  // namespace softarm::diagnose
