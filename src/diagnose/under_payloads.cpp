#include "under_payloads.h"

#include <algorithm>
#include <utility>

#include "findings.h"
#include "payload_equations.h"
#include "policy.h"
#include "told_payloads.h"
#include "unseen.h"

namespace softarm::diagnose {
namespace {

/// The fit that looks for payloads: where clocks are apart, the one that knows.
Linearised& fit_of_payloads(FirstFits& first) {
  return first.delayed ? *first.delayed : first.baseline;
}

/// The fits under the payloads that the trials say, from what was told to these one step after the other.
/// @param payloads to first order about the fit as told; become those that the last search says, nearly the
/// last fit's own
/// @param trials get them, and are kept by reference
/// @return nothing where that does not come to an end, or nothing is left of them
std::unique_ptr<Begun> begun_under(const arm::Arm& arm, const model::Prepared& prepared,
                                   OtherPayloads& payloads, std::vector<model::TrialData>& trials,
                                   const Options& options, Schedule& schedule) {
  const double usual_kg = usual_payload_kg(arm, prepared.trials);
  for (std::size_t step = 0; step < kPolicy.told.most_steps; ++step) {
    trials = under(payloads.list, prepared.trials);
    schedule.begin_first_part("with the payloads found");
    auto begun = std::make_unique<Begun>(arm, trials, options, schedule);
    const Linearised fit = off_axis_by(payloads.offset_m, begun->model, fit_of_payloads(begun->first));
    OtherPayloads next = other_payloads(begun->model, fit, payloads.list, usual_kg);
    const bool settled = is_settled(payloads.list, next.list, usual_kg);
    payloads = std::move(next);
    if (settled) return begun;
    if (payloads.list.empty()) return nullptr;
  }
  return nullptr;
}

/// Whether these errors on unseen trials are so much smaller that they are no better fit's, but the arm's.
bool is_better(double mean_m, double than_m) {
  return mean_m > 0.0 && mean_m < kPolicy.told.better * than_m;
}

/// Whether a second diagnosis is worth its time: under payloads that hung there the effects that were found
/// as told, whose stand-ins they were, leave less than there, if not as much less as others will.
bool may_be_better(JointModel& model, const FirstFits& first, const Conclusion& as_told) {
  const double told_m = as_told.diagnosis.extended.held_out_mean_m;
  return unseen(model, first.baseline).mean_m < told_m ||
         refitted_unseen(model, model.fit(as_told.selection.extended.at, {})).mean_m < told_m;
}

}  // namespace

OtherPayloads payloads_that_trials_say(const arm::Arm& arm, const model::Prepared& prepared, Begun& as_told) {
  return other_payloads(as_told.model, fit_of_payloads(as_told.first), {},
                        usual_payload_kg(arm, prepared.trials));
}

AsToldAnew as_told_from(const UnderOthers& others, const model::Prepared& prepared,
                        const Conclusion& conclusion, Begun& as_told, const Options& options,
                        Schedule& schedule) {
  AsToldAnew anew;
  const JointParameters& from = others.conclusion.selection.extended.at;
  const Unseen there = refitted_unseen(as_told.model, as_told.model.fit(from, {}));
  anew.mean_m = there.mean_m;
  anew.rms_m = there.plain_rms_m;
  if (!(anew.mean_m > 0.0) || is_better(others.conclusion.diagnosis.extended.held_out_mean_m, anew.mean_m))
    return anew;
  anew.does_as_well = true;
  schedule.within(kUnderOthersShare, 1.0);
  schedule.begin_first_part("with the stated payloads, from there");
  fit_again_from(from, as_told.model, as_told.first);
  schedule.end_first_part();
  const double enough = (1.0 - kPolicy.selection.other_optimum) * conclusion.selection.baseline.square;
  if (!(as_told.first.baseline.square < enough)) return anew;
  anew.conclusion = concluded(prepared, as_told, std::nullopt, options, schedule);
  return anew;
}

std::optional<UnderOthers> under_other_payloads(const arm::Arm& arm, const model::Prepared& prepared,
                                                OtherPayloads payloads, Begun& as_told,
                                                Conclusion& conclusion, std::vector<model::TrialData>& trials,
                                                const Options& options, Schedule& schedule) {
  UnderOthers others;
  others.begun = begun_under(arm, prepared, payloads, trials, options, schedule);
  if (!others.begun) return std::nullopt;
  schedule.end_first_part();
  if (!may_be_better(others.begun->model, others.begun->first, conclusion)) return std::nullopt;
  others.conclusion = concluded(prepared, *others.begun, std::nullopt, options, schedule);
  Diagnosis& d = others.conclusion.diagnosis;
  const Diagnosis& told = conclusion.diagnosis;
  const double mean_m = d.extended.held_out_mean_m, told_m = told.extended.held_out_mean_m;
  if (!is_better(mean_m, told_m) || d.left_out_share > told.left_out_share + kPolicy.words.left_out_share)
    return std::nullopt;
  const double misfit = as_told.model.misfit();
  AsToldAnew anew = as_told_from(others, prepared, conclusion, as_told, options, schedule);
  if (anew.does_as_well) {
    if (anew.conclusion && anew.conclusion->diagnosis.extended.held_out_mean_m < told_m)
      conclusion = std::move(*anew.conclusion);
    else
      as_told.model.set_misfit(misfit);  // the conclusion that stays is by it
    return std::nullopt;
  }
  ToldPayloads found = told_payloads(payloads.list, prepared.trials);
  found.as_told_mean_m = anew.mean_m > 0.0 ? std::min(told_m, anew.mean_m) : told_m;
  found.mean_m = mean_m;
  const double left_m = d.extended.held_out_rms_m, as_told_m = told.extended.held_out_rms_m;
  found.probability =
      is_no_stand_in(beyond_m(anew.mean_m > 0.0 ? std::min(as_told_m, anew.rms_m) : as_told_m, left_m),
                     beyond_m(left_m, d.noise_floor_m), arm.total_length_m(), false);
  if (found.probability < kPolicy.posterior.named) {
    conclusion.diagnosis.notes.push_back("Other payloads are possible. " + found_instead(found));
    return std::nullopt;
  }
  d.told_payloads = std::move(found);
  d.summary = sentence_of(*d.told_payloads) + " " + d.summary;
  return others;
}

}  // namespace softarm::diagnose
