#include "conclusion.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "background.h"
#include "beyond_range.h"
#include "discovered_law.h"
#include "extended_arm.h"
#include "far_from_file.h"
#include "findings.h"
#include "flexible.h"
#include "floor.h"
#include "ladder.h"
#include "leftover.h"
#include "math/linear_algebra.h"
#include "next_experiment.h"
#include "parameter_variation.h"
#include "pictures.h"
#include "policy.h"
#include "sentences.h"
#include "softarm/identify/identify.h"
#include "structure.h"
#include "unseen.h"

namespace softarm::diagnose {
namespace {

using Eigen::MatrixXd;
using model::Present;

/// Mean log density of a body's position on unseen trials, its spread as on all of them.
double log_score(const Unseen& unseen, int rows) {
  const double variance = std::max(1e-12, unseen.total_chi2 / std::max(1, rows));
  return -0.5 * 3.0 * (std::log(2.0 * M_PI * variance) + 1.0);
}

Fit fit_of(const Unseen& unseen, int rows) {
  return {unseen.fitted_rms_m,     unseen.total_rms_m,        unseen.mean_m,     unseen.max_m,
          log_score(unseen, rows), unseen.fitted_plain_rms_m, unseen.plain_rms_m};
}

MatrixXd covariance_of(const Linearised& at, double inflation) {
  return inflation * math::inverse_of_symmetric(at.information);
}

std::vector<Shift> shifts_of(const JointModel& model, const Selection& selection) {
  std::vector<Shift> list;
  const MatrixXd before = covariance_of(selection.baseline, inflation(selection.baseline));
  for (std::size_t j = 0; j < model.constants().size(); ++j) {
    const auto i = static_cast<Eigen::Index>(j);
    Shift shift;
    shift.name = identify::name_of(model.arm(), model.constants()[j]);
    shift.unit = identify::unit_of(model.constants()[j].kind);
    shift.before = selection.baseline.at.constants[i];
    shift.after = selection.extended.at.constants[i];
    shift.sd_before = std::sqrt(before(i, i)) * selection.baseline.columns[j].scale;
    shift.sd_after = std::sqrt(selection.doubt.covariance(i, i)) * selection.extended.columns[j].scale;
    list.push_back(std::move(shift));
  }
  return list;
}

std::string known_ids(const Options& options) {
  std::string ids;
  for (const Present& present : options.known) ids += (ids.empty() ? "" : ", ") + present.effect->info().id;
  return ids;
}

/// What is left to see before and after the effects.
struct Remains {
  Leftover before, after;
  bool adequate = false;          ///< nothing of a size that matters is left but small departures
  std::optional<double> small_m;  ///< what these make, where they are left
};

bool is_shared(const Leftover& left, double length_m) {
  return left.shared_z > kPolicy.verdict.shared_z && left.shared_m > kPolicy.verdict.shared * length_m;
}

/// What no effect of the model explains of unseen trials.
struct Left {
  double learnt = 0.0;  ///< by a flexible model: share of the mean square
  Leftover shared;
  bool as_noise = false;  ///< what no flexible model learns may still be more than noise: trials may be few
  bool adequate = false;  ///< nothing of a size that matters
};

/// But for what a flexible model learns.
Left without_learning(const JointModel& model, const Linearised& at, const Unseen& unseen,
                      const Floor& floor) {
  Left left;
  left.shared = leftover(model, at, unseen);
  left.as_noise = unseen.total_chi2 < kPolicy.verdict.as_noise_chi2 * std::max(1, at.rows);
  left.adequate = left.as_noise && !is_shared(left.shared, model.arm().total_length_m()) &&
                  !(left.shared.lone_z > kPolicy.verdict.shared_z &&
                    left.shared.lone_m > kPolicy.verdict.lone * std::sqrt(floor.white_m2));
  return left;
}

/// @param learnt by the flexible model
Left with_learning(Left left, double learnt, const JointModel& model, const Unseen& unseen,
                   const Floor& floor) {
  left.learnt = learnt;
  const double flexible_m =
      std::sqrt(std::max(0.0, std::pow(unseen.total_rms_m, 2) * learnt - floor.motion_m2));
  left.adequate = left.adequate && (flexible_m < kPolicy.verdict.flexible * model.arm().total_length_m() ||
                                    learnt < kPolicy.verdict.flexible_share);
  return left;
}

/// What is left before and after the effects, and with small departures beside them.
struct LeftBy {
  Left before, after;
  std::optional<Left> with;  ///< where `after` is not adequate
};

LeftBy left_by(const JointModel& model, const Selection& selection, const Floor& floor, unsigned jobs) {
  const Unseen &before = selection.baseline_unseen, &after = selection.extended_unseen,
               &with = selection.with_background;
  const bool extended = !selection.extended.at.effects.empty();
  LeftBy left;
  left.before = without_learning(model, selection.baseline, before, floor);
  left.after = extended ? without_learning(model, selection.extended, after, floor) : left.before;
  // The flexible model learns from all at once that are wanted for sure: each costs less so.
  const bool with_is_wanted = !left.after.adequate;
  std::vector<Unexplained> wanted{{selection.baseline, before.residual}};
  if (extended) wanted.push_back({selection.extended, after.residual});
  if (with_is_wanted) wanted.push_back({selection.extended, with.residual});
  const std::vector<double> learnt = ceilings(model, wanted, jobs);
  left.before = with_learning(left.before, learnt.front(), model, before, floor);
  left.after = extended ? with_learning(left.after, learnt[1], model, after, floor) : left.before;
  if (left.after.adequate) return left;
  const double learnt_with =
      with_is_wanted ? learnt.back() : ceiling(model, selection.extended, with.residual, jobs);
  left.with = with_learning(without_learning(model, selection.extended, with, floor), learnt_with, model,
                            with, floor);
  return left;
}

/// Errors, the share of what could be explained, and what is left.
Remains compare(const JointModel& model, const Selection& selection, unsigned jobs, Diagnosis& d) {
  const Unseen &before = selection.baseline_unseen, &after = selection.extended_unseen;
  const bool extended = !selection.extended.at.effects.empty();
  const Floor floor = floor_of(model);
  const LeftBy left_by_all = left_by(model, selection, floor, jobs);
  const Left &in_before = left_by_all.before, &in_after = left_by_all.after;
  d.noise_floor_m = std::sqrt(floor.white_m2);
  d.baseline = fit_of(before, selection.baseline.rows);
  d.extended = fit_of(after, selection.extended.rows);
  d.discrepancy_share = in_after.learnt;

  Remains left{in_before.shared, in_after.shared, in_after.adequate, {}};
  const double length_m = model.arm().total_length_m();
  if (left_by_all.with) {
    left.small_m = small_departures_m(after, selection.with_background, left_by_all.with->adequate, length_m);
    left.adequate = left.small_m.has_value();
  }
  const double small2 = std::pow(left.small_m.value_or(0.0), 2);
  const double base2 = std::pow(before.total_rms_m, 2), ext2 = std::pow(after.total_rms_m, 2);
  const double floor2 = floor.white_m2;
  const double learnt2 = std::min({base2 * (1.0 - in_before.learnt), ext2 * (1.0 - in_after.learnt), ext2});
  d.ceiling_rms_m = std::sqrt(std::max(std::min(base2, floor2), learnt2));
  const double reach2 =
      std::min(ext2, small2 + (in_after.as_noise ? std::pow(d.ceiling_rms_m, 2) : std::min(base2, floor2)));
  d.explained_share = base2 > reach2 ? std::clamp((base2 - ext2) / (base2 - reach2), 0.0, 1.0) : 0.0;
  // With the arm calm nothing but the arm's shape is in the way.
  if (extended && !left.adequate && is_shared(left.before, length_m) &&
      left.before.shared_m > left.after.shared_m)
    d.explained_share = 1.0 - std::pow(left.after.shared_m / left.before.shared_m, 2);
  return left;
}

/// Which fits did not come to an end; empty: all did.
std::string unconverged(const Selection& selection) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& what) {
    if (std::find(names.begin(), names.end(), what) == names.end()) names.push_back(what);
  };
  if (!selection.baseline.converged) add("the arm's constants alone");
  if (!selection.extended.at.effects.empty() && !selection.extended.converged)
    add("the effects that are named");
  for (const Round& round : selection.rounds)
    for (const Refitted& r : round.refitted)
      if (!r.converged && !r.fit.given_up) add(r.effect->info().id);
  return fmt::format("{}", fmt::join(names, ", "));
}

