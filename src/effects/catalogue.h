// All effects that this package knows.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "model/effect.h"

namespace softarm::effects {

/// All effects, in the order in which they act on the inputs.
const std::vector<std::unique_ptr<model::Effect>>& catalogue();
/// One of them, or the moment of a discovered law, which is none of them.
/// @return nullptr if there is none
const model::Effect* find(const std::string& id);

}  // namespace softarm::effects
