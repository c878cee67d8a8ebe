// Sizes that are wished for of what is hidden.
#pragma once

#include "signal.h"

namespace softarm::prove {

/// Whether an effect can be seen, and its name counts: it leaves half the position noise and as much as the
/// background leaves, or more. Means over 0.2 s are good to a fifth of that noise; what is smaller than the
/// background stands for nothing by itself.
bool is_clear(const Signal& signal, double noise_m, double background_m);

/// By which effects are scaled so that they leave what is wished for; 1 where they are as near as a tenth.
/// What constants absorb does not move the arm by more than three times the largest size.
/// @param wished_m, most_m what is to be left, and the most that any effect is to leave
double factor_towards(double wished_m, double most_m, const Signal& now);

}  // namespace softarm::prove
