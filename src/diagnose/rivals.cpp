#include "rivals.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "policy.h"

namespace softarm::diagnose {
namespace {

using model::Effect;

/// Whether one tends to be there where the other is not.
bool take_turns(const Posterior& posterior, const Effect* one, const Effect* other) {
  const double instead = posterior.instead(other, one), with = posterior.of(other) - instead;
  const double of_one = posterior.of(one);
  return instead >= kPolicy.posterior.rival &&
         instead * of_one > kPolicy.posterior.turns * with * (1.0 - of_one);
}

/// Which of two goes into the model first: by the gain on unseen trials of those that are more probable than
/// not, else by probability.
bool leads(const Refitted& one, const Refitted& other) {
  const auto key = [](const Refitted& r) {
    const bool likely = r.probability >= kPolicy.posterior.named;
    return std::pair(likely, likely ? r.probability * r.gain : r.probability);
  };
  return key(one) > key(other);
}

}  // namespace

const Screened& screened_of(const Round& round, const Effect* effect) {
  return *std::find_if(round.screened.begin(), round.screened.end(),
                       [&](const Screened& s) { return s.effect == effect; });
}

double of_class(const Round& round, const Effect* effect) {
  EffectList list{effect};
  for (const Screened& s : round.screened) {
    if (s.effect != effect && take_turns(round.posterior, effect, s.effect)) list.push_back(s.effect);
  }
  return round.posterior.of_any(list);
}

int best_of(const JointModel& model, const Round& round) {
  int best = -1;
  for (std::size_t i = 0; i < round.refitted.size(); ++i) {
    const Refitted& r = round.refitted[i];
    if (std::min(of_class(round, r.effect), r.elsewhere) < kPolicy.posterior.named ||
        r.probability < kPolicy.posterior.rival || !r.physical || r.moved_m < trivial_m(model))
      continue;
    // A fit that did not come to an end says too little of its effect, not too much.
    if (best < 0 || leads(r, round.refitted[static_cast<std::size_t>(best)])) best = static_cast<int>(i);
  }
  return best;
}

EffectList rivals_of(const Round& round) {
  EffectList rivals;
  const Refitted& first = round.refitted[static_cast<std::size_t>(round.taken)];
  const Screened& own = screened_of(round, first.effect);
  for (const Screened& s : round.screened) {
    if (s.effect == first.effect) continue;
    const double cosine = std::abs(s.direction.dot(own.direction));
    const bool as_good = std::any_of(round.refitted.begin(), round.refitted.end(), [&](const Refitted& r) {
      return r.effect == s.effect && r.physical && first.gain - r.gain < kPolicy.selection.rival_gain;
    });
    if (as_good || take_turns(round.posterior, first.effect, s.effect) ||
        (cosine > kPolicy.selection.rival_cosine &&
         first.z * std::sqrt(1.0 - cosine * cosine) < kPolicy.selection.rival_z))
      rivals.push_back(s.effect);
  }
  return rivals;
}

const Round& round_with_rival(const Selection& selection, std::size_t own, const Effect* rival) {
  for (std::size_t n = own + 1; n-- > 0;) {
    const std::vector<Screened>& screened = selection.rounds[n].screened;
    if (std::any_of(screened.begin(), screened.end(), [&](const Screened& s) { return s.effect == rival; }))
      return selection.rounds[n];
  }
  return selection.rounds[own];
}

void set_rivals(Round& round) {
  round.rivals = rivals_of(round);
  round.nearly_as_good = nearly_as_good(round);
}

EffectList nearly_as_good(const Round& round) {
  const Refitted& first = round.refitted[static_cast<std::size_t>(round.taken)];
  const double explained_m2 = std::pow(first.moved_m, 2);
  const double noise_share = std::min(1.0, first.fit.rows / std::max(1.0, first.unseen.total_chi2));
  const double left_m2 = std::pow(first.unseen.total_rms_m, 2) * (1.0 - noise_share);
  EffectList list;
  if (!(left_m2 > 0.0)) return list;
  for (const Refitted& r : round.refitted) {
    const double own_m2 = std::pow(r.moved_m, 2);
    const bool rival = std::find(round.rivals.begin(), round.rivals.end(), r.effect) != round.rivals.end();
    if (r.effect != first.effect && !rival && r.physical &&
        own_m2 > kPolicy.selection.rival_explains * explained_m2 &&
        explained_m2 - own_m2 < std::pow(kPolicy.selection.rival_left, 2) * left_m2)
      list.push_back(r.effect);
  }
  return list;
}

bool take_best(JointModel& model, Round& round, Standing& current) {
  while (round.taken >= 0) {
    Refitted& best = round.refitted[static_cast<std::size_t>(round.taken)];
    Standing next = standing_on(model, best.fit);
    const double least_fall = std::pow(kPolicy.selection.least_z, 2) * inflation(next.fit);
    if (next.unseen.total_chi2 < current.unseen.total_chi2 - least_fall ||
        moved_m(current.unseen, next.unseen) >= trivial_m(model)) {
      current = std::move(next);
      return true;
    }
    best.elsewhere = 0.0;
    round.taken = best_of(model, round);
    if (round.taken >= 0) set_rivals(round);
  }
  return false;
}

bool is_certain_beside(const Round& round, const Screened& s, const EffectList& taken) {
  if (round.posterior.of(s.effect) < kPolicy.posterior.certain) return false;
  return std::none_of(taken.begin(), taken.end(), [&](const Effect* other) {
    return other == s.effect || take_turns(round.posterior, s.effect, other) ||
           take_turns(round.posterior, other, s.effect) ||
           std::abs(s.direction.dot(screened_of(round, other).direction)) > kPolicy.selection.distinct_cosine;
  });
}

}  // namespace softarm::diagnose
