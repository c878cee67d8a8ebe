#include "learned_moment.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "arm/input_kind.h"
#include "drives.h"
#include "softarm/arm/laws.h"

namespace softarm::effects {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kLearnedSize = 4;  // numbers remembered of a piece, or of the input
constexpr double kLeastTime_s = 1e-2;
// Of what fits leave as it was given.
constexpr double kUnlimited = std::numeric_limits<double>::infinity();

double input_of(const Instant& instant, double number) {
  const auto row = static_cast<Eigen::Index>(std::lround(number)) - 1;
  return row >= 0 && row < instant.inputs.size() ? instant.inputs[row] : 0.0;
}

/// Moments of the actuation as the arm's laws have them, by segment.
std::vector<Vector2d> drive_moments(const Arm& arm, const Instant& instant) {
  std::vector<Vector2d> list(arm.segments.size(), Vector2d::Zero());
  const auto laws = arm::predict(
      arm, arm::InputValues(instant.inputs.data(), instant.inputs.data() + instant.inputs.size()));
  for (std::size_t i = 0; laws && i < list.size(); ++i) list[i] = (*laws)[i].moment_nm;
  return list;
}

/// What a first-order follower is at now: state = (last, follower).
Vector2d follower(const double* state, const Vector2d& now, double dt_s, double time_s) {
  const Following f = following(dt_s, std::max(time_s, kLeastTime_s));
  return f.kept * Vector2d(state[2], state[3]) + f.weight_last * Vector2d(state[0], state[1]) +
         f.weight_now * now;
}

/// Bent towards x is turned about y: (x, y) of a moment's direction of bending, from its axes.
Vector2d towards(const Vector2d& about) {
  return {about.y(), -about.x()};
}

/// What a follower or a play of the arm's input, moment or curvature follows.
Vector2d followed(const Arm& arm, const FineRod& fine, const Values& values, const Instant& instant,
                  std::size_t piece) {
  if (LearnedMoment::of(values) == Regressor::kDriveLag)
    return drive_moments(arm, instant)[static_cast<std::size_t>(fine.pieces()[piece].segment)];
  return {input_of(instant, values[LearnedMoment::kFirst]), 0.0};
}

double play(double held, double now, double width) {
  return std::clamp(held, now - 0.5 * width, now + 0.5 * width);
}

}  // namespace

Regressor LearnedMoment::of(const Values& values) {
  return static_cast<Regressor>(std::clamp(static_cast<int>(std::lround(values[kOf])), 0, 8));
}

bool LearnedMoment::is_vector(Regressor of) {
  return of >= Regressor::kAttitude;
}

std::string LearnedMoment::unit_of(const Arm& arm, const Values& values) {
  const auto unit = [&](Index which) -> std::string {
    const auto row = static_cast<std::size_t>(std::max<long>(0, std::lround(values[which]) - 1));
    if (row >= arm.inputs.scalars.size()) return "1";
    return arm::unit_of(arm.inputs.scalars[row].kind);
  };
  switch (of(values)) {
    case Regressor::kProduct:
      return unit(kFirst) == unit(kSecond) ? unit(kFirst) + "^2" : unit(kFirst) + " " + unit(kSecond);
    case Regressor::kPayload:
      return "kg";
    case Regressor::kAttitude:
      return "m/s^2";
    case Regressor::kDriveLag:
      return "N m";
    case Regressor::kCurvatureLag:
    case Regressor::kCurvature:
      return "1/m";
    default:
      return unit(kFirst);
  }
}

Vector2d LearnedMoment::regressor(const Arm& arm, const FineRod& fine, const Values& values,
                                  const Instant& instant, const Memory& memory, std::size_t piece) const {
  switch (of(values)) {
    case Regressor::kInput:
      return {input_of(instant, values[kFirst]), 0.0};
    case Regressor::kProduct:
      return {input_of(instant, values[kFirst]) * input_of(instant, values[kSecond]), 0.0};
    case Regressor::kPayload:
      return {instant.payload_kg, 0.0};
    case Regressor::kAttitude:
      return instant.gravity_base.head<2>();
    default:
      break;
  }
  if (memory.empty()) return Vector2d::Zero();
  const bool per_piece = is_vector(of(values));
  const double* state = &memory[per_piece ? piece * kLearnedSize : 0];
  if (of(values) == Regressor::kCurvature) return {state[0], state[1]};
  // The arm's shape is only known when an instant is over: its curvature is that of the instant before.
  if (of(values) == Regressor::kCurvatureLag) return {state[0] - state[2], state[1] - state[3]};
  const Vector2d now = followed(arm, fine, values, instant, piece);
  if (of(values) == Regressor::kPlay) return {now.x() - play(state[2], now.x(), values[kScale]), 0.0};
  return instant.dt_s > 0.0 ? Vector2d(now - follower(state, now, instant.dt_s, values[kScale]))
                            : Vector2d(Vector2d::Zero());
}

