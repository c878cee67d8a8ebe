#include "pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "arm/input_kind.h"
#include "contribution.h"
#include "policy.h"
#include "sentences.h"

namespace softarm::diagnose {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr std::size_t kInstants = 300;  // of a trial's curves
constexpr std::size_t kFilm = 48;       // and of its film
constexpr std::size_t kTypical = 2;     // pictures beside that of the largest error

/// Index of a block's first row in a trial's vectors.
std::vector<Eigen::Index> first_rows_of(const model::TrialData& trial) {
  std::vector<Eigen::Index> rows;
  Eigen::Index row = 0;
  for (const model::Block& block : trial.blocks) {
    rows.push_back(row);
    row += 3 * static_cast<Eigen::Index>(block.bodies.size());
  }
  return rows;
}

std::vector<Vector3d> backbone(const model::Predicted& predicted) {
  std::vector<Vector3d> points{Vector3d::Zero()};
  for (const rod::RodState& state : predicted.shape.stations) points.push_back(state.p);
  return points;
}

Snapshot snapshot_of(const JointModel& model, const Selection& selection, std::size_t trial,
                     std::size_t block) {
  const model::Predicted& before = selection.baseline.predicted[trial][block];
  const model::Predicted& after = selection.extended.predicted[trial][block];
  Snapshot snapshot;
  snapshot.t_s = before.instant.t_s;
  snapshot.backbone_before = backbone(before);
  snapshot.backbone_after = backbone(after);
  const std::vector<model::Seen>& bodies = model.trials()[trial].blocks[block].bodies;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    snapshot.measured.push_back(bodies[i].p_base);
    snapshot.bodies_before.push_back(before.p.col(static_cast<Eigen::Index>(i)));
    snapshot.bodies_after.push_back(after.p.col(static_cast<Eigen::Index>(i)));
  }
  return snapshot;
}

bool both_solved(const Selection& selection, std::size_t trial, std::size_t block) {
  return selection.baseline.predicted[trial][block].solved &&
         selection.extended.predicted[trial][block].solved;
}

std::vector<Snapshot> film_of(const JointModel& model, const Selection& selection, std::size_t trial) {
  std::vector<Snapshot> film;
  const std::size_t blocks = model.trials()[trial].blocks.size();
  const std::size_t step = std::max<std::size_t>(1, (blocks + kFilm - 1) / kFilm);
  for (std::size_t k = 0; k < blocks; k += step)
    if (both_solved(selection, trial, k) && !model.trials()[trial].blocks[k].bodies.empty())
      film.push_back(snapshot_of(model, selection, trial, k));
  return film;
}

std::size_t tip_of(const arm::Arm& arm) {
  std::size_t tip = 0;
  for (std::size_t b = 1; b < arm.bodies.size(); ++b)
    if (arm.bodies[b].arclength_m > arm.bodies[tip].arclength_m) tip = b;
  return tip;
}

void add_curves(const JointModel& model, const Selection& selection, Diagnosis& d) {
  const std::size_t tip = tip_of(model.arm());
  const Unseen &before = selection.baseline_unseen, &after = selection.extended_unseen;
  for (const arm::ScalarInput& input : model.arm().inputs.scalars)
    d.input_units[input.name] = arm::unit_of(input.kind);
  d.input_units["payload"] = "kg";
  for (std::size_t t = 0; t < model.trials().size(); ++t) {
    const model::TrialData& trial = model.trials()[t];
    const std::vector<Eigen::Index> rows = first_rows_of(trial);
    TrialCurves curves;
    curves.name = trial.name;
    curves.rms_before_m = before.rms_m[t];
    curves.rms_after_m = after.rms_m[t];
    curves.mean_before_m = before.mean_of_m[t];
    curves.mean_after_m = after.mean_of_m[t];
    curves.max_before_m = before.max_of_m[t];
    curves.max_after_m = after.max_of_m[t];
    for (const arm::MeasuredBody& body : model.arm().bodies) {
      curves.before_m[body.name];
      curves.after_m[body.name];
    }
    const std::size_t step = std::max<std::size_t>(1, trial.blocks.size() / kInstants);
    for (std::size_t k = 0; k < trial.blocks.size(); ++k) {
      const model::Block& block = trial.blocks[k];
      if (model.uses(t, k)) curves.frames += block.last - block.first;
      if (k % step != 0) continue;
      const model::Instant& now = selection.baseline.predicted[t][k].instant;
      curves.t_s.push_back(now.t_s);
      for (std::size_t c = 0; c < model.arm().inputs.scalars.size(); ++c)
        curves.inputs[model.arm().inputs.scalars[c].name].push_back(now.inputs[static_cast<Eigen::Index>(c)]);
      curves.inputs["payload"].push_back(now.payload_kg);
      std::vector<std::optional<double>> b(model.arm().bodies.size()), a(model.arm().bodies.size());
      curves.tip_measured_m.emplace_back();
      curves.tip_before_m.emplace_back();
      curves.tip_after_m.emplace_back();
      for (std::size_t i = 0; i < block.bodies.size(); ++i) {
        const Eigen::Index row = rows[k] + 3 * static_cast<Eigen::Index>(i);
        const auto body = static_cast<std::size_t>(block.bodies[i].body);
        if (selection.baseline.root_weight[t][row] > 0.0) b[body] = before.residual[t].segment<3>(row).norm();
        if (selection.extended.root_weight[t][row] > 0.0) a[body] = after.residual[t].segment<3>(row).norm();
        if (body != tip) continue;
        const Vector3d& measured = block.bodies[i].p_base;
        curves.tip_measured_m.back() = measured;
        if (b[body]) curves.tip_before_m.back() = measured - before.residual[t].segment<3>(row);
        if (a[body]) curves.tip_after_m.back() = measured - after.residual[t].segment<3>(row);
      }
      for (std::size_t body = 0; body < b.size(); ++body) {
        curves.before_m[model.arm().bodies[body].name].push_back(b[body]);
        curves.after_m[model.arm().bodies[body].name].push_back(a[body]);
      }
    }
    curves.film = film_of(model, selection, t);
    d.trials.push_back(std::move(curves));
  }
}

