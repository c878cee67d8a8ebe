// Quantiles and tails of the distributions that decide something. Boost's are templates whose compilation
// takes seconds, so they are compiled once, behind these functions.
#pragma once

namespace softarm::math {

/// The value below which a share `probability` of the distribution lies.
double normal_quantile(double probability);
double students_t_quantile(double degrees_of_freedom, double probability);
double chi_squared_quantile(double degrees_of_freedom, double probability);

/// The value above which a share `probability` of the distribution lies: exact where that is all but 0.
double chi_squared_upper_quantile(double degrees_of_freedom, double probability);

/// The same of the ratio of two means of squares (Fisher's F).
double f_upper_quantile(double degrees_of_freedom_1, double degrees_of_freedom_2, double probability);

/// The probability of a value at least as far from 0, on either side.
double normal_two_sided(double z);
double students_t_two_sided(double degrees_of_freedom, double t);

}  // namespace softarm::math
