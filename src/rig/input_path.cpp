#include "input_path.h"

#include <cmath>
#include <stdexcept>

#include "hysteresis.h"
#include "jamming_state.h"
#include "pressure_stages.h"
#include "tendon_friction.h"

namespace softarm::rig {
namespace {

/// What leaves the stages with an input that has long settled.
Pressures settle(PressureStages& stages, Pressures pressures_pa) {
  for (const auto& stage : stages) stage->start(pressures_pa);
  return pressures_pa;
}

PressureStages pressure_stages(const Scenario& scenario) {
  PressureStages stages;
  add_supply(scenario, stages);
  add_regulator(scenario, stages);
  add_line(scenario, stages);
  return stages;
}

/// From -1 to 1, at a place of the period between 0 and 1, at the first of which a heater goes on.
double heated(double place) {
  constexpr double kOn = 0.4,
                   kTime = 0.3;  // shares of the period: the heater's, and of the arm's time constant
  const auto towards = [](double x, double whole) {
    return std::expm1(-x / kTime) / std::expm1(-whole / kTime);
  };
  return place < kOn ? -1.0 + 2.0 * towards(place, kOn) : 1.0 - 2.0 * towards(place - kOn, 1.0 - kOn);
}

/// Share of a drift that is reached.
double drifted(const Drift& drift, double t_s) {
  constexpr double kBegins = 0.05;  // of over_s: until then it goes on nearly evenly
  const double x = t_s / drift.over_s;
  switch (drift.form) {
    case Drift::Form::kLinear:
      return x;
    case Drift::Form::kSaturating:
      return -std::expm1(-x);
    case Drift::Form::kLogarithmic:
      return std::log1p(x / kBegins) / std::log1p(1.0 / kBegins);
  }
  throw std::logic_error("drifted: no such form");
}

/// What time alone changes. @param t_s of the session
void age(const InputPathSpec& spec, double t_s, Acting& acting) {
  if (const auto& drift = spec.drift) {
    const double reached = drifted(*drift, t_s);
    acting.gain_scale *= 1.0 + drift->gain_share * reached;
    acting.stiffness_scale *= 1.0 + drift->stiffness_share * reached;
  }
  if (const auto& swing = spec.temperature) {
    const double angle = 2.0 * M_PI * t_s / swing->period_s + swing->phase_rad;
    const double turns = angle / (2.0 * M_PI);
    const double warmer_k =
        swing->amplitude_k * (swing->thermostat ? heated(turns - std::floor(turns)) : std::sin(angle));
    acting.stiffness_scale *= 1.0 + swing->stiffness_share_per_k * warmer_k;
    acting.length_scale *= 1.0 + swing->expansion_share_per_k * warmer_k;
  }
}

}  // namespace

struct InputPath::Impl {
  Impl(const Scenario& scenario, const Commands& start)
      : spec(scenario.input_path),
        session_s(scenario.session_s),
        segments(scenario.arm.segments.size()),
        stages(pressure_stages(scenario)),
        pressures(spec.hysteresis, spec.pressure_play_pa, settle(stages, start.pressures_pa),
                  spec.pressure_play_chamber),
        tensions(spec.hysteresis, spec.tension_play_n, start.tensions_n),
        angles(spec.hysteresis, spec.angle_play_rad, start.angles_rad) {
    if (spec.jamming_settling) jamming.emplace(*spec.jamming_settling, start.vacuum_pa);
    if (spec.tendon_friction) friction.emplace(*spec.tendon_friction, scenario.arm, start.tensions_n);
  }

  std::vector<Acting> act(const Commands& commanded, double t_s, const std::vector<Bend>& bends) {
    const double dt_s = t_s - last_s;
    last_s = t_s;
    Acting acting(commanded);
    for (const auto& stage : stages) stage->act(acting.pressures_pa, t_s, dt_s);
    pressures.act(acting.pressures_pa);
    tensions.act(acting.tensions_n);
    angles.act(acting.angles_rad);
    if (jamming) acting.jamming_pa = jamming->to(acting.vacuum_pa, dt_s);
    age(spec, session_s + t_s, acting);

    std::vector<Acting> result(segments, acting);
    Eigen::Vector2d before_rad = Eigen::Vector2d::Zero();
    for (std::size_t i = 0; i < segments; ++i) {
      result[i].segment = static_cast<int>(i);
      if (bends.empty()) continue;
      result[i].bend_rad = bends.at(i).rad;
      result[i].bent_before_rad = before_rad;
      before_rad += bends[i].towards_rad;
    }
    if (friction) friction->act(result);
    return result;
  }

  InputPathSpec spec;
  double session_s;
  std::size_t segments;
  double last_s = 0.0;
  PressureStages stages;
  Hysteresis pressures, tensions, angles;
  std::optional<JammingState> jamming;
  std::optional<TendonFrictionState> friction;
};

InputPath::InputPath(const Scenario& scenario, const Commands& start)
    : impl_(std::make_unique<Impl>(scenario, start)) {}
InputPath::~InputPath() = default;
InputPath::InputPath(InputPath&&) noexcept = default;
InputPath& InputPath::operator=(InputPath&&) noexcept = default;

bool InputPath::feels_bending() const {
  const LawSpec& laws = impl_->spec.laws;
  return impl_->friction || laws.gain_share_per_rad != 0.0 || laws.cables_through;
}

std::vector<Acting> InputPath::act(const Commands& commanded, double t_s, const std::vector<Bend>& bends) {
  return impl_->act(commanded, t_s, bends);
}

}  // namespace softarm::rig
