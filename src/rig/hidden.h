// What can be hidden in an arm, its inputs and its sensors, and stands in no arm file.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace softarm::rig {

struct Scenario;

/// A number of an effect.
struct HiddenParameter {
  std::string key;               ///< with its unit: "loop_pa"
  double low, high;              ///< allowed
  double usual_low, usual_high;  ///< of real arms: what a campaign draws from
  std::string words;
  std::optional<double> otherwise = {};    ///< value where the scenario does not say; absent: it must
  bool whole = false;                      ///< it counts or numbers something: fractions are refused
  std::vector<std::string> of_forms = {};  ///< that have it; none: all forms of the effect

  bool is_of(const std::string& form) const;
};

/// One effect as a scenario has it, in its list `hidden`.
struct HiddenChoice {
  std::string effect;
  std::string form;                      ///< empty: the effect has one form only
  std::map<std::string, double> values;  ///< every parameter of the effect's form
};

/// An effect that a scenario can switch on.
struct HiddenEffect {
  std::string id;
  bool catalogued = true;  ///< false: not in the catalogue of the diagnosis
  std::string words;
  /// Functional forms, the first is the default; none: there is only one.
  std::vector<std::string> forms;
  std::vector<HiddenParameter> parameters;
  /// Writes the choice into the scenario. @throws std::invalid_argument, a line, where it does not fit the
  /// arm or what is hidden already
  void (*apply)(const HiddenChoice& choice, Scenario& scenario);
  /// Of one that is not in the catalogue: the one there that no recording of poses can distinguish it from;
  /// empty: none.
  std::string like = {};
  /// Of one that is not in the catalogue, but of a kind that is: the effect there whose words say it, though
  /// its law leaves a part of it.
  std::string of_the_kind = {};
};

/// All effects: of the body, of the inputs, of the sensors.
const std::vector<HiddenEffect>& hidden_effects();

/// @return nullptr if there is none
const HiddenEffect* find_hidden_effect(const std::string& id);

/// Hides an effect: checks the choice against the effect's forms and ranges, appends it to Scenario::hidden
/// and applies it. Values that it lacks are those of a scenario that does not say them.
/// @throws std::invalid_argument, a line: what, where, allowed
void hide(HiddenChoice choice, Scenario& scenario);

}  // namespace softarm::rig
