#include "softarm/diagnose/diagnose.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "contribution.h"
#include "extended_arm.h"
#include "flexible.h"
#include "ladder.h"
#include "leftover.h"
#include "next_experiment.h"
#include "pictures.h"
#include "selection.h"
#include "structure.h"
#include "wander.h"
#include "words.h"

namespace softarm::diagnose {
namespace {

using effects::Effect;
using effects::Present;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Of what could be explained. Where something is left to see, one of 41 effects that fits best explains up to
// three quarters of nearly anything: less than kPartly names nothing.
constexpr double kExplained = 0.9, kPartly = 0.8;
constexpr double kPoorFit = 10.0;     // chi^2 per degree of freedom: the first fit may have run away
constexpr double kRefused = 0.5;      // most for what is not named: its size is not told
constexpr double kShared_m = 7.5e-5;  // what the arm's motion and what is too small to matter leave of it
constexpr double kLeftoverZ = 2.33;
constexpr double kInterval = 1.6449;  // of 90 %
constexpr double kDetectableZ = 5.0;
constexpr double kLeftover_m = 1e-4;    // what a flexible model finds beyond this is something
constexpr double kLeftoverShare = 0.1;  // ... if it is that share of what is left, or more
// chi^2 per degree of freedom on unseen trials, up to which residuals are taken for noise.
constexpr double kAsNoise = 2.0;
constexpr double kLone = 0.5;           // of the noise: what one body alone may show beyond the others
constexpr double kFewDetectable = 0.5;  // share of the catalogue below which "consistent" says too much

/// Rms distance that white noise alone gives, weighted as the errors are.
double noise_floor(const JointModel& model) {
  double sum = 0.0, weight = 0.0;
  for (std::size_t t = 0; t < model.trials().size(); ++t) {
    for (std::size_t k = 0; k < model.trials()[t].blocks.size(); ++k) {
      if (!model.uses(t, k)) continue;
      for (const effects::Seen& seen : model.trials()[t].blocks[k].bodies) {
        const double w = 1.0 / std::pow(model.sd_m(t, k, seen), 2);
        sum += 3.0 * w * seen.white_sd_m * seen.white_sd_m;
        weight += w;
      }
    }
  }
  return weight > 0.0 ? std::sqrt(sum / weight) : 0.0;
}

/// Mean log density of a body's position on unseen trials, its spread as on all of them.
double log_score(const Unseen& unseen, int rows) {
  const double variance = std::max(1e-12, unseen.total_chi2 / std::max(1, rows));
  return -0.5 * 3.0 * (std::log(2.0 * M_PI * variance) + 1.0);
}

MatrixXd covariance_of(const Linearised& at, double inflation) {
  const Eigen::Index n = at.information.rows();
  return inflation * at.information.ldlt().solve(MatrixXd::Identity(n, n));
}

std::vector<Shift> shifts_of(const JointModel& model, const Selection& selection) {
  std::vector<Shift> list;
  const MatrixXd before = covariance_of(selection.baseline, inflation(selection.baseline));
  const MatrixXd after = covariance_of(selection.extended, selection.inflation);
  for (std::size_t j = 0; j < model.constants().size(); ++j) {
    const auto i = static_cast<Eigen::Index>(j);
    Shift shift;
    shift.name = identify::name_of(model.arm(), model.constants()[j]);
    shift.unit = identify::unit_of(model.constants()[j].kind);
    shift.before = selection.baseline.at.constants[i];
    shift.after = selection.extended.at.constants[i];
    shift.sd_before = std::sqrt(before(i, i)) * selection.baseline.columns[j].scale;
    shift.sd_after = std::sqrt(after(i, i)) * selection.extended.columns[j].scale;
    list.push_back(std::move(shift));
  }
  return list;
}

std::vector<EffectValue> values_of(const Linearised& at, std::size_t effect, const MatrixXd& covariance) {
  std::vector<EffectValue> list;
  const Present& present = at.at.effects[effect];
  const effects::Info& info = present.effect->info();
  for (std::size_t k = 0; k < info.parameters.size(); ++k) {
    const effects::Parameter& parameter = info.parameters[k];
    EffectValue value;
    value.symbol = parameter.symbol;
    value.unit = parameter.unit;
    value.words = parameter.words;
    value.value = value.low = value.high = present.values[static_cast<Eigen::Index>(k)];
    bool of_this_arm = true;
    for (std::size_t j = 0; j < at.columns.size(); ++j) {
      const Column& c = at.columns[j];
      if (c.kind != Column::Kind::kEffect || c.index != static_cast<int>(effect) ||
          c.parameter != static_cast<int>(k))
        continue;
      // An input that the arm does not have.
      of_this_arm = std::any_of(at.derivative.begin(), at.derivative.end(), [&](const MatrixXd& d) {
        return d.col(static_cast<Eigen::Index>(j)).cwiseAbs().maxCoeff() > 0.0;
      });
      const double sd =
          c.scale * std::sqrt(covariance(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(j)));
      value.low = std::max(c.low, value.value - kInterval * sd);
      value.high = std::min(c.high, value.value + kInterval * sd);
    }
    if (of_this_arm) list.push_back(std::move(value));
  }
  return list;
}

std::string known_ids(const Options& options) {
  std::string ids;
  for (const Present& present : options.known) ids += (ids.empty() ? "" : ", ") + present.effect->info().id;
  return ids;
}

/// The whole catalogue, best first: those taken, their rivals, the others of the last screen.
std::vector<Candidate> ranking_of(const Selection& selection, double doubt, const Options& options) {
  std::vector<Candidate> list;
  const auto known = [&](const Effect* effect) {
    return std::any_of(list.begin(), list.end(),
                       [&](const Candidate& c) { return c.id == effect->info().id; });
  };
  const auto fill = [&](const Screened& s, Candidate& c) {
    const effects::Info& info = s.effect->info();
    c.id = info.id;
    c.words = info.words;
    c.concealment = s.concealment;
    c.z = s.z;
    c.size_m = s.size_m;
    c.symbol = info.parameters.front().symbol;
    c.unit = info.parameters.front().unit;
    c.estimate = s.values[0];
    c.smallest_detectable = kDetectableZ * s.sd[0];
    c.detectable = s.usual_z >= kDetectableZ;
  };
  const auto screened = [](const Round& round, const Effect* effect) {
    return std::find_if(round.screened.begin(), round.screened.end(),
                        [&](const Screened& s) { return s.effect == effect; });
  };
  const Linearised& extended = selection.extended;
  for (std::size_t e = 0; e < extended.at.effects.size(); ++e) {
    const Round& round = selection.rounds[selection.round_of[e]];
    const Refitted& r = round.refitted[static_cast<std::size_t>(round.taken)];
    Candidate c;
    if (const auto s = screened(round, r.effect); s != round.screened.end()) fill(*s, c);
    c.finding = Finding::kPresent;
    c.probability = doubt * r.probability;
    c.z = r.z;
    c.estimate = extended.at.effects[e].values[0];
    c.log_score = r.gain / std::max(1, extended.rows / 3);
    list.push_back(std::move(c));
  }
  for (std::size_t e = 0; e < extended.at.effects.size(); ++e) {
    const Round& round = selection.rounds[selection.round_of[e]];
    for (const Effect* rival : round.rivals) {
      if (known(rival)) continue;
      Candidate c;
      if (const auto s = screened(round, rival); s != round.screened.end()) fill(*s, c);
      c.finding = Finding::kRival;
      for (const Refitted& r : round.refitted) {
        if (r.effect != rival) continue;
        c.probability = r.probability;
        c.z = r.z;
        c.log_score = r.gain / std::max(1, extended.rows / 3);
      }
      list.push_back(std::move(c));
    }
  }
  const Round& last = selection.rounds.back();
  std::vector<Candidate> others;
  for (const Screened& s : last.screened) {
    if (known(s.effect)) continue;
    Candidate c;
    fill(s, c);
    bool trivial = s.z >= options.least_z && s.leftover_m < options.trivial_m;
    for (const Refitted& r : last.refitted) {
      if (r.effect != s.effect) continue;
      // Of being there at a size that matters.
      trivial = r.z >= options.least_z && r.moved_m < options.trivial_m;
      c.probability = r.moved_m < options.trivial_m || !r.physical ? 0.0 : std::min(r.probability, kRefused);
      c.possible = r.physical;
      c.log_score = r.gain / std::max(1, extended.rows / 3);
    }
    if (!c.detectable) {
      c.finding = Finding::kCannotTell;
    } else if (trivial) {
      c.finding = Finding::kTrivial;
    } else {
      c.finding = Finding::kAbsent;
    }
    others.push_back(std::move(c));
  }
  std::stable_sort(others.begin(), others.end(), [](const Candidate& a, const Candidate& b) {
    return a.probability != b.probability ? a.probability > b.probability : a.z > b.z;
  });
  list.insert(list.end(), others.begin(), others.end());
  return list;
}

}  // namespace

Diagnosis diagnose(const Arm& arm, const std::vector<identify::Trial>& trials, const Options& options,
                   const Progress& progress) {
  const auto report = [&](double share, const std::string& what) {
    if (progress) progress(share, what);
  };
  report(0.0, "averaging frames");
  effects::Preparation how;
  how.block_s = options.block_s;
  const effects::Prepared prepared = effects::prepare(arm, trials, how);
  JointModel model(arm, prepared.trials, options.jobs, options.held, options.tied, options.known);
  report(0.05, "fitting the arm's constants");
  Linearised baseline = model.fit(model.start(), {});
  const std::size_t swinging = model.allow_for_motion(baseline.predicted);
  report(0.2, "fitting the arm's constants");
  // What is known beforehand counts against the misfit as it is, and that changes with what counts.
  double misfit = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double now = std::max(1.0, baseline.square / std::max(1, baseline.rows));
    if (now > 0.8 * misfit && now < 1.25 * misfit) break;
    misfit = now;
    model.set_misfit(misfit);
    baseline = model.fit(misfit > kPoorFit ? model.start() : baseline.at, {}, &baseline.predicted);
  }
  Selection selection =
      select(model, std::move(baseline), options,
             [&](double share, const std::string& what) { report(0.25 + 0.55 * share, what); });

