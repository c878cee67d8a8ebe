// What the trials vary, and what they lack.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "advice.h"

namespace softarm::identify {
namespace {

constexpr double kUsualPressure_pa = 50e3;
constexpr double kElongationThatMatters = 0.02;  // of the length at the largest pressure
constexpr double kStiffnessThatMatters = 0.2;    // of EI at the largest pressure
constexpr double kLengthThatMatters = 0.04;      // of the length
constexpr double kBendThatMatters_rad = 0.1;     // over the length
constexpr double kLoadThatTells = 0.3;           // change of the payload's weight over the arm's own
constexpr double kAttitudeThatTells = 0.3;       // rad

}  // namespace

Conditions::Conditions(const arm::Arm& arm, const std::vector<trial::StaticFrame>& frames)
    : arm_(arm), frames_(frames) {}

std::vector<double> Conditions::values(const std::string& input) const {
  std::vector<double> list;
  for (std::size_t i = 0; i < arm_.inputs.scalars.size(); ++i) {
    if (arm_.inputs.scalars[i].name != input) continue;
    for (const trial::StaticFrame& frame : frames_) {
      list.push_back(i < frame.inputs.size() ? frame.inputs[i].value_or(0.0) : 0.0);
    }
  }
  return list;
}

double Conditions::largest(const std::string& input) const {
  double result = 0.0;
  for (const double value : values(input)) result = std::max(result, std::abs(value));
  return result;
}

double Conditions::range(const std::string& input) const {
  const std::vector<double> list = values(input);
  if (list.empty()) return 0.0;
  const auto [low, high] = std::minmax_element(list.begin(), list.end());
  return *high - *low;
}

double Conditions::largest_minimum(int segment) const {
  const auto& chambers = arm_.segments[static_cast<std::size_t>(segment)].chambers;
  std::vector<double> lowest;
  for (const arm::Chamber& chamber : chambers) {
    const std::vector<double> one = values(chamber.input);
    if (lowest.empty()) lowest = one;
    for (std::size_t i = 0; i < one.size(); ++i) lowest[i] = std::min(lowest[i], one[i]);
  }
  return lowest.empty() ? 0.0 : std::max(0.0, *std::max_element(lowest.begin(), lowest.end()));
}

double Conditions::largest_jamming(int segment) const {
  const arm::Segment& at = arm_.segments[static_cast<std::size_t>(segment)];
  double result = at.jamming_input ? largest(*at.jamming_input) : 0.0;
  for (const arm::Chamber& chamber : at.chambers)
    result += largest(chamber.input) / static_cast<double>(at.chambers.size());
  return result;
}

bool Conditions::vacuum_seen(int segment) const {
  const arm::Segment& at = arm_.segments[static_cast<std::size_t>(segment)];
  if (!at.jamming_input) return false;
  for (std::size_t i = 0; i < arm_.inputs.scalars.size(); ++i) {
    if (arm_.inputs.scalars[i].name != *at.jamming_input) continue;
    for (const trial::StaticFrame& frame : frames_) {
      if (i < frame.inputs.size() && frame.inputs[i]) return true;
    }
  }
  return false;
}

std::string Conditions::input_of(const ConstantRef& constant) const {
  const arm::Segment& segment = arm_.segments[static_cast<std::size_t>(constant.segment)];
  const auto i = static_cast<std::size_t>(constant.index);
  switch (constant.kind) {
    case ConstantKind::kMomentGain:
    case ConstantKind::kElongation:
      return segment.chambers[i].input;
    case ConstantKind::kTendonOffset:
      return segment.tendons[i].input;
    case ConstantKind::kCableGain:
      return segment.cables[i].input;
    default:
      return "";
  }
}

std::string Conditions::input_words(const ConstantRef& constant) const {
  const char* const what = constant.kind == ConstantKind::kTendonOffset ? "tendon"
                           : constant.kind == ConstantKind::kCableGain  ? "cable"
                                                                        : "chamber";
  const std::string& segment = arm_.segments[static_cast<std::size_t>(constant.segment)].name;
  return fmt::format("'{}' ({} {} of {})", input_of(constant), what, constant.index + 1, segment);
}

std::string Conditions::advice_of_pair(const ConstantRef& a, const ConstantRef& b) const {
  return fmt::format("inputs {} and {} always stand in the same ratio: record trials with each of them alone",
                     input_words(a), input_words(b));
}

double Conditions::reference_scale(const ConstantRef& constant) const {
  const arm::Segment& segment = arm_.segments[static_cast<std::size_t>(constant.segment)];
  const double ei = segment.bending_stiffness.by_pressure.empty()
                        ? segment.bending_stiffness.base_nm2
                        : segment.bending_stiffness.by_pressure.front().bending_stiffness_nm2;
  const std::string input = input_of(constant);
  const double most = input.empty() ? 0.0 : largest(input);
  switch (constant.kind) {
    case ConstantKind::kMomentGain:
      return kBendThatMatters_rad * ei / segment.length_m / (most > 0.0 ? most : kUsualPressure_pa);
    case ConstantKind::kElongation:
      return kElongationThatMatters * segment.length_m / (most > 0.0 ? most : kUsualPressure_pa);
    case ConstantKind::kPerMinPressure: {
      const double lowest = largest_minimum(constant.segment);
      return kStiffnessThatMatters * ei / (lowest > 0.0 ? lowest : kUsualPressure_pa);
    }
    case ConstantKind::kPerJammingPressure: {
      const double jamming = largest_jamming(constant.segment);
      return kStiffnessThatMatters * ei / (jamming > 0.0 ? jamming : kUsualPressure_pa);
    }
    case ConstantKind::kBendingStiffness:
    case ConstantKind::kByPressure:
      return 0.1 * ei;
    case ConstantKind::kTendonOffset:
      return kBendThatMatters_rad * ei / segment.length_m / (most > 0.0 ? most : 1.0);
    case ConstantKind::kCableGain:
      return kBendThatMatters_rad / segment.length_m / (most > 0.0 ? most : 1.0);
    case ConstantKind::kAxialStiffness:
      return 0.1 * segment.axial_stiffness_n.value_or(1.0);
    case ConstantKind::kLength:
      return kLengthThatMatters * segment.length_m;
    case ConstantKind::kRestCurvatureX:
    case ConstantKind::kRestCurvatureY:
      return kBendThatMatters_rad / segment.length_m;
  }
  return 1.0;
}

bool Conditions::driven_alike(const ConstantRef& a, const ConstantRef& b) const {
  const std::string first = input_of(a), second = input_of(b);
  if (first.empty() || second.empty() || first == second) return false;
  const std::vector<double> x = values(first), y = values(second);
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (std::size_t i = 0; i < x.size() && i < y.size(); ++i) {
    xx += x[i] * x[i];
    xy += x[i] * y[i];
    yy += y[i] * y[i];
  }
  return xx > 0.0 && yy > 0.0 && xy * xy > 0.999 * xx * yy;
}

std::string Conditions::load_advice() const {
  double least = 1e300, most = 0.0, turn = 0.0, own_kg = arm_.tip_mass_kg;
  for (const arm::Segment& segment : arm_.segments) own_kg += segment.mass_per_length_kg_m * segment.length_m;
  for (const trial::StaticFrame& frame : frames_) {
    least = std::min(least, frame.payload_kg);
    most = std::max(most, frame.payload_kg);
    const Eigen::Vector3d& first = frames_.front().gravity_base;
    turn = std::max(turn, std::atan2(first.cross(frame.gravity_base).norm(), first.dot(frame.gravity_base)));
  }
  const bool load_varies = most - least > kLoadThatTells * std::max(1e-3, own_kg);
  if (!load_varies && turn < kAttitudeThatTells) {
    return "the load hardly changes, and without load only moment over stiffness shows: record trials with "
           "and without a known payload, or with the base at another attitude";
  }
  return "the payload bends the arm too little: record trials with a heavier one and with more bending";
}

std::string Conditions::advice(const ConstantRef& constant) const {
  const arm::Segment& segment = arm_.segments[static_cast<std::size_t>(constant.segment)];
  const std::string input = input_of(constant);
  if (!input.empty() && !(largest(input) > 0.0))
    return fmt::format("input {} is never on: record trials that use it", input_words(constant));
  switch (constant.kind) {
    case ConstantKind::kMomentGain:
    case ConstantKind::kTendonOffset:
    case ConstantKind::kBendingStiffness:
      return load_advice();
    case ConstantKind::kCableGain:
      return fmt::format("input {} moves the arm too little: record trials with larger angles",
                         input_words(constant));
    case ConstantKind::kElongation:
      return fmt::format(
          "the length hardly answers to {}: record trials with it at higher pressure, and others at rest",
          input_words(constant));
    case ConstantKind::kPerMinPressure: {
      if (!(largest_minimum(constant.segment) > 0.0))
        return fmt::format(
            "at no time are all chambers of {} inflated: record trials with all of them "
            "pressurised, with and without a payload",
            segment.name);
      return "record trials with all chambers at high pressure and with a payload beside such with one "
             "chamber off; " +
             load_advice();
    }
    case ConstantKind::kPerJammingPressure:
      if (!segment.jamming_input || !(range(*segment.jamming_input) > 0.0))
        return "the vacuum does not change: record trials with the vacuum on and others with it off";
      return "record trials with the vacuum on and off, with a payload; " + load_advice();
    case ConstantKind::kByPressure: {
      const auto& knots = segment.bending_stiffness.by_pressure;
      const double at_pa = knots[static_cast<std::size_t>(constant.index)].pressure_pa;
      double nearest = 1e300;
      if (segment.central_chamber) {
        for (const double value : values(segment.central_chamber->input))
          nearest = std::min(nearest, std::abs(value - at_pa));
      }
      if (nearest > 0.25 * (knots.back().pressure_pa - knots.front().pressure_pa) /
                        std::max(1.0, static_cast<double>(knots.size() - 1)))
        return fmt::format("no trial is near that pressure: record some at {:g} kPa", at_pa * 1e-3);
      return load_advice();
    }
    case ConstantKind::kAxialStiffness:
      return "the arm is strained too little along its axis: record trials with higher central pressure or "
             "tension, or a heavier payload";
    case ConstantKind::kLength:
    case ConstantKind::kRestCurvatureX:
    case ConstantKind::kRestCurvatureY:
      return "record the arm at rest, without any input";
  }
  return "";
}

}  // namespace softarm::identify
