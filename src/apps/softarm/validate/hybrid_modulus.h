// The hybrid paper's arm (Table 2) and what its rubber's constants make of it.
#pragma once

#include "table.h"

namespace softarm::app::validate {

constexpr double kHybridLengthM = 0.085;
constexpr double kHybridTensionN = 3.0;  ///< the largest
double hybrid_wall_area_m2();
double hybrid_second_moment_m4();

/// EI over pressure by (26) and by the tangent modulus, and why the printed constants cannot be.
Table hybrid_moduli(Series& series);

}  // namespace softarm::app::validate
