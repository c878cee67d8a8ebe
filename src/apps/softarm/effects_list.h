// What the virtual rig can hide, as text.
#pragma once

#include <string>

namespace softarm::app {

/// All effects: id, whether the catalogue of the diagnosis has it, words, forms, parameters with unit, range,
/// usual range and default.
std::string effects_list();

/// The unit that ends a key, "stiffness_nm_per_rad": "N m/rad"; "1" where it names none.
std::string unit_of_key(const std::string& key);

}  // namespace softarm::app
