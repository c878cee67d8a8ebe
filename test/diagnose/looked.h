// Trials as the engine's stages look at them: for tests of one stage.
#pragma once

#include <vector>

#include "joint_model.h"
#include "softarm/effects/trial.h"

namespace softarm::diagnose::testing {

struct Looked {
  Looked(const Arm& arm, const std::vector<identify::Trial>& trials)
      : prepared(effects::prepare(arm, trials)), model(arm, prepared.trials, 0) {
    baseline = model.fit(model.start(), {});
    model.allow_for_motion(baseline.predicted);
    baseline = model.fit(baseline.at, {}, &baseline.predicted);
  }
  effects::Prepared prepared;
  JointModel model;
  Linearised baseline;  ///< without effects
};

}  // namespace softarm::diagnose::testing
