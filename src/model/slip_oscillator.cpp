#include "slip_oscillator.h"

#include <algorithm>
#include <cmath>

#include "vibration.h"

namespace softarm::model {
namespace {

constexpr double kShareOfRadian = 0.4;  // of a swing, in one step
constexpr int kHalvings = 60;           // of a step: to rounding

/// The first instant at which `is_past` is true, by halving; it is at the end.
template <typename IsPast>
double first_instant(double end_s, const IsPast& is_past) {
  double low = 0.0, high = end_s;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (is_past(middle) ? high : low) = middle;
  }
  return high;
}

}  // namespace

SlipOscillator::SlipOscillator(const Constants& constants)
    : c_(constants), longest_s_(kShareOfRadian / std::sqrt(constants.stiffness + constants.slip_stiffness)) {}

double SlipOscillator::stretched(double z, double moved) const {
  return std::clamp(z + moved, -c_.slip, c_.slip);
}

bool SlipOscillator::slips(const State& at) const {
  if (!(std::abs(at.z) >= c_.slip)) return false;
  const double pull = -c_.stiffness * at.x - c_.slip_stiffness * at.z;
  const double way = at.rate != 0.0 ? at.rate : pull;
  return way * at.z > 0.0;
}

SlipOscillator::State SlipOscillator::on(const State& at, bool slipping, double dt_s) const {
  const double stiffness = c_.stiffness + (slipping ? 0.0 : c_.slip_stiffness),
               rest = -c_.slip_stiffness * (slipping ? at.z : at.z - at.x) / stiffness;
  const Oscillator::State there = Oscillator(stiffness, c_.damping, dt_s).step({at.x, at.rate}, rest, rest);
  return {there.x, there.rate, slipping ? at.z : at.z + there.x - at.x};
}

SlipOscillator::State SlipOscillator::piece(const State& at, double& dt_s) const {
  const bool slipping = slips(at);
  double end_s = dt_s;
  State there = on(at, slipping, end_s);
  const bool turns = at.rate * there.rate < 0.0;
  if (turns) {
    end_s = first_instant(end_s, [&](double t_s) { return at.rate * on(at, slipping, t_s).rate <= 0.0; });
    there = on(at, slipping, end_s);
    there.rate = 0.0;
  }
  // Up to a turn the spring is stretched ever further to one side.
  if (!slipping && std::abs(there.z) > c_.slip) {
    end_s = first_instant(end_s, [&](double t_s) { return std::abs(on(at, false, t_s).z) > c_.slip; });
    there = on(at, false, end_s);
    there.z = std::copysign(c_.slip, there.z);
  }
  dt_s -= end_s;
  return there;
}

SlipOscillator::State SlipOscillator::step(State at, double dt_s) const {
  if (c_.slip_stiffness == 0.0 || c_.slip == 0.0) {
    const Oscillator::State there =
        Oscillator(c_.stiffness, c_.damping, dt_s).step({at.x, at.rate}, 0.0, 0.0);
    return {there.x, there.rate, stretched(at.z, there.x - at.x)};
  }
  while (dt_s > 0.0) {
    double now_s = std::min(dt_s, longest_s_);
    const double was_s = now_s;
    at = piece(at, now_s);
    dt_s -= was_s - now_s;
  }
  return at;
}

}  // namespace softarm::model
