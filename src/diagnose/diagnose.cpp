#include "softarm/diagnose/diagnose.h"

#include <fmt/format.h>

#include <chrono>

#include "conclusion.h"
#include "exchanged_names.h"
#include "schedule.h"
#include "softarm/identify/identify.h"
#include "under_payloads.h"

namespace softarm::diagnose {
namespace {

model::Prepared prepared_trials(const arm::Arm& arm, const std::vector<trial::Trial>& trials,
                                const model::Preparation& how) {
  try {
    return model::prepare(arm, trials, how);
  } catch (const model::UnusableTrials& e) {
    throw identify::IdentifyError(e.what());
  }
}

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

Diagnosis diagnose(const arm::Arm& arm, const std::vector<trial::Trial>& trials, const Options& options,
                   const Progress& progress) {
  Schedule schedule(progress, now_s);
  schedule.first_part(0.0, "averaging frames");
  model::Preparation how;
  how.block_s = options.block_s;
  // A fit may end here or there by the last digits of its sums: not so by the order in which trials are told.
  how.as_recorded = true;
  const model::Prepared prepared = prepared_trials(arm, trials, how);
  schedule.first_part(0.02, Begun::kFittingConstants);
  Begun begun(arm, prepared.trials, options, schedule);
  const std::optional<ExchangedNames> names = exchanged_names(arm, prepared.trials);
  OtherPayloads other;
  if (!names) other = payloads_that_trials_say(arm, prepared, begun);
  if (!other.list.empty()) schedule.within(0.0, kAsToldShare);
  schedule.end_first_part();
  Conclusion conclusion = concluded(prepared, begun, names, options, schedule);
  Diagnosis& d = conclusion.diagnosis;
  std::vector<model::TrialData> others_trials;
  std::optional<UnderOthers> others;
  if (!other.list.empty() && d.verdict != Verdict::kConsistent && d.verdict != Verdict::kExplained) {
    schedule.within(kAsToldShare, kUnderOthersShare);
    try {
      others = under_other_payloads(arm, prepared, std::move(other), begun, conclusion, others_trials,
                                    options, schedule);
      if (others) complete(*others->begun, others->conclusion, options, schedule);
    } catch (const std::exception& e) {
      others.reset();
      d.notes.push_back(
          fmt::format("Whether the payloads differed from those stated could not be decided: {}.", e.what()));
    }
  }
  if (!others) complete(begun, conclusion, options, schedule);
  schedule.end();
  return others ? std::move(others->conclusion.diagnosis) : std::move(d);
}

}  // namespace softarm::diagnose
