// What trials say: the fits that everything begins with, what follows from them, and what is shown beside it.
#pragma once

#include <optional>
#include <vector>

#include "exchanged_names.h"
#include "first_fits.h"
#include "joint_model.h"
#include "model/prepared_trial.h"
#include "schedule.h"
#include "selection.h"
#include "softarm/diagnose/diagnose.h"

namespace softarm::diagnose {

/// Trials under some payloads, and the fits that everything begins with.
struct Begun {
  /// @param trials kept by reference
  Begun(const arm::Arm& arm, const std::vector<model::TrialData>& trials, const Options& options,
        Schedule& schedule)
      : model(arm, trials, options.jobs, options.held, options.tied, options.known),
        first(first_fits(model, [&] { schedule.first_part(0.05, kFittingConstants); })) {}

  static constexpr const char* kFittingConstants = "fitting the arm's constants";
  JointModel model;
  FirstFits first;
};

/// What trials say, and the models that say it.
struct Conclusion {
  Diagnosis diagnosis;
  Selection selection;
};

/// What follows those fits, but for what is shown beside it. Takes the baseline of `begun`.
Conclusion concluded(const model::Prepared& prepared, Begun& begun,
                     const std::optional<ExchangedNames>& names, const Options& options, Schedule& schedule);

/// What single instants say, what to measure next, pictures.
void complete(Begun& begun, Conclusion& conclusion, const Options& options, Schedule& schedule);

}  // namespace softarm::diagnose
