#include "softarm/diagnose/diagnose.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "conclusion.h"
#include "exchanged_names.h"
#include "schedule.h"
#include "softarm/identify/identify.h"
#include "under_payloads.h"

namespace softarm::diagnose {
namespace {

constexpr double kAsTold = 0.5;  // share of all, where there is a second diagnosis under other payloads

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
  double from = 0.0, width = 1.0, said = 0.0;
  const auto part = [&](double share, const std::string& what) {
    said = std::max(said, from + width * share);
    if (progress) progress(said, what);
  };
  Schedule schedule(part, now_s);
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
  if (!other.list.empty()) width = kAsTold;
  schedule.end_first_part();
  Conclusion conclusion = concluded(prepared, begun, names, options, schedule);
  Diagnosis& d = conclusion.diagnosis;
  Schedule again(part, now_s);
  std::vector<model::TrialData> others_trials;
  std::optional<UnderOthers> others;
  if (!other.list.empty() && d.verdict != Verdict::kConsistent && d.verdict != Verdict::kExplained) {
    from = kAsTold;
    try {
      others = under_other_payloads(arm, prepared, std::move(other), begun, conclusion, others_trials,
                                    options, again);
      if (others) complete(*others->begun, others->conclusion, options, again);
    } catch (const std::exception& e) {
      others.reset();
      d.notes.push_back(
          fmt::format("Whether the payloads differed from those stated could not be decided: {}.", e.what()));
    }
  }
  if (!others) complete(begun, conclusion, options, schedule);
  from = 0.0;
  width = 1.0;
  schedule.end();
  return others ? std::move(others->conclusion.diagnosis) : std::move(d);
}

}  // namespace softarm::diagnose
