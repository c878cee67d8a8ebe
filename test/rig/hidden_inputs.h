// Hiding effects in scenarios and watching what acts: for the tests of the inputs' effects.
#pragma once

#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "rig/input_path.h"
#include "rig/laws.h"

namespace softarm::rig {

/// An arm with three chambers, a jamming core, two tendons in each of two segments and a published payload.
inline Scenario laboratory() {
  Scenario s;
  s.name = "laboratory";
  s.duration_s = 10.0;
  SegmentSpec segment;
  segment.length_m = 0.1;
  segment.mass_kg = 0.1;
  segment.stiffness_base_nm2 = 0.03;
  segment.stiffness_per_jamming_nm2_per_pa = 1e-7;
  segment.torsional_stiffness_nm2 = 0.02;
  segment.axial_stiffness_n = 500.0;
  segment.shear_stiffness_n = 60.0;
  for (int i = 0; i < 3; ++i) segment.chambers.push_back({i, 2.0 * M_PI / 3.0 * i, 6e-6, 2e-8, 0.0});
  segment.tendons = {{0, 0.0, 0.01}, {1, M_PI / 2.0, 0.01}};
  s.arm.segments = {segment, segment};
  s.arm.chambers = 3;
  s.arm.tendons = 2;
  s.vacuum.schedule = {{0.0, {0.0}}};
  s.payload.schedule = {{0.0, {0.1}}};
  return s;
}

/// The laboratory with two cables at right angles in each of its segments instead, wound up by a servo each.
inline Scenario wound_laboratory() {
  Scenario s = laboratory();
  int servo = 0;
  for (SegmentSpec& segment : s.arm.segments) {
    segment.chambers.clear();
    segment.tendons.clear();
    for (const double azimuth : {0.0, M_PI / 2.0}) segment.cables.push_back({servo++, azimuth, 0.01, 0.005});
  }
  s.arm.chambers = s.arm.tendons = 0;
  s.arm.servos = servo;
  return s;
}

/// The laboratory with an effect; parameters that are not given take their defaults.
inline Scenario with(const std::string& effect, const std::map<std::string, double>& values,
                     const std::string& form = "", Scenario scenario = laboratory()) {
  const HiddenEffect& entry = *find_hidden_effect(effect);
  HiddenChoice choice{effect, form.empty() && !entry.forms.empty() ? entry.forms.front() : form, values};
  for (const HiddenParameter& p : entry.parameters)
    if (p.otherwise) choice.values.emplace(p.key, *p.otherwise);
  hide(choice, scenario);
  return scenario;
}

/// Commands of the laboratory.
inline Commands commands(double p1 = 0.0, double p2 = 0.0, double p3 = 0.0) {
  Commands c;
  c.pressures_pa = {p1, p2, p3};
  c.tensions_n = {0.0, 0.0};
  return c;
}

/// A path of inputs with its clock: goes straight to commands, in steps of a millisecond.
class Walk {
 public:
  explicit Walk(const Scenario& scenario, const Commands& start = commands())
      : path_(scenario, start), now_(start), acting_(path_.act(start, 0.0).front()) {}

  /// @param watch called after each step
  const Acting& to(const Commands& goal, double over_s,
                   const std::function<void(const Commands&, const Acting&)>& watch = {}) {
    constexpr double kStepS = 1e-3;
    const Commands from = now_;
    const int steps = static_cast<int>(std::lround(over_s / kStepS));
    const auto between = [&](double a, double b, double x) { return a + x * (b - a); };
    for (int i = 1; i <= steps; ++i) {
      const double x = static_cast<double>(i) / steps;
      for (std::size_t k = 0; k < now_.pressures_pa.size(); ++k)
        now_.pressures_pa[k] = between(from.pressures_pa[k], goal.pressures_pa[k], x);
      for (std::size_t k = 0; k < now_.tensions_n.size(); ++k)
        now_.tensions_n[k] = between(from.tensions_n[k], goal.tensions_n[k], x);
      now_.vacuum_pa = between(from.vacuum_pa, goal.vacuum_pa, x);
      t_s_ += kStepS;
      acting_ = path_.act(now_, t_s_).front();
      if (watch) watch(now_, acting_);
    }
    return acting_;
  }
  const Acting& hold(double for_s) { return to(Commands(now_), for_s); }
  const Acting& acting() const { return acting_; }

 private:
  InputPath path_;
  Commands now_;
  Acting acting_;
  double t_s_ = 0.0;
};

}  // namespace softarm::rig