/// How much of the recordings is compared with models.
struct Compared {
  std::size_t frames = 0, blocks = 0, used = 0;
  std::size_t block_frames = 0, used_frames = 0;
};

Compared compared(const JointModel& model) {
  Compared count;
  for (std::size_t t = 0; t < model.trials().size(); ++t) {
    const model::TrialData& trial = model.trials()[t];
    count.frames += trial.frames;
    for (std::size_t k = 0; k < trial.blocks.size(); ++k) {
      if (trial.blocks[k].bodies.empty()) continue;
      ++count.blocks;
      const std::size_t frames = trial.blocks[k].last - trial.blocks[k].first;
      count.block_frames += frames;
      if (!model.uses(t, k)) continue;
      ++count.used;
      count.used_frames += frames;
    }
  }
  return count;
}

/// How the arm moves in the models.
std::string motion_of(const JointModel& model, double lag_s) {
  if (model.quasi_static())
    return fmt::format(
        "The trials show no inertia, as if they came from a computation: both models are without inertia, "
        "and have a viscoelastic lag of {:.0f} ms.",
        1e3 * lag_s);
  return fmt::format(
      "Inertia of the arm's known masses{} and a viscoelastic lag ({:.0f} ms) are in both models; {:.0f} % "
      "of their effect counts as noise.",
      model.swings() ? ", in its modes of vibration," : ", to first order,", 1e3 * lag_s,
      1e2 * model.unknown().inertia);
}

