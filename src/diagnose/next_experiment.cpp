#include "next_experiment.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "policy.h"
#include "rivals.h"
#include "sentences.h"
#include "weigh_experiments.h"

namespace softarm::diagnose {
namespace {

using Eigen::MatrixXd;
using model::Effect;
using model::Present;

constexpr int kSteps = 2;                 // that bring a rival to the shapes of the other
constexpr std::size_t kWeighedWhole = 3;  // experiments that are weighed without approximation, at once

// --- What is to be separated ------------------------------------------------------------------------------

/// The named effect with the most doubt about it, and its rivals in its place.
std::vector<Explanation> rivals_of(JointModel& model, const Selection& selection) {
  const Linearised& extended = selection.extended;
  for (std::size_t e = 0; e < extended.at.effects.size(); ++e) {
    const Round& round = selection.rounds[selection.round_of[e]];
    if (round.rivals.empty()) continue;
    std::vector<Explanation> list{{extended.at.effects[e].effect->info().id, extended}};
    for (const Effect* rival : round.rivals) {
      if (list.size() == kPolicy.experiment.most_rivals) break;
      if (std::any_of(extended.at.effects.begin(), extended.at.effects.end(),
                      [&](const Present& present) { return present.effect == rival; }))
        continue;
      JointParameters start = extended.at;
      const Round& with = round_with_rival(selection, selection.round_of[e], rival);
      const auto refitted = std::find_if(with.refitted.begin(), with.refitted.end(),
                                         [&](const Refitted& r) { return r.effect == rival; });
      const auto screened = std::find_if(with.screened.begin(), with.screened.end(),
                                         [&](const Screened& s) { return s.effect == rival; });
      if (refitted != with.refitted.end()) {
        const std::vector<Present> others(extended.at.effects.begin(), extended.at.effects.end() - 1);
        if (e == others.size() && is_upon(*refitted, others)) {
          // Only where it is was kept of a refit.
          list.push_back({rival->info().id, fitted_to(model, extended, refitted->fit.at, 0)});
          continue;
        }
        start.effects[e] = refitted->fit.at.effects.back();
      } else if (screened != with.screened.end()) {
        start.effects[e] = {rival, screened->values};
      } else {
        continue;
      }
      list.push_back({rival->info().id, fitted_to(model, extended, std::move(start), kSteps)});
    }
    if (list.size() > 1) return list;
  }
  return {};
}

/// Candidates upon the model so far that explain most of what is left.
std::vector<Explanation> candidates_of(JointModel& model, const Selection& selection) {
  std::vector<Explanation> list;
  for (const Refitted& r : selection.rounds.back().refitted) {
    if (list.size() == kPolicy.experiment.most_rivals) break;
    if (r.z >= kPolicy.experiment.candidate_z && is_upon(r, selection.extended.at.effects))
      list.push_back({r.effect->info().id, fitted_to(model, selection.extended, r.fit.at, 0)});
  }
  return list;
}

/// Effects of the arm that would not be seen at their usual size.
std::vector<Present> collinear_of(const Selection& selection) {
  std::vector<Present> list;
  for (const Screened& s : selection.rounds.back().screened) {
    if (s.usual_z >= kPolicy.experiment.seen_z || list.size() == kPolicy.experiment.most_collinear) continue;
    const model::Info& info = s.effect->info();
    Present present{s.effect, s.values};
    for (int k = 0; k < info.sizes; ++k)
      present.values[k] = info.parameters[static_cast<std::size_t>(k)].usual;
    list.push_back(std::move(present));
  }
  return list;
}

// --- Choosing --------------------------------------------------------------------------------------------

std::string sentence_of(const NextExperiment& next, bool to_light) {
  if (to_light) {
    const bool one = next.separates.size() == 1;
    return fmt::format(
        "It would show {} of usual size, which {} collinear with the arm's constants in the present trials, "
        "by {:.1f} standard deviations{}.",
        one_of(next.separates, "and"), one ? "is" : "are", next.expected_separation, one ? "" : " or more");
  }
  return fmt::format(
      "It would separate {} by {:.{}f} standard deviations; the present trials do so by {:.1f}.",
      [&] {
        if (next.separates.size() == 2) return next.separates[0] + " from " + next.separates[1];
        return one_of(next.separates, "and") + " from one another";
      }(),
      next.expected_separation, next.expected_separation < 10.0 ? 1 : 0, next.today);
}

/// The least separation of any two.
double least(MatrixXd separations, Eigen::Index& truth, Eigen::Index& fitted) {
  separations.diagonal().setConstant(1e300);
  return separations.minCoeff(&truth, &fitted);
}

/// Of all experiments; where derivatives have to be whole ones, those of the best of them, until the first
/// has them.
Separations separations_of(const JointModel& model, const JointParameters& baseline,
                           const std::vector<Explanation>& list, const std::vector<Experiment>& menu,
                           double inflation, const Options& options) {
  Separations all = weigh_apart(model, baseline, list, menu, false, inflation, options);
  const bool is_whole_needed = std::any_of(list.begin(), list.end(), [&](const Explanation& one) {
    return model.needs_whole_derivatives(one.fit.at);
  });
  if (!is_whole_needed) return all;
  std::vector<bool> is_whole(menu.size(), false);
  for (;;) {
    std::vector<std::pair<double, std::size_t>> order;
    Eigen::Index truth = 0, fitted = 0;
    for (std::size_t i = 0; i < menu.size(); ++i)
      if (all.with[i]) order.emplace_back(-least(*all.with[i], truth, fitted), i);
    std::sort(order.begin(), order.end());
    if (order.empty() || is_whole[order.front().second]) break;
    std::vector<Experiment> best;
    std::vector<std::size_t> number;
    for (std::size_t o = 0; o < std::min(order.size(), kWeighedWhole); ++o) {
      if (is_whole[order[o].second]) continue;
      number.push_back(order[o].second);
      best.push_back(menu[number.back()]);
    }
    const Separations whole = weigh_apart(model, baseline, list, best, true, inflation, options);
    for (std::size_t b = 0; b < best.size(); ++b) {
      all.with[number[b]] = whole.with[b];
      is_whole[number[b]] = true;
    }
  }
  return all;
}

std::optional<NextExperiment> tell_apart(const JointModel& model, const JointParameters& baseline,
                                         const std::vector<Explanation>& list,
                                         const std::vector<Experiment>& menu, double inflation,
                                         const Options& options) {
  const Separations all = separations_of(model, baseline, list, menu, inflation, options);
  NextExperiment next;
  Eigen::Index truth = 0, fitted = 0;
  next.today = least(all.today, truth, fitted);
  for (std::size_t i = 0; i < menu.size(); ++i) {
    if (!all.with[i]) continue;
    const double separation = least(*all.with[i], truth, fitted);
    next.menu.push_back(
        {menu[i].action,
         separation,
         {list[static_cast<std::size_t>(truth)].id, list[static_cast<std::size_t>(fitted)].id},
         {}});
  }
  std::stable_sort(
      next.menu.begin(), next.menu.end(),
      [](const WeighedExperiment& a, const WeighedExperiment& b) { return a.separation > b.separation; });
  if (next.menu.empty()) return std::nullopt;
  const double best = next.menu.front().separation;
  if (best < kPolicy.experiment.useful_z || best < kPolicy.experiment.better * next.today)
    return std::nullopt;
  next.action = next.menu.front().action;
  next.expected_separation = best;
  for (const Explanation& one : list) next.separates.push_back(one.id);
  next.sentence = sentence_of(next, false);
  return next;
}

std::optional<NextExperiment> bring_to_light(JointModel& model, Linearised& at,
                                             const std::vector<Present>& hidden,
                                             const std::vector<Experiment>& menu, double inflation,
                                             const Options& options) {
  const Visibility all = weigh_collinear(model, at, hidden, menu, inflation, options);
  NextExperiment next;
  double most = 0.0;
  for (std::size_t i = 0; i < menu.size(); ++i) {
    if (!all.with[i]) continue;
    const std::vector<double>& z = *all.with[i];
    WeighedExperiment weighed;
    weighed.action = menu[i].action;
    double least = 1e300, sum = 0.0, today = 1e300;
    for (std::size_t h = 0; h < hidden.size(); ++h) {
      sum += std::min(1.0, z[h] / kPolicy.experiment.seen_z);
      // What is seen already but for correlated residuals is no news.
      if (z[h] < kPolicy.experiment.seen_z ||
          all.today[h] >= kPolicy.experiment.seen_z / kPolicy.experiment.better)
        continue;
      weighed.shows.push_back(hidden[h].effect->info().id);
      least = std::min(least, z[h]);
      today = std::min(today, all.today[h]);
    }
    weighed.separation = weighed.shows.empty() ? 0.0 : least;
    // First how many, then how far the others come.
    const double worth =
        static_cast<double>(weighed.shows.size()) + sum / (1.0 + static_cast<double>(hidden.size()));
    if (!weighed.shows.empty() && worth > most) {
      most = worth;
      next.action = weighed.action;
      next.separates = weighed.shows;
      next.expected_separation = least;
      next.today = today;
    }
    next.menu.push_back(std::move(weighed));
  }
  if (next.separates.empty()) return std::nullopt;
  std::stable_sort(next.menu.begin(), next.menu.end(),
                   [&](const WeighedExperiment& a, const WeighedExperiment& b) {
                     if ((a.action == next.action) != (b.action == next.action))
                       return a.action == next.action;
                     return a.shows.size() > b.shows.size();
                   });
  next.sentence = sentence_of(next, true);
  return next;
}

}  // namespace

std::optional<NextExperiment> next_experiment(JointModel& model, Selection& selection, Verdict verdict,
                                              const Options& options) {
  if (selection.rounds.empty()) return std::nullopt;
  std::vector<Explanation> list = rivals_of(model, selection);
  const bool open = verdict != Verdict::kExplained && verdict != Verdict::kConsistent;
  if (list.empty() && open) list = candidates_of(model, selection);
  const auto menu = [&] {
    return experiment_menu(model.arm(), model.trials(),
                           std::max(options.block_s, kPolicy.experiment.block_s));
  };
  if (list.size() > 1)
    return tell_apart(model, selection.baseline.at, list, menu(), selection.inflation, options);
  if (verdict != Verdict::kConsistent && verdict != Verdict::kCannotTell) return std::nullopt;
  const std::vector<Present> hidden = collinear_of(selection);
  if (hidden.empty()) return std::nullopt;
  return bring_to_light(model, selection.extended, hidden, menu(), selection.inflation, options);
}

}  // namespace softarm::diagnose