  report(0.82, "what could be explained at all");
  Diagnosis d;
  d.arm = arm.name;
  d.noise_floor_m = noise_floor(model);
  const Unseen &before = selection.baseline_unseen, &after = selection.extended_unseen;
  const Ceiling could_before = ceiling(model, selection.baseline, before.residual);
  const bool extended = !selection.extended.at.effects.empty();
  const Ceiling could_after = extended ? ceiling(model, selection.extended, after.residual) : could_before;
  d.baseline = {before.fitted_rms_m, before.total_rms_m, log_score(before, selection.baseline.rows)};
  d.extended = {after.fitted_rms_m, after.total_rms_m, log_score(after, selection.extended.rows)};
  const double base2 = std::pow(before.total_rms_m, 2), ext2 = std::pow(after.total_rms_m, 2);
  const double floor2 = std::pow(d.noise_floor_m, 2);
  const double leftover_m = std::sqrt(ext2 * could_after.share);
  // What no flexible model learns may still be more than noise: a few trials teach it little.
  const bool as_noise = after.total_chi2 < kAsNoise * std::max(1, selection.extended.rows);
  const Leftover left_before = leftover(model, selection.baseline, before);
  const Leftover left_after = extended ? leftover(model, selection.extended, after) : left_before;
  const auto shared = [&](const Leftover& left) {
    return left.shared_z > kLeftoverZ && left.shared_m > kShared_m;
  };
  const bool adequate = as_noise && !shared(left_after) && left_after.lone_m < kLone * d.noise_floor_m &&
                        (leftover_m < kLeftover_m || could_after.share < kLeftoverShare);
  const double learnt2 =
      std::min({base2 * (1.0 - could_before.share), ext2 * (1.0 - could_after.share), ext2});
  d.ceiling_rms_m = std::sqrt(std::max(std::min(base2, floor2), learnt2));
  const double reach2 = as_noise ? std::pow(d.ceiling_rms_m, 2) : std::min(base2, floor2);
  d.explained_share = base2 > reach2 ? std::clamp((base2 - ext2) / (base2 - reach2), 0.0, 1.0) : 0.0;