Vector2d LearnedMoment::bounded(const Values& values, const Vector2d& z) {
  const double from = values[kFrom], to = values[kTo], width = std::max(to - from, 1e-300);
  const double at = is_vector(of(values)) ? z.norm() : z.x();
  const double beyond =
      (is_vector(of(values)) ? std::max(0.0, at - to) : std::max({0.0, at - to, from - at}));
  const double far = 2.0 * beyond / width;
  return far > 30.0 ? Vector2d(Vector2d::Zero()) : Vector2d(z * std::exp(-far * far));
}

void LearnedMoment::act(const Arm& arm, const FineRod& fine, const Values& values, const Instant& instant,
                        const Shape*, const Memory& memory, rod::Rod& rod) const {
  const double most = std::max(std::abs(values[kFrom]), std::abs(values[kTo]));
  if ((values[kX] == 0.0 && values[kY] == 0.0) || !(most > 0.0)) return;
  const bool rising = std::lround(values[kRising]) == 1;
  for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
    const Vector2d z = bounded(values, regressor(arm, fine, values, instant, memory, j)) / most;
    // Scalars: z times (x, y); with a direction: along it and across.
    const Vector2d m(values[kX] * z.x() - values[kY] * z.y(), values[kY] * z.x() + values[kX] * z.y());
    const double share = rising ? 2.0 * fine.pieces()[j].middle_m() / fine.length_m() - 1.0 : 1.0;
    rod.segments[j].moment_nm += share * Eigen::Vector3d(-m.y(), m.x(), 0.0);
  }
}

void LearnedMoment::remember(const Arm& arm, const FineRod& fine, const Values& values,
                             const Instant& instant, const Shape& shape, Memory& memory) const {
  const Regressor kind = of(values);
  if (kind == Regressor::kInput || kind == Regressor::kProduct || kind == Regressor::kPayload ||
      kind == Regressor::kAttitude)
    return;
  const bool begins = memory.empty() || instant.dt_s <= 0.0, per_piece = is_vector(kind);
  const bool bends = kind == Regressor::kCurvature || kind == Regressor::kCurvatureLag;
  const std::size_t count = per_piece ? fine.pieces().size() : 1;
  memory.resize(count * kLearnedSize, 0.0);
  for (std::size_t j = 0; j < count; ++j) {
    double* state = &memory[j * kLearnedSize];
    const Vector2d now =
        bends ? towards(shape.middles[j].u.head<2>()) : followed(arm, fine, values, instant, j);
    Vector2d held = now;
    if (!begins && kind == Regressor::kPlay)
      held.x() = play(state[2], now.x(), values[kScale]);
    else if (!begins && kind != Regressor::kCurvature)
      held = follower(state, now, instant.dt_s, values[kScale]);
    state[0] = now.x();
    state[1] = now.y();
    state[2] = held.x();
    state[3] = held.y();
  }
}

const LearnedMoment& learned_moment() {
  const auto given = [](const char* symbol, const char* description, double low, double high, double usual,
                        bool number = true) {
    return Parameter{symbol, "1", description, low, high, usual, number};
  };
  static const auto effect = [&] {
    auto made = std::make_unique<LearnedMoment>(Info{
        "learned_moment",
        "a moment that was learnt from what nothing in the catalogue explains",
        "M = (x, y) b(z) / z_max, z what it goes with, bounded to the range it was learnt on",
        "stability selection: N. Meinshausen, P. Buhlmann, J. R. Stat. Soc. B 72, 2010, "
        "doi:10.1111/j.1467-9868.2010.00740.x",
        Family::kConstitutive,
        {{"x_nm", "N m", "towards x, or along what has a direction, at the range's end", -10.0, 10.0, 2e-3},
         {"y_nm", "N m", "towards y, or across what has a direction, at the range's end", -10.0, 10.0, 2e-3},
         given("of",
               "what it goes with (0: input, 1: product of two, 2: how far a play lags behind an input, 3: "
               "an input minus its first-order lag, 4: payload, 5: gravity across the base, 6: the "
               "actuation's moment minus its lag, 7: the curvature minus its lag, 8: the curvature)",
               0.0, 8.0, 0.0),
         given("input", "number of the input, from 1", 0.0, 64.0, 0.0),
         given("other_input", "number of the other one of a product", 0.0, 64.0, 0.0),
         given("scale", "width of the play in the input's unit, or time constant, s", 0.0, kUnlimited, 1.0,
               false),
         given("rising", "0: the same all along; 1: from -1 at the base to 1 at the tip", 0.0, 1.0, 0.0),
         given("from", "least of what it goes with, where it was learnt, SI", -kUnlimited, kUnlimited, 0.0,
               false),
         given("to", "largest of it, SI", -kUnlimited, kUnlimited, 0.0, false)},
        2,
        {},
        {"moment_gain", "bending_stiffness"}});
    made->set_rank(static_cast<int>(catalogue().size()));
    return made;
  }();
  return *effect;
}

}  // namespace softarm::effects
