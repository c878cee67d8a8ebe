// Trials as the engine's stages look at them: for tests of one stage.
#pragma once

#include <vector>

#include "diagnose/joint_model.h"
#include "model/prepared_trial.h"

namespace softarm::diagnose::testing {

struct Looked {
  Looked(const arm::Arm& arm, const std::vector<trial::Trial>& trials, const model::Preparation& how = {})
      : prepared(model::prepare(arm, trials, how)), model(arm, prepared.trials, 0) {
    baseline = model.fit(model.start(), {});
    model.allow_for_motion(baseline.at, baseline.predicted);
    baseline = model.fit(baseline.at, {}, &baseline.predicted);
  }
  model::Prepared prepared;
  diagnose::JointModel model;
  diagnose::Linearised baseline;  ///< without effects
};

}  // namespace softarm::diagnose::testing
