// By how much effects move the bodies: what was hidden against what was found is judged by that, whatever the
// form of its law.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "residuals.h"
#include "softarm/arm/arm.h"
#include "softarm/model/present.h"
#include "softarm/trial/trial.h"

namespace softarm::prove {

struct Displacement {
  std::string effect;
  Residuals by;  ///< at whole seconds, m
  /// Of its size as a whole, by the standard deviations of the effect's sizes, taken for independent; its
  /// other numbers as they are.
  double relative_sd = 0.0;
};

/// Of an arm with all these effects: by how much each moves the bodies of the trials beside the others.
std::vector<Displacement> displacements(const arm::Arm& arm, const std::vector<model::Present>& effects,
                                        const std::vector<trial::Trial>& trials, unsigned jobs);

/// By trial: [second, body, x, y, z], in micrometres.
nlohmann::ordered_json rows_of(const Residuals& displacement);

}  // namespace softarm::prove
