#include "published_cable.h"

#include <array>
#include <boost/numeric/odeint/stepper/runge_kutta4.hpp>
#include <cmath>

#include "published_shooting.h"

namespace softarm::published {
namespace {

using Eigen::VectorXd;

constexpr double kDownwards = 0.5 * kPi;  // direction of the load

using CableState = std::array<double, 4>;  // theta, theta', x, y

bool physical(const CableArm& arm) {
  const auto positive = [](double x) { return std::isfinite(x) && x > 0.0; };
  return positive(arm.bending_stiffness_nm2) && positive(arm.length_m) && positive(arm.cable_offset_m) &&
         positive(arm.load_arclength_m) && arm.load_arclength_m <= arm.length_m &&
         std::isfinite(arm.curvature_per_m) && std::isfinite(arm.load_n) && arm.load_n >= 0.0;
}

/// What the cable does at its end: with the load's moment zero there, the curvature at M is the cable's
/// alone.
struct Ends {
  double angle = 0.0;      ///< theta(M)
  double curvature = 0.0;  ///< theta'(M) on the side towards the base
};

class Part2 {  // the arm up to the load, as the paper numbers it
 public:
  Part2(const CableArm& arm, CableLaw law, int steps) : arm_(arm), law_(law), steps_(steps) {}

  /// Integrates from M to the base; positions are relative to M.
  template <class Visit>
  CableState integrate(const Ends& ends, double share, const Visit& visit) const {
    CableState state{ends.angle, ends.curvature, 0.0, 0.0};
    const auto rate = [&](const CableState& y, CableState& dy, double s) {
      dy = {y[1], share * arm_.load_n / arm_.bending_stiffness_nm2 * std::sin(y[0] - load_angle(s)),
            std::cos(y[0]), std::sin(y[0])};
    };
    boost::numeric::odeint::runge_kutta4<CableState> stepper;
    const double step = -arm_.load_arclength_m / steps_;
    visit(steps_, state);
    for (int i = steps_ - 1; i >= 0; --i) {
      stepper.do_step(rate, state, -(i + 1) * step, step);
      visit(i, state);
    }
    return state;
  }

 private:
  /// Direction of the load in (10), theta_0(s) - alpha with alpha = theta_0(M) - 90 degrees.
  double load_angle(double s) const {
    const bool tip = arm_.load_arclength_m == arm_.length_m;  // (7)
    const bool turns = (law_ == CableLaw::kPrinted || law_ == CableLaw::kPrintedForce) && !tip;
    return turns ? kDownwards + arm_.curvature_per_m * (s - arm_.load_arclength_m) : kDownwards;
  }

