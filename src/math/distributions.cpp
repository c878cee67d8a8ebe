#include "distributions.h"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

namespace softarm::math {

double normal_quantile(double probability) {
  return boost::math::quantile(boost::math::normal(), probability);
}

double students_t_quantile(double degrees_of_freedom, double probability) {
  return boost::math::quantile(boost::math::students_t(degrees_of_freedom), probability);
}

double chi_squared_quantile(double degrees_of_freedom, double probability) {
  return boost::math::quantile(boost::math::chi_squared(degrees_of_freedom), probability);
}

double chi_squared_upper_quantile(double degrees_of_freedom, double probability) {
  return boost::math::quantile(
      boost::math::complement(boost::math::chi_squared(degrees_of_freedom), probability));
}

double f_upper_quantile(double degrees_of_freedom_1, double degrees_of_freedom_2, double probability) {
  return boost::math::quantile(boost::math::complement(
      boost::math::fisher_f(degrees_of_freedom_1, degrees_of_freedom_2), probability));
}

double normal_two_sided(double z) {
  return 2.0 * boost::math::cdf(boost::math::complement(boost::math::normal(), std::abs(z)));
}

double students_t_two_sided(double degrees_of_freedom, double t) {
  return 2.0 *
         boost::math::cdf(boost::math::complement(boost::math::students_t(degrees_of_freedom), std::abs(t)));
}

}  // namespace softarm::math
