// What the trials vary, and what they lack.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "advice.h"

namespace softarm::identify {
namespace {

constexpr double kLoadThatTells = 0.3;      // change of the payload's weight over the arm's own
constexpr double kAttitudeThatTells = 0.3;  // rad

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

const arm::Segment& Conditions::segment_of(const ConstantRef& constant) const {
  return arm_.segments[static_cast<std::size_t>(constant.segment)];
}

std::string Conditions::input_of(const ConstantRef& constant) const {
  const arm::ConstantSpec& spec = arm::spec_of(constant.kind);
  return spec.input == nullptr ? "" : spec.input(segment_of(constant), constant.index);
}

std::string Conditions::input_words(const ConstantRef& constant) const {
  return arm::input_words(segment_of(constant), arm::spec_of(constant.kind).item, input_of(constant),
                          constant.index);
}

bool Conditions::one_number(const ConstantRef& a, const ConstantRef& b) const {
  if (a.segment != b.segment) return false;
  for (const auto& [own, common] :
       {std::pair(ConstantKind::kChamberSaturation, ConstantKind::kChambersSaturation),
        std::pair(ConstantKind::kTendonSaturation, ConstantKind::kTendonsSaturation),
        std::pair(ConstantKind::kCableSaturation, ConstantKind::kCablesSaturation)}) {
    const bool pair = (a.kind == own && b.kind == common) || (a.kind == common && b.kind == own);
    if (pair && arm::spec_of(own).count(segment_of(a)) == 1) return true;
  }
  return false;
}

std::string Conditions::advice_of_pair(const ConstantRef& a, const ConstantRef& b) const {
  if (one_number(a, b)) {
    const ConstantRef& own = arm::spec_of(a.kind).input == nullptr ? b : a;
    const ConstantRef& common = arm::spec_of(a.kind).input == nullptr ? a : b;
    return fmt::format(
        "{} has a single {}, whose own saturation and that of all together are one number: fit one, "
        "--hold {}",
        segment_of(a).name, arm::spec_of(own.kind).item, name_of(arm_, common));
  }
  return fmt::format("inputs {} and {} always stand in the same ratio: record trials with each of them alone",
                     input_words(a), input_words(b));
}

double Conditions::reference_scale(const ConstantRef& constant) const {
  return arm::spec_of(constant.kind).scale(segment_of(constant), constant.index, *this);
}

bool Conditions::driven_alike(const ConstantRef& a, const ConstantRef& b) const {
  if (one_number(a, b)) return true;
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

bool Conditions::load_varies() const {
  double least = 1e300, most = 0.0, turn = 0.0, own_kg = arm_.tip_mass_kg;
  for (const arm::Segment& segment : arm_.segments) own_kg += segment.mass_per_length_kg_m * segment.length_m;
  for (const trial::StaticFrame& frame : frames_) {
    least = std::min(least, frame.payload_kg);
    most = std::max(most, frame.payload_kg);
    const Eigen::Vector3d& first = frames_.front().gravity_base;
    turn = std::max(turn, std::atan2(first.cross(frame.gravity_base).norm(), first.dot(frame.gravity_base)));
  }
  return most - least > kLoadThatTells * std::max(1e-3, own_kg) || turn >= kAttitudeThatTells;
}

std::string Conditions::load_advice() const {
  if (!load_varies()) {
    return "the load hardly changes, and without load only moment over stiffness shows: record trials with "
           "and without a known payload, or with the base at another attitude";
  }
  return "the payload bends the arm too little: record trials with a heavier one and with more bending";
}

std::string Conditions::advice(const ConstantRef& constant) const {
  const std::string input = input_of(constant);
  if (!input.empty() && !(largest(input) > 0.0))
    return fmt::format("input {} is never on: record trials that use it", input_words(constant));
  return arm::spec_of(constant.kind).advice(segment_of(constant), constant.index, *this);
}

}  // namespace softarm::identify
