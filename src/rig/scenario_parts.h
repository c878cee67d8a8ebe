// Parts of the scenario's parser: private to the rig.
#pragma once

#include "softarm/rig/scenario.h"
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

/// A list of {t_s, <key>: value or values}, from t_s = 0 on, changes at least ramp_s apart.
/// @param count of the values; absent: a number alone
std::vector<Setpoint> parse_schedule(YamlMap& map, const std::string& value_key, Allowed allowed,
                                     std::optional<std::size_t> count, double ramp_s);

/// The list `hidden` of the document, hidden in the scenario.
void parse_hidden(YamlMap& document, Scenario& scenario);

}  // namespace softarm::rig