void add_along(const JointModel& model, const Selection& selection, Diagnosis& d) {
  const std::size_t bodies = model.arm().bodies.size();
  for (const arm::MeasuredBody& body : model.arm().bodies) {
    d.along.bodies.push_back(body.name);
    d.along.s_m.push_back(body.arclength_m);
  }
  const auto sums = [&](const Linearised& at, const Unseen& unseen, std::vector<Vector3d>& rms,
                        std::vector<Vector3d>& mean) {
    rms.assign(bodies, Vector3d::Zero());
    mean.assign(bodies, Vector3d::Zero());
    std::vector<double> count(bodies, 0.0);
    for (std::size_t t = 0; t < model.trials().size(); ++t) {
      Eigen::Index row = 0;
      for (std::size_t k = 0; k < model.trials()[t].blocks.size(); ++k) {
        for (const model::Seen& seen : model.trials()[t].blocks[k].bodies) {
          const auto b = static_cast<std::size_t>(seen.body);
          if (at.root_weight[t][row] > 0.0) {
            const Vector3d v = in_section(at.predicted[t][k], model.arm().bodies[b].arclength_m,
                                          unseen.residual[t].segment<3>(row));
            rms[b] += v.cwiseAbs2();
            mean[b] += v;
            count[b] += 1.0;
          }
          row += 3;
        }
      }
    }
    for (std::size_t b = 0; b < bodies; ++b) {
      rms[b] = (rms[b] / std::max(1.0, count[b])).cwiseSqrt();
      mean[b] /= std::max(1.0, count[b]);
    }
  };
  sums(selection.baseline, selection.baseline_unseen, d.along.before_m, d.along.mean_before_m);
  sums(selection.extended, selection.extended_unseen, d.along.after_m, d.along.mean_after_m);
}

void add_snapshots(const JointModel& model, const Selection& selection, Diagnosis& d) {
  struct Instant {
    std::size_t trial, block;
    double error_m;
  };
  std::vector<Instant> all;
  for (std::size_t t = 0; t < model.trials().size(); ++t) {
    const std::vector<Eigen::Index> rows = first_rows_of(model.trials()[t]);
    for (std::size_t k = 0; k < model.trials()[t].blocks.size(); ++k) {
      const auto count = static_cast<Eigen::Index>(model.trials()[t].blocks[k].bodies.size());
      if (!model.uses(t, k) || count == 0 || !both_solved(selection, t, k)) continue;
      all.push_back(
          {t, k,
           std::sqrt(selection.baseline_unseen.residual[t].segment(rows[k], 3 * count).squaredNorm() /
                     static_cast<double>(count))});
    }
  }
  if (all.empty()) return;
  std::stable_sort(all.begin(), all.end(),
                   [](const Instant& a, const Instant& b) { return a.error_m > b.error_m; });
  const auto add = [&](const Instant& instant, const std::string& words) {
    Snapshot snapshot = snapshot_of(model, selection, instant.trial, instant.block);
    snapshot.trial = model.trials()[instant.trial].name;
    snapshot.description = words;
    d.snapshots.push_back(std::move(snapshot));
  };
  add(all.front(), "largest error before");
  for (std::size_t i = 1; i <= kTypical && all.size() > 10; ++i)
    add(all[all.size() * i / (kTypical + 1)], "typical");
}

}  // namespace

void add_pictures(const JointModel& model, const Selection& selection, Diagnosis& d) {
  add_curves(model, selection, d);
  add_along(model, selection, d);
  add_snapshots(model, selection, d);
}

