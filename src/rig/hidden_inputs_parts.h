// The table of the inputs' effects in its parts: private to the rig.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "hidden.h"
#include "scenario.h"

namespace softarm::rig {

/// Between a regulator and a chamber.
std::vector<HiddenEffect> pneumatic_effects();
/// In the laws of moment, stiffness and length.
std::vector<HiddenEffect> law_effects();
/// What remembers or ages: hysteresis, friction, granules, drift; and the scale.
std::vector<HiddenEffect> memory_effects();

constexpr double kReferencePa = 50e3, kReferenceVacuumPa = 60e3;

/// The parameter `reference_pa` of effects that are a share there.
inline HiddenParameter reference(double pa) {
  return {"reference_pa", 1.0, 1e7, pa, pa, "pressure or vacuum at which the share is reached", pa};
}

/// The parameter `chamber`.
inline HiddenParameter chamber_number() {
  return {"chamber", 0.0, 16.0, 1.0, 3.0, "number of the chamber; 0: all", 0.0, true};
}

/// The same of what all may have as well. @param of_forms none: all forms of the effect
inline HiddenParameter all_or_one_chamber(std::vector<std::string> of_forms = {}) {
  return {"chamber", 0.0, 16.0, 0.0, 3.0, "number of the chamber; 0: all", 0.0, true, std::move(of_forms)};
}

/// The chamber of a choice as the rig numbers it, from 0; -1: all.
inline int chamber_index(const HiddenChoice& choice, const Scenario& scenario) {
  const int number = static_cast<int>(choice.values.at("chamber"));
  if (number > scenario.arm.chambers)
    throw std::invalid_argument("chamber is " + std::to_string(number) + ", allowed 0 ... " +
                                std::to_string(scenario.arm.chambers) + " (of the arm)");
  return number - 1;
}

inline void need(bool given, const std::string& what) {
  if (!given) throw std::invalid_argument("needs " + what);
}

inline void need_pressures(const Scenario& scenario) {
  need(scenario.arm.chambers > 0, "an arm that takes pressures");
}

inline void need_chambers(const Scenario& scenario) {
  for (const SegmentSpec& segment : scenario.arm.segments)
    if (!segment.chambers.empty()) return;
  need(false, "an arm with chambers that bend it");
}

inline void need_vacuum(const Scenario& scenario) {
  need(!scenario.vacuum.schedule.empty(), "a schedule of the vacuum");
}

inline void need_jamming(const Scenario& scenario) {
  need_vacuum(scenario);
  for (const SegmentSpec& segment : scenario.arm.segments)
    if (segment.stiffness_per_jamming_nm2_per_pa != 0.0) return;
  need(false, "an arm whose EI depends on the vacuum (per_jamming_pressure_nm2_per_pa)");
}

/// Puts an effect into its place, which it has for itself.
template <typename Spec>
void put(std::optional<Spec>& place, const Spec& spec) {
  if (place) throw std::invalid_argument("given twice");
  place = spec;
}

}  // namespace softarm::rig
