#include "softarm/identify/constants.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fnmatch.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace softarm::identify {
namespace {

// What the format of an arm file allows, see config/arms/README.md.
constexpr arm::Range kMomentGain{0.0, 1e-3};
constexpr arm::Range kElongation{-1e-5, 1e-5};  // of the near one, which is changed
constexpr arm::Range kStiffness{1e-6, 1e3};
constexpr arm::Range kStiffnessGain{0.0, 1e-4};
constexpr arm::Range kTendonOffset{0.0, 0.5};
constexpr arm::Range kCableGain{0.0, 1e4};
constexpr arm::Range kAxialStiffness{0.1, 1e8};
constexpr arm::Range kRestCurvature{-200.0, 200.0};

template <typename List>
auto& at(List& list, int i) {
  return list[static_cast<std::size_t>(i)];
}

/// The number behind a constant that is a single one.
template <typename SegmentType>
auto* number_of(SegmentType& segment, const ConstantRef& constant) {
  auto& law = segment.bending_stiffness;
  switch (constant.kind) {
    case ConstantKind::kMomentGain:
      return &at(segment.chambers, constant.index).moment_gain_nm_per_pa;
    case ConstantKind::kElongation:
      return &at(segment.chambers, constant.index).near_elongation_m_per_pa;
    case ConstantKind::kPerMinPressure:
      return &law.per_min_pressure_nm2_per_pa;
    case ConstantKind::kPerJammingPressure:
      return &law.per_jamming_pressure_nm2_per_pa;
    case ConstantKind::kByPressure:
      return &at(law.by_pressure, constant.index).bending_stiffness_nm2;
    case ConstantKind::kTendonOffset:
      return &at(segment.tendons, constant.index).offset_m;
    case ConstantKind::kCableGain:
      return &at(segment.cables, constant.index).curvature_gain_per_m_rad;
    case ConstantKind::kAxialStiffness:
      return &*segment.axial_stiffness_n;
    case ConstantKind::kLength:
      return &segment.length_m;
    case ConstantKind::kRestCurvatureX:
      return &segment.rest_curvature_per_m[0];
    case ConstantKind::kRestCurvatureY:
      return &segment.rest_curvature_per_m[1];
    case ConstantKind::kBendingStiffness:
      break;
  }
  return &law.base_nm2;
}

void set_length(arm::Arm& arm, int segment, double length_m) {
  double begin = 0.0;
  for (int i = 0; i < segment; ++i) begin += at(arm.segments, i).length_m;
  arm::Segment& changed = at(arm.segments, segment);
  const double before = changed.length_m;
  const double end = begin + before;
  const auto carry = [&](double& s) {
    if (s >= end) {
      s += length_m - before;
    } else if (s > begin) {
      s = begin + (s - begin) / before * length_m;
    }
  };
  for (arm::MeasuredBody& body : arm.bodies) carry(body.arclength_m);
  carry(arm.payload.arclength_m);
  changed.mass_per_length_kg_m *= before / length_m;
  changed.length_m = length_m;
}

}  // namespace

std::string name_of(const arm::Arm& arm, const ConstantRef& constant) {
  std::string segment = at(arm.segments, constant.segment).name;
  for (const int other : constant.tied) segment += "=" + at(arm.segments, other).name;
  const int number = constant.index + 1;
  switch (constant.kind) {
    case ConstantKind::kMomentGain:
      return fmt::format("{}.chamber_{}.moment_gain", segment, number);
    case ConstantKind::kElongation:
      return fmt::format("{}.chamber_{}.elongation", segment, number);
    case ConstantKind::kBendingStiffness:
      return segment + ".bending_stiffness.base";
    case ConstantKind::kPerMinPressure:
      return segment + ".bending_stiffness.per_min_pressure";
    case ConstantKind::kPerJammingPressure:
      return segment + ".bending_stiffness.per_jamming_pressure";
    case ConstantKind::kByPressure:
      return fmt::format("{}.bending_stiffness.by_pressure.{}", segment, number);
    case ConstantKind::kTendonOffset:
      return fmt::format("{}.tendon_{}.offset", segment, number);
    case ConstantKind::kCableGain:
      return fmt::format("{}.cable_{}.curvature_gain", segment, number);
    case ConstantKind::kAxialStiffness:
      return segment + ".axial_stiffness";
    case ConstantKind::kLength:
      return segment + ".length";
    case ConstantKind::kRestCurvatureX:
      return segment + ".rest_curvature.x";
    case ConstantKind::kRestCurvatureY:
      return segment + ".rest_curvature.y";
  }
  return segment;
}