namespace {

/// What can be learnt of what is left.
std::string learnt_of(const Diagnosis& d) {
  if (d.discovered_law) {
    std::vector<std::string> names;
    for (const LawTerm& term : d.discovered_law->terms) names.push_back(term.goes_with);
    return fmt::format(
        " A law was learnt from it: it goes with {}, and accounts for {} of it beyond the noise.",
        one_of(names, "and"), percent(d.discovered_law->share));
  }
  if (d.ceiling_rms_m > kPolicy.words.no_better * d.extended.held_out_rms_m)
    return " A flexible model does not learn it from the other trials either: it is not the same in all of "
           "them, or there are too few.";
  return fmt::format(" A flexible model learns {} of it: it goes with inputs, payload, attitude or time.",
                     percent(1.0 - std::pow(d.ceiling_rms_m / d.extended.held_out_rms_m, 2)));
}

/// What an arm file leaves out, where that explains the trials: what is hardly there is said apart.
std::string left_out_of(const Diagnosis& d) {
  std::vector<std::string> there, hardly;
  for (const NamedEffect& effect : d.effects) {
    if (effect.probability >= kPolicy.posterior.named)
      there.push_back(effect.id);
    else
      hardly.push_back(fmt::format("{} ({})", effect.id, percent(effect.probability)));
  }
  if (there.empty()) return one_of(hardly, "and") + (hardly.size() > 1 ? ": with them" : ": with it");
  const std::string with = one_of(there, "and") + (there.size() > 1 ? ": with them" : ": with it");
  if (hardly.empty()) return with;
  return fmt::format("{}, and with {}, which may stand in for something else,", with, one_of(hardly, "and"));
}

/// @param names of what the verdict stands on, with probabilities
std::string untold_of(const Diagnosis& d, std::vector<std::string> names, const std::string& errors) {
  for (const NamedEffect& effect : d.stand_ins)
    names.push_back(fmt::format("{} ({})", effect.id, percent(effect.probability)));
  if (names.empty())
    return fmt::format(
        "These trials cannot tell ({}): most effects would be collinear with the arm's own constants.",
        errors);
  return fmt::format(
      "These trials cannot tell what is left out ({}): {} would explain it, but {} probably not there.",
      errors, one_of(names, "and"), names.size() > 1 ? "are" : "is");
}

std::string found_of(const Diagnosis& d, std::size_t trials) {
  const std::string errors =
      fmt::format("{} on average{}, noise alone {}", millimetres(d.baseline.held_out_mean_m),
                  on_unseen(trials), millimetres(mean_noise_m(d)));
  const std::string errors_change = "the mean error" + on_unseen(trials) + " " +
                                    change(d.baseline.held_out_mean_m, d.extended.held_out_mean_m);
  std::vector<std::string> names, small;
  const bool all = d.stand_ins.empty();
  double part = 0.0;  // of what could be explained, by those
  for (const NamedEffect& effect : d.effects) {
    names.push_back(fmt::format("{} ({})", effect.id, percent(effect.probability)));
    part += effect.share * d.explained_share;
  }
  for (const NamedEffect& effect : d.small_departures) {
    if (effect.probability >= kPolicy.posterior.named) small.push_back(effect.id);
  }
  const std::string list = one_of(names, "and");
  const std::string change_of_all = (all ? "" : "with all that was fitted ") + errors_change;
  const char* explain = names.size() > 1 ? "explain" : "explains";
  const std::string beside =
      small.empty() ? "" : fmt::format(" Small departures, as every arm has them: {}.", one_of(small, "and"));
  switch (d.verdict) {
    case Verdict::kConsistent:
      return fmt::format("The arm file explains the trials ({}); nothing of a size that matters is left out.",
                         errors) +
             beside;
    case Verdict::kExplained:
      return fmt::format("The arm file leaves out {} {} (noise alone {}).", left_out_of(d), errors_change,
                         millimetres(mean_noise_m(d))) +
             beside;
    case Verdict::kPartlyExplained:
      return fmt::format("{} {} {} of what could be explained: {}. Something else is left.", list, explain,
                         percent(part), change_of_all) +
             beside;
    case Verdict::kUnknown: {
      std::string text =
          fmt::format("Something is there that no effect of the catalogue explains ({}).", errors);
      if (!names.empty())
        text += fmt::format(" {} {} {} of it: {}.", list, explain, percent(part), change_of_all);
      text += beside;
      std::vector<std::string> likely;
      for (const Candidate& c : d.ranking) {
        if (c.finding != Finding::kPresent && c.finding != Finding::kRival &&
            c.probability >= kPolicy.words.likely)
          likely.push_back(fmt::format("{} ({})", c.id, percent(c.probability)));
      }
      if (!likely.empty()) text += fmt::format(" Possibly present: {}.", one_of(likely));
      text += learnt_of(d);
      return text;
    }
    case Verdict::kCannotTell:
      return untold_of(d, std::move(names), errors) + beside;
  }
  return {};
}

}  // namespace

std::string summary_of(const Diagnosis& d, std::size_t trials) {
  const std::string found = found_of(d, trials);
  if (!(d.left_out_share > kPolicy.words.left_out_share)) return found;
  return fmt::format(
      "{} This is based on {} of the recordings. The rest is left out: the arm swung, a hand was on it, or "
      "the inputs at that time are not known.",
      found, percent(1.0 - d.left_out_share));
}

}  // namespace softarm::diagnose
