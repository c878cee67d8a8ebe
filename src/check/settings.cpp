#include "settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "math/statistics.h"
#include "policy.h"

namespace softarm::check {
namespace {

constexpr char kOfTheLayout[] = " (of the layout)";

/// Column of an input in the layout that the recording was imported by.
struct LayoutColumn {
  std::string path, unit;
  double scale_to_si = 1.0, zero = 0.0;
};

std::optional<LayoutColumn> column_of(const Context& context, const arm::ScalarInput& input) {
  if (!context.layout) return std::nullopt;
  for (const trial::CsvPressure& p : context.layout->pressures) {
    if (p.topic == input.topic)
      return LayoutColumn{fmt::format("pressures.inputs[{}]", p.topic), p.unit, p.scale_to_pa, p.zero};
  }
  for (const trial::CsvScalar& s : context.layout->scalars) {
    if (s.topic == input.topic)
      return LayoutColumn{
          fmt::format("{}.inputs[{}]", input.kind == arm::InputKind::kTension ? "tensions" : "angles",
                      s.topic),
          s.unit, s.scale_to_si, s.zero};
  }
  return std::nullopt;
}

/// The arm file's word for the unit of an input.
std::string arm_unit(const arm::ScalarInput& input) {
  struct Unit {
    const char* name;
    double si;
  };
  static const std::vector<Unit> kPressures{{"Pa", 1.0},  {"kPa", 1e3},    {"MPa", 1e6},
                                            {"bar", 1e5}, {"mbar", 100.0}, {"psi", 6894.757293168}},
      kTensions{{"N", 1.0}, {"mN", 1e-3}, {"kgf", 9.80665}, {"gf", 9.80665e-3}},
      kAngles{{"rad", 1.0}, {"deg", M_PI / 180.0}};
  const std::vector<Unit>& units = input.kind == arm::InputKind::kTension ? kTensions
                                   : input.kind == arm::InputKind::kAngle ? kAngles
                                                                          : kPressures;
  for (const Unit& unit : units) {
    if (std::abs(unit.si - input.scale_to_si) < 1e-9 * unit.si) return unit.name;
  }
  return "counts";
}

}  // namespace

std::string path_of(const arm::ScalarInput& input) {
  const char* list = input.kind == arm::InputKind::kTension ? "tensions"
                     : input.kind == arm::InputKind::kAngle ? "angles"
                                                            : "pressures";
  return fmt::format("inputs.{}[{}]", list, input.name);
}

std::string pose_value(const Eigen::Isometry3d& pose) {
  const Eigen::Vector3d p = pose.translation();
  const Eigen::Quaterniond q = Eigen::Quaterniond(pose.linear()).normalized();
  return fmt::format(
      "{{position_m: [{:.5f}, {:.5f}, {:.5f}], quaternion_xyzw: [{:.5f}, {:.5f}, {:.5f}, {:.5f}]}}", p.x(),
      p.y(), p.z(), q.x(), q.y(), q.z(), q.w());
}

std::string joined(const std::vector<std::string>& settings) {
  std::string text;
  for (const std::string& setting : settings) {
    if (!setting.empty()) text += (text.empty() ? "" : "; ") + setting;
  }
  return text;
}

std::string position_sd_setting(const Track& track, double sd_m) {
  if (track.is_base() || sd_m > kPolicy.noise.most_sd_m) return "";
  return fmt::format("bodies[{}].position_sd_m: {:.2g}", track.name, sd_m);
}

std::string without_orientation(const Context& context, const Track& track) {
  if (track.is_base() || !track.body->orientation_usable) return "";
  if (!track.body->section_in_body.translation().isZero()) return "";  // its position needs it, too
  if (context.arm.estimator.method == arm::Method::kEndOrientation) return "";
  return "bodies[" + track.name + "].orientation_usable: false";
}

std::string fixed_base(const Context& context) {
  const Track& base = context.tracks[0];
  const auto p = base.mean_position(0.0, context.duration_s);
  const auto q = base.mean_orientation(0.0, context.duration_s);
  if (!p || !q) return "";
  if (context.layout) {
    // In the recording's axes, which the import has turned where y is up.
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitX()));
    const Eigen::Quaterniond recorded = context.layout->up == trial::UpAxis::kY ? turn.conjugate() * *q : *q;
    return fmt::format("mocap.bodies[{}].fixed_orientation: [{:.5f}, {:.5f}, {:.5f}, {:.5f}]{}", base.name,
                       recorded.x(), recorded.y(), recorded.z(), recorded.w(), kOfTheLayout);
  }
  Eigen::Isometry3d body = Eigen::Isometry3d::Identity();
  body.translation() = *p;
  body.linear() = q->toRotationMatrix();
  return "base: {fixed: " + pose_value(body * context.arm.base.rod_in_body) + "}";
}

ZeroAtRest zero_of(const Context& context, const Signal& signal) {
  const arm::ScalarInput& input = *signal.input;
  ZeroAtRest zero;
  zero.input = input.name;
  zero.unit_si = signal.is_pressure() ? "Pa" : input.kind == arm::InputKind::kTension ? "N" : "rad";
  zero.path = path_of(input) + ".zero";
  zero.si_per_unit = input.scale_to_si;
  zero.zero = input.zero_si / input.scale_to_si;
  zero.unit = arm_unit(input);
  if (const auto column = column_of(context, input)) {
    zero.path = column->path + ".zero";
    zero.of_layout = true;
    zero.si_per_unit = column->scale_to_si;
    zero.zero = column->zero;
    zero.unit = column->unit;
  }
  if (input.kind == arm::InputKind::kVacuum) zero.si_per_unit *= -1.0;
  return zero;
}

std::string zero_setting(const ZeroAtRest& zero, double level) {
  return fmt::format("{}: {:.4g}{}", zero.path, zero.zero + level / zero.si_per_unit,
                     zero.of_layout ? kOfTheLayout : "");
}

std::string in_unit(const ZeroAtRest& zero, double level) {
  return fmt::format("{:.3g} {}", level / zero.si_per_unit, zero.unit);
}

std::string clock_setting(const Context& context, double ahead_s) {
  // A layout shifts the poses, whichever clock is ahead. Live, a frame waits for no input that comes much
  // later.
  if (context.layout && std::abs(ahead_s) > kPolicy.clocks.most_shift_s) {
    return fmt::format("mocap.ahead_s: {:.3f}{}", context.layout->bodies_ahead_s + ahead_s, kOfTheLayout);
  }
  const double latency_s = context.arm.inputs.body_latency_s + ahead_s;
  if (ahead_s < -kPolicy.clocks.most_shift_s || std::abs(latency_s) > kPolicy.receipt.most_latency_s)
    return "";
  return fmt::format("inputs.bodies.latency_s: {:.3f}", latency_s);
}

}  // namespace softarm::check
