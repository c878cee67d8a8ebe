#include "softarm/arm/mooney_rivlin.h"

#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>

namespace softarm {
namespace {

// Far beyond any rubber.
constexpr double kLargestStretch = 20.0;
// Between steps of this share the tangent modulus of two terms does not change its sign unseen.
constexpr double kStep = 0.02;

}  // namespace

double MooneyRivlin::nominal_stress_pa(double stretch) const {
  return 2.0 * (c10_pa + c01_pa / stretch) * (stretch - 1.0 / (stretch * stretch));
}

double MooneyRivlin::tangent_modulus_pa(double stretch) const {
  const double cube = stretch * stretch * stretch;
  return 2.0 * c10_pa * (1.0 + 2.0 / cube) + 6.0 * c01_pa / (cube * stretch);
}

std::optional<double> MooneyRivlin::stretch_at(double wanted_pa) const {
  if (!std::isfinite(wanted_pa) || !(initial_modulus_pa() > 0.0)) return std::nullopt;
  if (wanted_pa == 0.0) return 1.0;
  const auto excess = [&](double stretch) { return nominal_stress_pa(stretch) - wanted_pa; };
  // Along the stable branch until the stress is reached.
  const double factor = wanted_pa > 0.0 ? 1.0 + kStep : 1.0 / (1.0 + kStep);
  double from = 1.0;
  while (true) {
    const double to = from * factor;
    if (to > kLargestStretch || to < 1.0 / kLargestStretch || !(tangent_modulus_pa(to) > 0.0))
      return std::nullopt;
    if (excess(to) * wanted_pa >= 0.0) {
      std::uintmax_t iterations = 60;
      const auto bracket =
          boost::math::tools::toms748_solve(excess, std::fmin(from, to), std::fmax(from, to),
                                            boost::math::tools::eps_tolerance<double>(50), iterations);
      return 0.5 * (bracket.first + bracket.second);
    }
    from = to;
  }
}

}  // namespace softarm
