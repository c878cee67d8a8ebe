// Lag of the lines, leaks of the chambers, and one whose valve opens late.
#include <algorithm>
#include <cmath>

#include "law_departures.h"
#include "pressure_stages.h"

namespace softarm::rig {
namespace {

/// A pressure and its rate.
struct Channel {
  double p = 0.0, rate = 0.0;
};

/// Flow through an orifice over the choked one, at a ratio of absolute pressures (ISO 6358).
double flow_share(double ratio) {
  constexpr double kCritical = 0.3;
  if (ratio <= kCritical) return 1.0;
  if (ratio >= 1.0) return 0.0;
  const double x = (ratio - kCritical) / (1.0 - kCritical);
  return std::sqrt(1.0 - x * x);
}

/// @param chamber from 0; -1: all
bool is_of(int chamber, std::size_t i) {
  return chamber < 0 || static_cast<std::size_t>(chamber) == i;
}

class Lag : public PressureStage {
 public:
  Lag(const PressureLag& spec, double ambient_pa) : spec_(spec), ambient_pa_(ambient_pa) {}

  void start(Pressures& p) override {
    last_ = p;
    // A valve between supply and ambient reaches nothing beyond them.
    for (std::size_t i = 0; i < p.size(); ++i)
      if (spec_.form == PressureLag::Form::kChoked && is_of(spec_.chamber, i))
        p[i] = std::clamp(p[i], 0.0, spec_.supply_pa);
    for (double value : p) channels_.push_back({value, 0.0});
  }

  void act(Pressures& p, double, double dt_s) override {
    for (std::size_t i = 0; dt_s > 0.0 && i < p.size(); ++i) {
      if (spec_.form == PressureLag::Form::kFirstOrder)
        exactly(channels_[i], last_[i], p[i], dt_s);
      else
        in_small_steps(channels_[i], last_[i], p[i], dt_s);
    }
    last_ = p;
    for (std::size_t i = 0; i < p.size(); ++i)
      if (is_of(spec_.chamber, i)) p[i] = channels_[i].p;
  }

 private:
  /// The first-order line under an input that goes straight.
  void exactly(Channel& c, double from, double to, double dt_s) const {
    const double behind = (to - from) / dt_s * spec_.time_constant_s;
    c.p = to - behind + (c.p - from + behind) * std::exp(-dt_s / spec_.time_constant_s);
  }

  Channel derivative(const Channel& c, double input) const {
    const double tau = spec_.time_constant_s;
    const double error = input - c.p;
    if (spec_.form == PressureLag::Form::kSecondOrder) {
      const double w = 2.0 * spec_.damping_ratio / tau;
      return {c.rate, w * (w * error - 2.0 * spec_.damping_ratio * c.rate)};
    }
    const double open = std::clamp(error / PressureLag::kFullyOpenPa, -1.0, 1.0);
    const double chamber = c.p + ambient_pa_, supply = spec_.supply_pa + ambient_pa_;
    const double flow =
        open > 0.0 ? flow_share(chamber / supply) / tau
                   : chamber / ambient_pa_ * flow_share(ambient_pa_ / chamber) / spec_.vent_time_constant_s;
    return {open * PressureLag::kFullyOpenPa * flow, 0.0};
  }

  /// Runge and Kutta's method of fourth order, in steps that are short against the time constants.
  void in_small_steps(Channel& c, double from, double to, double dt_s) const {
    double longest_s = spec_.time_constant_s / (20.0 * std::max(1.0, 2.0 * spec_.damping_ratio));
    if (spec_.form == PressureLag::Form::kChoked)
      longest_s = std::min(longest_s, spec_.vent_time_constant_s / 20.0);
    const int steps = std::max(1, static_cast<int>(std::ceil(dt_s / longest_s)));
    const double h = dt_s / steps;
    const auto moved = [](const Channel& x, const Channel& by, double times) {
      return Channel{x.p + times * by.p, x.rate + times * by.rate};
    };
    for (int i = 0; i < steps; ++i) {
      const auto input = [&](double share) { return from + (to - from) * (i + share) / steps; };
      const Channel k1 = derivative(c, input(0.0));
      const Channel k2 = derivative(moved(c, k1, 0.5 * h), input(0.5));
      const Channel k3 = derivative(moved(c, k2, 0.5 * h), input(0.5));
      const Channel k4 = derivative(moved(c, k3, h), input(1.0));
      c.p += h / 6.0 * (k1.p + 2.0 * k2.p + 2.0 * k3.p + k4.p);
      c.rate += h / 6.0 * (k1.rate + 2.0 * k2.rate + 2.0 * k3.rate + k4.rate);
    }
  }

  PressureLag spec_;
  double ambient_pa_;
  Pressures last_;
  std::vector<Channel> channels_;
};

class Leak : public PressureStage {
 public:
  explicit Leak(const PressureLeak& spec) : spec_(spec) {}

  void start(Pressures& p) override {
    last_ = p;
    lost_.assign(p.size(), spec_.share);
    lose(p);
  }

  void act(Pressures& p, double, double dt_s) override {
    constexpr double kHoldPaPerS = 20.0;  // slower commands count as a hold
    constexpr double kRefillS = 0.1;      // time constant of making up for what was lost
    if (spec_.time_s && dt_s > 0.0) {
      for (std::size_t i = 0; i < p.size(); ++i) {
        const bool holds = std::abs(p[i] - last_[i]) <= kHoldPaPerS * dt_s;
        const double goal = holds ? spec_.share : 0.0, time_s = holds ? *spec_.time_s : kRefillS;
        lost_[i] += (goal - lost_[i]) * -std::expm1(-dt_s / time_s);
      }
      last_ = p;
    }
    lose(p);
  }

 private:
  void lose(Pressures& p) const {
    for (std::size_t i = 0; i < p.size(); ++i)
      if (is_of(spec_.chamber, i)) p[i] *= 1.0 - lost_[i];
  }

  PressureLeak spec_;
  Pressures last_;
  std::vector<double> lost_;  ///< share, per chamber
};

/// Of one chamber alone.
class DeadZone : public PressureStage {
 public:
  explicit DeadZone(const LawSpec::DeadZone& spec) : spec_(spec) {}

  void start(Pressures& p) override { lose(p); }
  void act(Pressures& p, double, double) override { lose(p); }

 private:
  void lose(Pressures& p) const {
    double& one = p.at(static_cast<std::size_t>(spec_.chamber));
    one = beyond_dead_zone(spec_, one);
  }

  LawSpec::DeadZone spec_;
};

}  // namespace

void add_line(const Scenario& scenario, PressureStages& stages) {
  const InputPathSpec& spec = scenario.input_path;
  if (spec.pressure_lag)
    stages.push_back(std::make_unique<Lag>(*spec.pressure_lag, scenario.pressures.ambient_pa));
  for (const PressureLeak& leak : spec.pressure_leaks) stages.push_back(std::make_unique<Leak>(leak));
  const auto& zone = spec.laws.dead_zone;
  if (zone && zone->chamber >= 0) stages.push_back(std::make_unique<DeadZone>(*zone));
}

}  // namespace softarm::rig