  // With the arm calm nothing but the arm's shape is in the way.
  if (extended && !adequate && shared(left_before) && left_before.shared_m > left_after.shared_m)
    d.explained_share = 1.0 - std::pow(left_after.shared_m / left_before.shared_m, 2);
  // What explains a part may only be the nearest to what is there.
  const double doubt = adequate ? 1.0 : d.explained_share;
  report(0.9, "where");
  const MatrixXd covariance = covariance_of(selection.extended, selection.inflation);
  for (std::size_t e = 0; e < selection.extended.at.effects.size(); ++e) {
    const Present& present = selection.extended.at.effects[e];
    const Round& round = selection.rounds[selection.round_of[e]];
    const Refitted& r = round.refitted[static_cast<std::size_t>(round.taken)];
    NamedEffect named;
    named.id = present.effect->info().id;
    named.words = present.effect->info().words;
    named.probability = doubt * r.probability;
    named.parameters = values_of(selection.extended, e, covariance);
    named.where = where_is(model, selection.extended, present, contribution(model, selection.extended, e));
    const double without =
        e == 0 ? before.total_rms_m
               : selection.rounds[selection.round_of[e - 1]]
                     .refitted[static_cast<std::size_t>(selection.rounds[selection.round_of[e - 1]].taken)]
                     .unseen.total_rms_m;
    named.held_out_gain_m = without - r.unseen.total_rms_m;
    for (const Effect* rival : round.rivals) named.confusable_with.push_back(rival->info().id);
    d.effects.push_back(std::move(named));
  }
  d.ranking = ranking_of(selection, doubt, options);
  d.before = structure_of(model, selection.baseline, before);
  d.after = extended ? structure_of(model, selection.extended, after) : d.before;
  d.before.shared_m = left_before.shared_m;
  d.before.shared_z = left_before.shared_z;
  d.after.shared_m = left_after.shared_m;
  d.after.shared_z = left_after.shared_z;
  d.shifts = shifts_of(model, selection);
  d.extended_arm = extended_arm(model, selection.extended, covariance);