std::vector<std::string> notes_of(const Compared& all, const model::Prepared& prepared,
                                  const Selection& selection, const Options& options, const FirstFits& first,
                                  const JointModel& model, const Remains& left) {
  std::vector<std::string> notes;
  notes.push_back(
      fmt::format("{} frames of {} trials, compared as {} means over {:.2g} s, longer where the arm rests; "
                  "{} are left out because a hand had been on the payload, {} because the arm swung. Errors "
                  "and the noise floor are those of the means.",
                  all.frames, prepared.trials.size(), all.blocks, options.block_s,
                  all.blocks - all.used - first.swinging - first.ends, first.swinging));
  if (first.ends > 0)
    notes.push_back(
        fmt::format("{} means at the ends of the trials are left out: with clocks this far apart, the inputs "
                    "for them were not recorded.",
                    first.ends));
  notes.push_back(motion_of(model, selection.extended.at.viscoelastic_lag_s));
  if (!options.known.empty())
    notes.push_back(fmt::format("{} of the arm file {} in all models, at the file's values.",
                                known_ids(options), options.known.size() == 1 ? "is" : "are"));
  for (const auto& [reason, count] : prepared.left_out)
    if (count > 0) notes.push_back(fmt::format("{} frames left out: {}", count, reason));
  if (prepared.trials.size() < 3)
    notes.push_back(
        "Fewer than three trials: they hardly show what improves predictions of unseen ones. Record more.");
  if (left.small_m)
    notes.push_back(
        fmt::format("The remaining {:.2f} mm rms are small departures of many effects, as every arm has "
                    "them, which these trials cannot tell apart.",
                    1e3 * *left.small_m));
  const std::string unseen = predicted_from(model.sequences(), model.predicted_without());
  if (!unseen.empty()) notes.push_back(unseen);
  const std::string open = unconverged(selection);
  if (!open.empty())
    notes.push_back(fmt::format("Fits that did not converge, and count for less: {}.", open));
  return notes;
}

/// Looks beyond ranges in which constants rest at an end: effects are no surer than they are there.
BeyondRange look_beyond(const JointModel& model, const Options& options, Selection& selection) {
  BeyondRange beyond = beyond_range(model, selection, options);
  for (std::size_t e = 0; e < beyond.still_there.size(); ++e) {
    double& there = selection.doubt.still_there[e];
    there = std::min(there, beyond.still_there[e]);
  }
  return beyond;
}

