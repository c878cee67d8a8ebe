#include "ending.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "doubt.h"
#include "findings.h"
#include "floor.h"
#include "policy.h"
#include "replacement.h"
#include "screen.h"

namespace softarm::diagnose {
namespace {

constexpr double kNothing = 1e-6;  // of a usual size: rounding

/// What was screened, but for what may be mistaken for effects of the model.
Round without_rivals(const Selection& selection, const std::vector<Screened>& screened) {
  Round alone;
  for (const Screened& s : screened) {
    const bool rival = std::any_of(selection.round_of.begin(), selection.round_of.end(), [&](std::size_t r) {
      const EffectList& rivals = selection.rounds[r].rivals;
      return std::find(rivals.begin(), rivals.end(), s.effect) != rivals.end();
    });
    if (!rival) alone.screened.push_back(s);
  }
  return alone;
}

/// Whether an effect's sizes have all become nothing, as those do that end at the end of their range.
bool is_nothing(const model::Present& present) {
  const model::Info& info = present.effect->info();
  for (int k = 0; k < info.sizes; ++k) {
    if (std::abs(present.values[k]) > kNothing * info.parameters[static_cast<std::size_t>(k)].usual)
      return false;
  }
  return true;
}

/// The model without one of its effects, where that has become superfluous; nothing: it has not.
std::optional<Standing> without_superfluous(JointModel& model, const Standing& current, std::size_t effect) {
  if (moved_without_m(current, effect) > kPolicy.selection.clearly_there * trivial_m(model))
    return std::nullopt;
  Standing without = refit_without(model, current, effect);
  if (!is_nothing(current.fit.at.effects[effect]) &&
      moved_m(without.unseen, current.unseen) >= trivial_m(model))
    return std::nullopt;
  return without;
}

/// What was in the model may be there in place of an effect that stays.
void add_rival(Selection& selection, std::size_t stays, const model::Effect* gone) {
  EffectList& rivals = selection.rounds[selection.round_of[stays]].rivals;
  if (std::find(rivals.begin(), rivals.end(), gone) == rivals.end()) rivals.push_back(gone);
}

/// Takes out of the model again what has become superfluous. What would have been superfluous in its place,
/// and is not without it, does the same.
/// @return whether there was any
bool drop_superfluous(JointModel& model, Standing& current, Selection& selection) {
  bool dropped = false;
  for (std::size_t e = 0; current.fit.at.effects.size() > 1 && e < current.fit.at.effects.size();) {
    const std::optional<Standing> without = without_superfluous(model, current, e);
    if (!without) {
      ++e;
      continue;
    }
    const Standing with = std::exchange(current, standing_on(model, without->fit));
    selection.round_of.erase(selection.round_of.begin() + static_cast<std::ptrdiff_t>(e));
    for (std::size_t after = e; after < current.fit.at.effects.size(); ++after) {
      if (without_superfluous(model, with, after + 1) && !without_superfluous(model, current, after))
        add_rival(selection, after, with.fit.at.effects[e].effect);
    }
    dropped = true;
    e = 0;
  }
  return dropped;
}

/// Two effects of the model that are each doubtful because the other can do what it does.
using Pair = std::pair<std::size_t, std::size_t>;
std::optional<Pair> doing_the_same(const Linearised& at, const Doubt& doubt) {
  const auto correlation = [&](std::size_t one, std::size_t other) {
    double most = 0.0;
    for (const Eigen::Index i : rows_of_sizes(at, one)) {
      for (const Eigen::Index j : rows_of_sizes(at, other))
        most = std::max(most, std::abs(doubt.covariance(i, j)) /
                                  std::sqrt(doubt.covariance(i, i) * doubt.covariance(j, j)));
    }
    return most;
  };
  for (std::size_t e = 0; e < doubt.still_there.size(); ++e) {
    for (std::size_t f = 0; f < e; ++f) {
      if (std::max(doubt.still_there[e], doubt.still_there[f]) < kPolicy.posterior.named &&
          correlation(e, f) > kPolicy.selection.rival_cosine)
        return Pair{e, f};
    }
  }
  return std::nullopt;
}

/// How sure all of the model is.
/// @param of_all the posterior about this model
/// @param screened upon it
/// @param selection that came to it
Doubt doubt_in(JointModel& model, Standing& current, const Posterior& of_all,
               const std::vector<Screened>& screened, const Options& options, const Selection& selection) {
  Round alone = without_rivals(selection, screened);
  const std::size_t catalogue = selection.rounds.front().screened.size();
  return doubt_about(
      current.fit, of_all,
      alone.screened.size() < screened.size() ? posterior_of(model, current, alone, options.jobs) : of_all,
      between_folds(model, current.fit), catalogue, model.unknown_inertia());
}

/// A last round upon the model that something was taken out of, which looks at that like at all others. What
/// was refitted in the one before stays.
void look_again(JointModel& model, Standing& current, Selection& selection, const Options& options) {
  Round last;
  last.screened = screen(model, current.fit, options.jobs, [](double) {});
  last.posterior = posterior_of(model, current, last, options.jobs);
  last.refitted = selection.rounds.back().refitted;
  selection.rounds.push_back(std::move(last));
}

}  // namespace

bool keep_one_of_two_alike(JointModel& model, Standing& current, Selection& selection) {
  const std::optional<Pair> pair = doing_the_same(current.fit, selection.doubt);
  if (!pair) return false;
  auto [gone, stays] = *pair;
  Standing without = refit_without(model, current, gone);
  Standing without_other = refit_without(model, current, stays);
  if (without.unseen.total_chi2 > without_other.unseen.total_chi2) {
    std::swap(gone, stays);
    std::swap(without, without_other);
  }
  add_rival(selection, stays, current.fit.at.effects[gone].effect);
  current = standing_on(model, without.fit);
  selection.round_of.erase(selection.round_of.begin() + static_cast<std::ptrdiff_t>(gone));
  return true;
}

bool is_lost(JointModel& model, Standing& current, const Round& round, const Selection& selection,
             const Options& options) {
  const double length_m = model.arm().total_length_m();
  const double left_m2 = std::max(0.0, std::pow(current.unseen.total_rms_m, 2) - floor_of(model).white_m2);
  const auto there = [&](const model::Present& present, double probability, const Refitted& r,
                         double without_m2) {
    const bool of_sensors = is_of_sensors_alone(present.effect->info(), is_short_delay(present));
    const double left_m = std::sqrt(std::max(0.0, without_m2));
    return probability * is_no_stand_in(r.moved_m, left_m, length_m, of_sensors);
  };
  double next_there = 0.0;
  if (round.taken >= 0) {
    const Refitted& next = round.refitted[static_cast<std::size_t>(round.taken)];
    next_there =
        there(next.fit.at.effects.back(), next.probability, next, left_m2 - next.moved_m * next.moved_m);
  }
  if (next_there >= kPolicy.posterior.named) return false;
  const Doubt doubt = doubt_in(model, current, round.posterior, round.screened, options, selection);
  std::vector<double> own;
  for (std::size_t e = 0; e < doubt.still_there.size(); ++e) {
    const Round& of = selection.rounds[selection.round_of[e]];
    own.push_back(there(current.fit.at.effects[e], doubt.still_there[e],
                        of.refitted[static_cast<std::size_t>(of.taken)], left_m2));
  }
  // Of two that do the same each is doubtful on the other's account, and one will stay.
  if (const std::optional<Pair> same = doing_the_same(current.fit, doubt)) {
    own[same->second] = std::max(own[same->first], own[same->second]);
    own.erase(own.begin() + static_cast<std::ptrdiff_t>(same->first));
  }
  // The least probable ones: one more effect that may be there does not speak for them.
  if (own.size() < kPolicy.selection.most_stand_ins) return false;
  std::sort(own.begin(), own.end());
  double none_there = 1.0;
  for (std::size_t i = 0; i < kPolicy.selection.most_stand_ins; ++i) none_there *= 1.0 - own[i];
  return none_there > kPolicy.posterior.named;
}

Doubt doubt_in_another(JointModel& other, const Linearised& alone, const Selection& selection,
                       const Options& options) {
  // What stands in for something may hold the constants where they were: a fit begins without it, too.
  JointParameters without = alone.at;
  for (model::Present present : selection.extended.at.effects) {
    present.values.head(present.effect->info().sizes).setZero();
    without.effects.push_back(std::move(present));
  }
  Linearised best = other.fit(without, {});
  Linearised from_there = other.fit(selection.extended.at, {});
  if (from_there.square < best.square) best = std::move(from_there);
  Standing standing = standing_on(other, best);
  Round last;
  last.screened = selection.rounds.back().screened;
  const Posterior of_all = posterior_of(other, standing, last, options.jobs);
  return doubt_in(other, standing, of_all, last.screened, options, selection);
}

Ending end_with_what_predicts(JointModel& model, Standing& current, Selection& selection,
                              const Options& options,
                              const std::function<void(double, const std::string&)>& progress) {
  if (drop_superfluous(model, current, selection)) look_again(model, current, selection, options);
  bool changed = put_likelier_in_place(model, current, selection, options, progress);
  progress(0.0, "testing each on unseen trials");
  for (;;) {
    if (changed) look_again(model, current, selection, options);
    const Round& last = selection.rounds.back();
    selection.doubt = doubt_in(model, current, last.posterior, last.screened, options, selection);
    changed = keep_one_of_two_alike(model, current, selection);
    if (changed) continue;
    if (current.fit.at.effects.empty()) return {last.posterior.background, selection.baseline_unseen};
    Unseen unseen = refitted_unseen(model, current.fit);
    if (unseen.total_rms_m < selection.baseline_unseen.total_rms_m)
      return {last.posterior.background, std::move(unseen)};
    const std::vector<double>& there = selection.doubt.still_there;
    const auto least = std::min_element(there.begin(), there.end()) - there.begin();
    current = standing_on(model, refit_without(model, current, static_cast<std::size_t>(least)).fit);
    selection.round_of.erase(selection.round_of.begin() + least);
    changed = true;
  }
}

}  // namespace softarm::diagnose