  const auto detectable =
      std::count_if(d.ranking.begin(), d.ranking.end(), [](const Candidate& c) { return c.detectable; });
  const bool powerful =
      static_cast<double>(detectable) >= kFewDetectable * static_cast<double>(d.ranking.size());
  if (extended) {
    d.verdict = d.explained_share >= kExplained && adequate ? Verdict::kExplained
                : d.explained_share >= kPartly              ? Verdict::kPartlyExplained
                                                            : Verdict::kUnknown;
  } else {
    d.verdict = !adequate ? Verdict::kUnknown : powerful ? Verdict::kConsistent : Verdict::kCannotTell;
  }
  d.summary = summary_of(d);

  std::size_t frames = 0, used = 0, blocks = 0;
  for (std::size_t t = 0; t < prepared.trials.size(); ++t) {
    frames += static_cast<std::size_t>(prepared.trials[t].series.t_s.size());
    blocks += prepared.trials[t].blocks.size();
    for (std::size_t k = 0; k < prepared.trials[t].blocks.size(); ++k) used += model.uses(t, k);
  }
  d.notes.push_back(fmt::format(
      "{} frames of {} trials, compared as {} means over {:.2g} s; {} are left out after a hand was on the "
      "payload, {} "
      "because the arm swung. Errors and the noise floor are those of such means.",
      frames, prepared.trials.size(), blocks, options.block_s, blocks - used - swinging, swinging));
  d.notes.push_back(
      fmt::format("Inertia of the arm's known masses and a delay of its wall ({:.0f} ms) are in both models.",
                  1e3 * selection.extended.at.retardation_s));
  if (!options.known.empty())
    d.notes.push_back(fmt::format("{} of the arm file {} in all models, at the file's values.",
                                  known_ids(options), options.known.size() == 1 ? "is" : "are"));
  for (const auto& [reason, count] : prepared.left_out)
    if (count > 0) d.notes.push_back(fmt::format("{} frames left out: {}", count, reason));
  if (trials.size() < 3)
    d.notes.push_back("Fewer than three trials: what helps on unseen ones cannot be told well. Record more.");
  report(0.92, "what single instants say");
  const std::vector<InstantFit> instants = fit_instants(model, selection.baseline, options.jobs);
  d.ladder = pooling_ladder(model, selection.baseline, instants);
  d.wander = wander_of(model, selection.baseline, instants);
  d.ladder_sentence = where_it_hides(d.ladder, d.noise_floor_m, d.wander);
  report(0.94, "what to measure next");
  d.next_experiment = next_experiment(model, selection, d.verdict, options);
  report(0.98, "pictures");
  add_pictures(model, selection, d);
  report(1.0, "");
  return d;
}

}  // namespace softarm::diagnose
