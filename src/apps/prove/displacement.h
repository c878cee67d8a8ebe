// By how much effects move the bodies: what was hidden against what was found is judged by that, whatever the
// form of its law.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "residuals.h"
#include "softarm/arm/arm.h"
#include "softarm/model/present.h"
#include "softarm/trial/trial.h"

namespace softarm::prove {

struct Displacement {
  std::string effect;
  Residuals by;  ///< see at_whole_seconds(), m
  /// Of its size; absent where it has several, which only their covariance would tell, or none is known.
  std::optional<double> relative_sd;
};

/// Of an arm with all these effects: by how much each moves the bodies of the trials beside the others.
std::vector<Displacement> displacements(const arm::Arm& arm, const std::vector<model::Present>& effects,
                                        const std::vector<trial::Trial>& trials, unsigned jobs);

/// By trial: [second, body, x, y, z], in micrometres.
nlohmann::ordered_json rows_of(const Residuals& displacement);

}  // namespace softarm::prove
