// Which constants of the arm are fitted.
#pragma once

#include <string>
#include <vector>

#include "softarm/identify/identify.h"

namespace softarm::identify {

/// Those that the options free, less those that they hold; tied ones as one.
/// @throws std::invalid_argument for patterns that match, or free, nothing
std::vector<ConstantRef> choose_free(const arm::Arm& arm, const Options& options);

/// What was asked for by name and is not among the constants that are fitted, with the reason: a line each.
std::vector<std::string> not_fitted(const arm::Arm& arm, const Options& options,
                                    const std::vector<ConstantRef>& free);

}  // namespace softarm::identify
