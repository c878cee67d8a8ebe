// Units as headers of recordings write them.
#pragma once

#include <string>
#include <vector>

namespace softarm::trial {

/// A unit as layouts name it ("kPa" for "[kpa]", "s" for "sec"), or, of those that layouts do not know, as it
/// is usually written ("V"); empty where the text is no unit.
std::string csv_unit(std::string text);

/// The unit in brackets at the end of a column's name: "p1 [kPa]", "t (s)"; empty without.
std::string unit_in_brackets(const std::string& name);

/// Whether the cells of a row are units: half of those that are not empty.
bool is_units_row(const std::vector<std::string>& cells);

}  // namespace softarm::trial
