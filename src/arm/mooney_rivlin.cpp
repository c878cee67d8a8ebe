#include "mooney_rivlin.h"

#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>

namespace softarm::arm {
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

double MooneyRivlin::tangent_modulus_slope_pa(double stretch) const {
  const double fourth = stretch * stretch * stretch * stretch;
  return -12.0 * c10_pa / fourth - 24.0 * c01_pa / (fourth * stretch);
}

std::optional<double> MooneyRivlin::stretch_at(double wanted_pa) const {
  if (!std::isfinite(wanted_pa) || !(initial_modulus_pa() > 0.0)) return std::nullopt;
  if (wanted_pa == 0.0) return 1.0;
  const auto root_between = [](const auto& function, double a, double b) {
    std::uintmax_t iterations = 60;
    const auto bracket =
        boost::math::tools::toms748_solve(function, std::fmin(a, b), std::fmax(a, b),
                                          boost::math::tools::eps_tolerance<double>(50), iterations);
    return 0.5 * (bracket.first + bracket.second);
  };
  const auto excess = [&](double stretch) { return nominal_stress_pa(stretch) - wanted_pa; };
  // Along the stable branch until the stress is reached, or the limit of stability.
  const double factor = wanted_pa > 0.0 ? 1.0 + kStep : 1.0 / (1.0 + kStep);
  double from = 1.0;
  bool limit = false;
  while (!limit) {
    double to = from * factor;
    if (to > kLargestStretch || to < 1.0 / kLargestStretch) return std::nullopt;
    limit = !(tangent_modulus_pa(to) > 0.0);
    if (limit) to = root_between([&](double stretch) { return tangent_modulus_pa(stretch); }, from, to);
    if (excess(to) * wanted_pa >= 0.0) {
      const double stretch = root_between(excess, from, to);
      if (tangent_modulus_pa(stretch) > 0.0) return stretch;
    }
    from = to;
  }
  return std::nullopt;
}

}  // namespace softarm::arm