std::vector<int> segments_of(const ConstantRef& constant) {
  std::vector<int> segments{constant.segment};
  segments.insert(segments.end(), constant.tied.begin(), constant.tied.end());
  return segments;
}

std::string unit_of(ConstantKind kind) {
  switch (kind) {
    case ConstantKind::kMomentGain:
      return "N m/Pa";
    case ConstantKind::kElongation:
      return "m/Pa";
    case ConstantKind::kBendingStiffness:
    case ConstantKind::kByPressure:
      return "N m^2";
    case ConstantKind::kPerMinPressure:
    case ConstantKind::kPerJammingPressure:
      return "N m^2/Pa";
    case ConstantKind::kTendonOffset:
    case ConstantKind::kLength:
      return "m";
    case ConstantKind::kCableGain:
      return "1/(m rad)";
    case ConstantKind::kAxialStiffness:
      return "N";
    case ConstantKind::kRestCurvatureX:
    case ConstantKind::kRestCurvatureY:
      return "1/m";
  }
  return "";
}

double value_of(const arm::Arm& arm, const ConstantRef& constant) {
  const arm::Segment& segment = at(arm.segments, constant.segment);
  const double value = *number_of(segment, constant);
  if (constant.kind != ConstantKind::kElongation) return value;
  return value + at(segment.chambers, constant.index).far_elongation_m_per_pa;
}

void set_value(arm::Arm& arm, const ConstantRef& constant, double value) {
  for (const int i : segments_of(constant)) {
    if (constant.kind == ConstantKind::kLength) {
      set_length(arm, i, value);
      continue;
    }
    arm::Segment& segment = at(arm.segments, i);
    const bool is_sum = constant.kind == ConstantKind::kElongation;
    *number_of(segment, constant) =
        value - (is_sum ? at(segment.chambers, constant.index).far_elongation_m_per_pa : 0.0);
  }
}

arm::Range allowed_range(const arm::Arm& arm, const ConstantRef& constant) {
  if (!constant.tied.empty()) {
    arm::Range all{std::numeric_limits<double>::lowest(), std::numeric_limits<double>::max()};
    for (const int i : segments_of(constant)) {
      const arm::Range one = allowed_range(arm, ConstantRef{constant.kind, i, constant.index});
      all = {std::max(all.low, one.low), std::min(all.high, one.high)};
    }
    return all;
  }
  const arm::Segment& segment = at(arm.segments, constant.segment);
  switch (constant.kind) {
    case ConstantKind::kMomentGain:
      return kMomentGain;
    case ConstantKind::kElongation: {
      const double far = at(segment.chambers, constant.index).far_elongation_m_per_pa;
      return {kElongation.low + far, kElongation.high + far};
    }
    case ConstantKind::kBendingStiffness:
      return {std::max(kStiffness.low, segment.bending_stiffness_range_nm2.low),
              std::min(kStiffness.high, segment.bending_stiffness_range_nm2.high)};
    case ConstantKind::kByPressure:
      return kStiffness;
    case ConstantKind::kPerMinPressure:
    case ConstantKind::kPerJammingPressure:
      return kStiffnessGain;
    case ConstantKind::kTendonOffset:
      return kTendonOffset;
    case ConstantKind::kCableGain:
      return kCableGain;
    case ConstantKind::kAxialStiffness:
      return kAxialStiffness;
    case ConstantKind::kLength:
      if (segment.length_range_m.high > segment.length_range_m.low) return segment.length_range_m;
      return {0.7 * segment.length_m, 1.5 * segment.length_m};
    case ConstantKind::kRestCurvatureX:
    case ConstantKind::kRestCurvatureY:
      return kRestCurvature;
  }
  return {};
}

bool strained_by_inputs(const arm::Segment& segment) {
  return segment.central_chamber || !segment.tendons.empty();
}

