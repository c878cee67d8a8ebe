// The parts of body_effects(): private to the rig.
#pragma once

#include <vector>

#include "hidden.h"
#include "scenario.h"
#include "scenario_parts.h"

namespace softarm::rig {

std::vector<HiddenEffect> profile_effects();   ///< along the arm
std::vector<HiddenEffect> material_effects();  ///< laws of the sections without and with memory
std::vector<HiddenEffect> boundary_effects();  ///< the base, gravity and loads
std::vector<HiddenEffect> outside_effects();   ///< not in the catalogue

/// @throws std::invalid_argument if the scenario has the effect already
void refuse_twice(const HiddenChoice& choice, const Scenario& scenario);

/// A direction to choose freely.
inline HiddenParameter azimuth(const std::string& words, std::optional<double> otherwise = {}) {
  return {"azimuth_deg", -360.0, 360.0, 0.0, 360.0, words, otherwise};
}

/// An angle of a choice, rad.
inline double angle_of(const HiddenChoice& choice, const std::string& key) {
  return kRadPerDeg * choice.values.at(key);
}

}  // namespace softarm::rig
