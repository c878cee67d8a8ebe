// What was told of a new arm, by flags or answers, as numbers.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "new_arm_text.h"

namespace softarm::app {

/// Text by flag. Of what follows each throws Failure with flag, value, range and unit where the text cannot
/// be; what it rests on must have been told: kind, segments, length, mass, diameter, actuators, bodies in
/// this order.
using Told = std::map<std::string, std::string>;

std::vector<std::string> parts(const std::string& text, char at);
/// One for each segment.
std::vector<std::string> per_segment(const Told& told, const std::string& flag, std::size_t segments,
                                     char at = ',');
std::size_t whole(const std::string& flag, const std::string& text, double most);
std::size_t count_of(const Told& told);
std::vector<double> lengths_of(const Told& told);
std::vector<double> masses_of(const Told& told);
std::vector<double> diameters_of(const Told& told);
std::vector<double> stiffnesses_of(const Told& told);
NewDrive drive_of(const std::string& text);
bool any_bends(const Told& told);
std::vector<NewDrive> drives_of(const Told& told);
/// Directions of what bends each segment; none where nothing does.
std::vector<std::vector<double>> all_angles_of(const Told& told);
std::vector<NewBody> bodies_of(const Told& told);
/// The body that carries the arm, or the attitude of a fixed base.
std::string base_of(const Told& told);
NewArm arm_of(const Told& told);

}  // namespace softarm::app
