// Which columns are poses: part of the guess of a layout.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "layout_guess.h"

namespace softarm::trial {

inline constexpr double kUnitNorm = 5e-3;  ///< four numbers whose norm is so near to 1 are a unit quaternion

const std::vector<double>& values(const LayoutGuess& guess, std::size_t column);

/// A name without the one letter that says which axis it is; empty where it says none.
std::string stem_of(const std::string& name, char axis);

/// Adds the bodies, in the file's order or nearly so: positions, with quaternions where they are.
/// @param used columns that are something else already; those of the bodies are added
void find_poses(LayoutGuess* guess, std::set<std::size_t>* used);

}  // namespace softarm::trial
