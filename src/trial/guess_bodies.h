// Which poses are the arm's bodies, from base to tip: part of the guess of a layout.
#pragma once

#include <cstddef>
#include <set>

#include "layout_guess.h"

namespace softarm::trial {

/// Finds the bodies, their unit, the axis that points up and whether poses are repeated.
/// @param used columns that are something else already; those of the bodies are added
void find_bodies(LayoutGuess* guess, std::set<std::size_t>* used);

}  // namespace softarm::trial
