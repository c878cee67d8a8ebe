// Parts of the scenario's parser: private to the rig.
#pragma once

#include "scenario.h"
#include "yaml_reader.h"

namespace softarm::rig {

constexpr double kRadPerDeg = M_PI / 180.0;
constexpr Allowed kGaugePressure{-101325.0, 1e6};

/// The section `arm`: segments, and the inputs that they take.
ArmSpec parse_arm_spec(YamlMap map);

/// The drives of pressures, tensions and angles, for the inputs of an arm.
PressureSpec parse_pressures(YamlMap map, const ArmSpec& arm);
DriveSpec parse_tensions(YamlMap map, const ArmSpec& arm);
DriveSpec parse_angles(YamlMap map, const ArmSpec& arm);

/// What one kind of input is called in the file, and the range of its commands.
struct InputKindKeys {
  std::string unit;    ///< the end of its keys
  std::string values;  ///< key of a setpoint's values
  Allowed allowed;
  std::optional<double> most;  ///< default of the random inputs' maximum
  int inputs;
};

/// The limits of random inputs, min_<unit> and max_<unit>: a number for all, or one for each.
void parse_limits(YamlMap& map, const InputKindKeys& keys, std::vector<double>& min,
                  std::vector<double>& max);

/// A list of {t_s, <key>: value or values}, from t_s = 0 on, each with its own over_s where it is given and
/// allowed, each not before the last change is over.
/// @param count of the values; absent: a number alone
/// @param ramp_s how long the changes take
std::vector<Setpoint> parse_schedule(YamlMap& map, const std::string& value_key, Allowed allowed,
                                     std::optional<std::size_t> count, double ramp_s, bool own_ramps);

/// The list `programme` of a drive, and repeat_programme.
Programme parse_programme(YamlMap& map, const InputKindKeys& keys);

/// The orientation of the clamp in the mocap frame that a word names.
std::optional<Eigen::Quaterniond> attitude_named(const std::string& word);

/// The shortest trial that lets every drive leave its rest and come back (s), and what needs it, in words.
std::pair<double, std::string> least_duration(const Scenario& scenario);

/// The list `hidden` of the document, hidden in the scenario.
void parse_hidden(YamlMap& document, Scenario& scenario);

}  // namespace softarm::rig