  CableArm arm_;
  CableLaw law_;
  int steps_;
};

/// Finds the ends of part 2 that leave the base horizontal.
/// @param ends_of (share of the load, unknown) -> Ends
template <class EndsOf>
bool shoot(const Part2& part, const EndsOf& ends_of, double start, Ends& ends) {
  VectorXd x = VectorXd::Constant(1, start);
  const bool found = follow_root(
      [&](double share, const VectorXd& at) -> VectorXd {
        const CableState base = part.integrate(ends_of(at[0]), share, [](int, const CableState&) {});
        return VectorXd::Constant(1, base[0]);
      },
      x);
  ends = ends_of(x[0]);
  return found;
}

void write(const CableArm& arm, const Part2& part, const Ends& ends, double curvature_beyond, int steps,
           CableShape& shape) {
  const double reach = arm.load_arclength_m;
  const int beyond = reach < arm.length_m ? steps : 0;
  const int count = steps + 1 + beyond;
  shape.s_m.resize(count);
  shape.s_m.head(steps + 1) = VectorXd::LinSpaced(steps + 1, 0.0, reach);
  shape.theta_rad.resize(count);
  shape.curvature_per_m.resize(count);
  shape.p_m.resize(2, count);
  const CableState base = part.integrate(ends, 1.0, [&](int i, const CableState& state) {
    shape.theta_rad[i] = state[0];
    shape.curvature_per_m[i] = state[1];
    shape.p_m.col(i) << state[2], state[3];
  });
  shape.p_m.leftCols(steps + 1).colwise() -= Eigen::Vector2d(base[2], base[3]);
  const Eigen::Vector2d at_load = shape.p_m.col(steps);
  for (int i = 1; i <= beyond; ++i) {  // (12): an arc, (13) in closed form
    const double along = (arm.length_m - reach) * i / beyond;
    const double half_turn = 0.5 * curvature_beyond * along;
    const double chord = half_turn == 0.0 ? along : along * std::sin(half_turn) / half_turn;
    const double direction = ends.angle + half_turn;
    shape.s_m[steps + i] = reach + along;
    shape.theta_rad[steps + i] = ends.angle + 2.0 * half_turn;
    shape.curvature_per_m[steps + i] = curvature_beyond;
    shape.p_m.col(steps + i) = at_load + chord * Eigen::Vector2d(std::cos(direction), std::sin(direction));
  }
}

}  // namespace

std::optional<double> steering_angle_rad(double pwm) {
  if (!(pwm >= 500.0 && pwm <= 2500.0)) return std::nullopt;
  return (pwm - 500.0) / (2500.0 - 500.0) * 270.0 * kPi / 180.0;
}

std::optional<double> cable_change_m(const CableDrive& drive, double pwm) {
  const std::optional<double> angle = steering_angle_rad(pwm);
  const std::optional<double> straight = steering_angle_rad(drive.straight_pwm);
  if (!angle || !straight) return std::nullopt;
  return drive.spool_radius_m * (*angle - *straight);
}

double curvature_per_m(const CableDrive& drive, double cable_change_m) {
  return cable_change_m / (drive.length_m * (drive.arm_radius_m + drive.wall_thickness_m));
}

double curvature_at_arm_radius_per_m(const CableDrive& drive, double cable_change_m) {
  return cable_change_m / (drive.length_m * drive.arm_radius_m);
}

CableShape solve_cable(const CableArm& arm, CableLaw law, const CableOptions& options) {
  CableShape shape;
  if (!physical(arm) || options.steps < 4 || options.steps > 100000) return shape;
  const Part2 part(arm, law, options.steps);
  const double k = arm.curvature_per_m;
  const double reach = arm.load_arclength_m;
  const double stiffness_per_offset = arm.bending_stiffness_nm2 / arm.cable_offset_m;
  shape.status = rod::SolveStatus::kNoConvergence;
  Ends ends;
  double beyond = k;
  bool found = false;
  if (law == CableLaw::kConstantLength) {
    // The cable is as long as offset times the angle of the tip wants it, whatever the load: theta(M) + kappa
    // (L - M) = k L, kappa its tension's curvature.
    const auto taut = [&](double turn) {  // kappa L
      const double curvature = turn / arm.length_m;
      return Ends{k * arm.length_m - curvature * (arm.length_m - reach), curvature};
    };
    found = shoot(part, taut, k * arm.length_m, ends);
    if (found && ends.curvature * k <= 0.0) {  // it would have to push
      const auto slack = [](double angle) { return Ends{angle, 0.0}; };
      found = shoot(part, slack, 0.0, ends);
    }
    beyond = ends.curvature;
  } else {
    const double at_load = law == CableLaw::kPrinted && reach < arm.length_m ? -k : k;  // (11); (8)
    found = shoot(
        part,
        [&](double angle) {
          return Ends{angle, at_load};
        },
        at_load * reach, ends);
  }
  if (!found) return shape;
  shape.status = rod::SolveStatus::kConverged;
  write(arm, part, ends, beyond, options.steps, shape);
  shape.tension_n = stiffness_per_offset * std::abs(beyond);
  return shape;
}

}  // namespace softarm::published