std::vector<ConstantRef> default_free(const arm::Arm& arm) {
  std::vector<ConstantRef> list;
  for (int i = 0; i < static_cast<int>(arm.segments.size()); ++i) {
    const arm::Segment& segment = at(arm.segments, i);
    const auto add_all = [&](ConstantKind kind, std::size_t count) {
      for (int k = 0; k < static_cast<int>(count); ++k) list.push_back({kind, i, k});
    };
    add_all(ConstantKind::kMomentGain, segment.chambers.size());
    add_all(ConstantKind::kElongation, segment.chambers.size());
    add_all(ConstantKind::kTendonOffset, segment.tendons.size());
    add_all(ConstantKind::kCableGain, segment.cables.size());
    const std::size_t knots = segment.bending_stiffness.by_pressure.size();
    add_all(ConstantKind::kBendingStiffness, knots == 0 ? 1 : 0);
    add_all(ConstantKind::kByPressure, knots);
    // With one or two chambers the lowest pressure is a law as well, (7) is of antagonists.
    add_all(ConstantKind::kPerMinPressure, segment.chambers.size() >= 2 ? 1 : 0);
    add_all(ConstantKind::kPerJammingPressure, segment.jamming_input && !segment.chambers.empty() ? 1 : 0);
    add_all(ConstantKind::kAxialStiffness, strained_by_inputs(segment) && segment.axial_stiffness_n ? 1 : 0);
  }
  return list;
}

std::vector<ConstantRef> constants_of(const arm::Arm& arm) {
  std::vector<ConstantRef> list = default_free(arm);
  for (int i = 0; i < static_cast<int>(arm.segments.size()); ++i) {
    const ConstantRef axial{ConstantKind::kAxialStiffness, i, 0};
    const bool listed = std::any_of(list.begin(), list.end(), [&](const ConstantRef& c) {
      return c.kind == axial.kind && c.segment == axial.segment;
    });
    if (at(arm.segments, i).axial_stiffness_n && !listed) list.push_back(axial);
  }
  for (int i = 0; i < static_cast<int>(arm.segments.size()); ++i)
    list.push_back({ConstantKind::kLength, i, 0});
  for (int i = 0; i < static_cast<int>(arm.segments.size()); ++i) {
    list.push_back({ConstantKind::kRestCurvatureX, i, 0});
    list.push_back({ConstantKind::kRestCurvatureY, i, 0});
  }
  return list;
}

std::vector<ConstantRef> matching(const arm::Arm& arm, const std::vector<std::string>& patterns) {
  const std::vector<ConstantRef> all = constants_of(arm);
  std::vector<bool> wanted(all.size(), false);
  for (const std::string& pattern : patterns) {
    const std::string whole = pattern.find('.') == std::string::npos ? "*." + pattern : pattern;
    bool any = false;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (fnmatch(whole.c_str(), name_of(arm, all[i]).c_str(), 0) != 0) continue;
      wanted[i] = any = true;
    }
    if (any) continue;
    std::vector<std::string> names;
    for (const ConstantRef& constant : all) names.push_back(name_of(arm, constant));
    throw std::invalid_argument(fmt::format("'{}' is no constant of the arm {}, which has {}", pattern,
                                            arm.name, fmt::join(names, ", ")));
  }
  std::vector<ConstantRef> list;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (wanted[i]) list.push_back(all[i]);
  }
  return list;
}

std::vector<ConstantRef> tie_constants(const arm::Arm& arm, const std::vector<ConstantRef>& list,
                                       const std::vector<std::string>& patterns) {
  std::vector<ConstantRef> result = list;
  for (const std::string& pattern : patterns) {
    bool any = false;
    const std::vector<ConstantRef> matches = matching(arm, {pattern});
    const auto find = [&](const ConstantRef& wanted) {
      return std::find_if(result.begin(), result.end(), [&](const ConstantRef& c) {
        return c.kind == wanted.kind && c.index == wanted.index && c.segment == wanted.segment;
      });
    };
    for (std::size_t i = 0; i < matches.size(); ++i) {
      if (find(matches[i]) == result.end()) continue;  // held, or tied already
      for (std::size_t j = i + 1; j < matches.size(); ++j) {
        const bool alike = matches[j].kind == matches[i].kind && matches[j].index == matches[i].index;
        if (!alike || find(matches[j]) == result.end()) continue;
        result.erase(find(matches[j]));
        find(matches[i])->tied.push_back(matches[j].segment);
        any = true;
      }
    }
    if (!any)
      throw std::invalid_argument(fmt::format(
          "'{}' ties nothing: it must match free constants of one kind in two segments or more", pattern));
  }
  return result;
}

}  // namespace softarm::identify
