// The paper's formulas on circles.
#include <algorithm>
#include <boost/math/tools/roots.hpp>
#include <cmath>

#include "pull.h"
#include "softarm/rod/solver.h"

namespace softarm::published {
namespace {

constexpr int kNodes = 400;  // of the integrals; the trapezoidal rule errs by 1e-6

double lateral(const Circle& c, double s) {  // (16) on a circle
  const double k = c.angle_rad / c.length_m;
  return std::abs(k) < 1e-9 ? 0.5 * k * s * s : (1.0 - std::cos(k * s)) / k;
}

/// Integral of f(s) over the length by the trapezoidal rule.
template <typename Function>
double integral(double length_m, const Function& f) {
  const double step = length_m / kNodes;
  double sum = 0.5 * (f(0.0) + f(length_m));
  for (int i = 1; i < kNodes; ++i) sum += f(i * step);
  return sum * step;
}

}  // namespace

Circle circle_through(const Eigen::Vector3d& tip) {
  Circle c;
  const double side = tip.head<2>().norm();
  c.angle_rad = 2.0 * std::atan2(side, tip.z());
  c.direction_rad = std::atan2(tip.y(), tip.x());
  const double half = 0.5 * c.angle_rad;
  c.length_m = tip.norm() * (half < 1e-6 ? 1.0 + half * half / 6.0 : half / std::sin(half));
  return c;
}

double force_turn_times_stiffness(const Circle& c, double force_n, LoadLaw law, double azimuth_rad) {
  const double arm = integral(c.length_m, [&](double s) { return lateral(c, c.length_m) - lateral(c, s); });
  const double printed = law == LoadLaw::kPrinted ? std::sin(c.angle_rad) : 1.0;
  return force_n * printed * std::cos(azimuth_rad) * arm;
}

double weight_turn_times_stiffness(const Circle& c, double weight_n, LoadLaw law) {
  const double k = c.angle_rad / c.length_m;
  // The integral over s of an integral over r > s: each r counts r times where s drops out of the integrand.
  if (law == LoadLaw::kPrinted)
    return weight_n / c.length_m * integral(c.length_m, [&](double r) {
             return r * std::sin(k * r) * (lateral(c, c.length_m) - lateral(c, r));
           });
  // M(s) = W / L times the integral over r from s to L of x(r) - x(s); exchanged: x(r) (2 r - L) over r.
  return weight_n / c.length_m *
         integral(c.length_m, [&](double r) { return lateral(c, r) * (2.0 * r - c.length_m); });
}

std::optional<double> stiffness_on_circles(const Circle& before, const Circle& after, double force_n,
                                           LoadLaw law, double azimuth_rad) {
  const double turn = after.angle_rad - before.angle_rad;
  const double stiffness = force_turn_times_stiffness(after, force_n, law, azimuth_rad) / turn;
  if (!std::isfinite(stiffness) || !(stiffness > 0.0)) return std::nullopt;
  return stiffness;
}

std::optional<double> stiffness_from_perpendicular_force(double length_m, double angle_before_rad,
                                                         double angle_after_rad, double force_n) {
  // An arm that moves against the force has no stiffness; a very soft one would curl up to look like it.
  if (!((angle_after_rad - angle_before_rad) * force_n > 0.0)) return std::nullopt;
  rod::Rod rod;
  rod.gravity_m_s2.setZero();
  rod.segments.resize(1);
  rod.segments[0].rest_length_m = rod.segments[0].length_m = length_m;
  rod.loads.resize(1);
  rod.loads[0].s_m = length_m;
  rod.loads[0].follower = true;
  // Bending towards x; the section's x axis points to the inside of the bend at the tip.
  rod.loads[0].force_n = {force_n, 0.0, 0.0};
  rod::Solver solver(rod, {length_m}, {});
  bool failed = false;
  const auto excess = [&](double log_stiffness) {
    const double stiffness = std::exp(log_stiffness);
    rod.segments[0].bending_compliance = 1.0 / stiffness;
    rod.segments[0].moment_nm = {0.0, stiffness * angle_before_rad / length_m, 0.0};
    if (solver.solve(rod) != rod::SolveStatus::kConverged) {
      failed = true;
      return force_n > 0.0 ? 1.0 : -1.0;  // too soft
    }
    const Eigen::Vector3d tip = solver.station(0).p;
    return 2.0 * std::atan2(tip.x(), tip.z()) - angle_after_rad;
  };
  // From stiff, where nothing bends, down to the first that bends enough: beyond it the angle wraps around.
  const double stiffest = std::log(1e3), softest = std::log(1e-6);
  double high = stiffest, at_high = excess(high);
  constexpr double kStep = 0.25, kJump_rad = 3.0;
  for (double low = high - kStep; low > softest; low -= kStep) {
    failed = false;
    const double at_low = excess(low);
    // A jump is where the tip passes below the base and the circle's angle wraps around.
    if (failed || std::abs(at_low - at_high) > kJump_rad) return std::nullopt;
    if (at_high * at_low <= 0.0) {
      std::uintmax_t iterations = 60;
      const auto root = boost::math::tools::toms748_solve(
          excess, low, high, at_low, at_high, boost::math::tools::eps_tolerance<double>(40), iterations);
      return std::exp(0.5 * (root.first + root.second));
    }
    high = low;
    at_high = at_low;
  }
  return std::nullopt;
}

}  // namespace softarm::published
