// Settings that repair a finding, as the arm file or the import layout takes them.
//
// One or several of "path: value", joined by "; ", all to be applied together. A path has keys joined by dots
// and, in brackets, which entry of a list: its name (of inputs of a layout its topic), or its number from 0.
// One that ends in " (of the layout)" is of the layout by which the recording was imported, any other of the
// arm file. Empty: nothing that is known here would be accepted, or would repair it.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "context.h"

namespace softarm::check {

/// "inputs.pressures[chamber_1]"
std::string path_of(const arm::ScalarInput& input);
/// "{position_m: [x, y, z], quaternion_xyzw: [x, y, z, w]}": in place of any way in which it was given
/// before.
std::string pose_value(const Eigen::Isometry3d& pose);
std::string joined(const std::vector<std::string>& settings);

/// States a body's noise; empty for the base, or beyond what the arm file takes.
std::string position_sd_setting(const Track& track, double sd_m);
/// Does without a body's orientation; empty where the arm file needs it, or does not use it as it is.
std::string without_orientation(const Context& context, const Track& track);
/// Fixes the base's attitude (in the layout, which knows its position still), or its pose.
std::string fixed_base(const Context& context);
/// Where and in which unit a file says the zero of an input; level and limit are left open.
ZeroAtRest zero_of(const Context& context, const Signal& signal);
/// What a sensor shows too much is subtracted. @param level SI, of the values with the zero that it has
std::string zero_setting(const ZeroAtRest& zero, double level);
/// The level as a number with the unit of that file: "-0.75 psi".
std::string in_unit(const ZeroAtRest& zero, double level);
/// The bodies' clock, ahead of the inputs' by so much more than is known; empty where neither file can say
/// it.
std::string clock_setting(const Context& context, double ahead_s);

/// How long an input may be held: of several proposals the longest.
inline constexpr char kHoldPath[] = "inputs.input_max_age_s";

/// One "path: value" of a setting.
struct SettingStep {
  std::string path, value;
};
std::vector<SettingStep> setting_steps(const std::string& setting);

/// What several recordings propose for one key, to different values, becomes one setting in all of them: the
/// median, or none where figures differ by more than their standard deviations, or are no numbers.
/// @return a line for each: `pooled_setting` or `settings_differ`
std::vector<CheckFinding> pool_settings(std::vector<CheckReport>& reports);

/// Of settings that cannot all be followed, as they set one key or the one rests on what the other repairs,
/// only the first is left; the remedies of the others say when to look again.
/// @param findings most serious first
void withhold_contradictions(std::vector<CheckFinding>& findings);

}  // namespace softarm::check