/// What of the trials is known by now in a few sentences: what is to be seen to first stands first.
void add_summary(const JointModel& model, const BeyondRange& beyond, Diagnosis& d) {
  if (d.exchanged_names) {
    d.summary = sentence_of(*d.exchanged_names, model.trials().size()) + " No effects were looked for.";
    return;
  }
  d.narrow_range = beyond.helps;
  d.summary = summary_of(d, model.trials().size());
  if (beyond.helps && d.effects.empty())
    d.summary = beyond.text + " Within that range, no effect of the catalogue is certain.";
  else if (!beyond.text.empty())
    d.summary = beyond.helps ? beyond.text + " " + d.summary : d.summary + " " + beyond.text;
  const std::string far = far_from_file(model, d.shifts);
  if (!far.empty()) d.summary = far + " " + d.summary;
}

// What is left, as multiples of the time of the constants' fits: as of untidy cases with nine trials.
constexpr double kCeiling = 0.65, kExperiments = 0.75, kPictures = 0.02, kAnswers = kExperiments + 0.15;

}  // namespace

Conclusion concluded(const model::Prepared& prepared, Begun& begun,
                     const std::optional<ExchangedNames>& names, const Options& options, Schedule& schedule) {
  JointModel& model = begun.model;
  Options looked_for = options;
  if (names) looked_for.most_effects = 0;  // what they would explain is not the arm's
  Selection selection =
      select(model, std::move(begun.first.baseline), begun.first.delayed, looked_for,
             [&](double left, const std::string& what) { schedule.left(left + kCeiling + kAnswers, what); });

  schedule.left(kCeiling + kAnswers, "what could be explained at most");
  Diagnosis d;
  d.arm = model.arm().name;
  const Remains left = compare(model, selection, options.jobs, d);
  const bool extended = !selection.extended.at.effects.empty();
  const BeyondRange beyond = names ? BeyondRange{} : look_beyond(model, options, selection);
  schedule.left(kAnswers, "where");
  add_findings(model, selection, left.adequate && !beyond.helps, d);
  d.before = structure_of(model, selection.baseline, selection.baseline_unseen);
  d.after = extended ? structure_of(model, selection.extended, selection.extended_unseen) : d.before;
  d.before.shared_m = left.before.shared_m;
  d.before.shared_z = left.before.shared_z;
  d.after.shared_m = left.after.shared_m;
  d.after.shared_z = left.after.shared_z;
  d.shifts = shifts_of(model, selection);
  std::optional<Law> law;
  if (!left.adequate) {
    schedule.left(kAnswers, "learning a law from what is left");
    law = discover_law(model, selection, d.discrepancy_share, d.noise_floor_m, options.jobs);
  }
  if (law) d.discovered_law = law->said;
  d.extended_arm = extended_arm(model, law ? law->fit : selection.extended,
                                law ? law->covariance : selection.doubt.covariance);
  const Compared count = compared(model);
  d.left_out_share = 1.0 - static_cast<double>(count.used_frames) / static_cast<double>(count.block_frames);
  d.exchanged_names = names;
  add_summary(model, beyond, d);
  d.notes = notes_of(count, prepared, selection, options, begun.first, model, left);
  return {std::move(d), std::move(selection)};
}

void complete(Begun& begun, Conclusion& conclusion, const Options& options, Schedule& schedule) {
  JointModel& model = begun.model;
  Selection& selection = conclusion.selection;
  Diagnosis& d = conclusion.diagnosis;
  schedule.left(kExperiments + kPictures, "fitting single instants");
  const std::vector<InstantFit> instants = fit_instants(model, selection.baseline, options.jobs);
  d.ladder = pooling_ladder(model, selection.baseline, instants);
  d.parameter_variation = parameter_variation_of(model, selection.baseline, instants);
  d.ladder_sentence = where_it_hides(d.ladder, d.noise_floor_m, d.parameter_variation);
  schedule.left(kExperiments, "what to measure next");
  d.next_experiment = next_experiment(model, selection, d.verdict, options);
  schedule.left(kPictures, "pictures");
  add_pictures(model, selection, d);
}

}  // namespace softarm::diagnose
