#include "softarm/arm/constants.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "actuators/actuator.h"
#include "constant_spec.h"

namespace softarm::arm {
namespace {

template <typename List>
auto& at(List& list, int i) {
  return list[static_cast<std::size_t>(i)];
}

/// All there are, in the order of ConstantKind.
std::vector<const ConstantSpec*> all_specs() {
  std::vector<const ConstantSpec*> all;
  const auto add = [&](const std::vector<ConstantSpec>& list) {
    for (const ConstantSpec& spec : list) all.push_back(&spec);
  };
  for (const ActuatorKind* kind : actuator_kinds()) add(kind->constants());
  add(segment_constants());
  std::sort(all.begin(), all.end(),
            [](const ConstantSpec* a, const ConstantSpec* b) { return a->kind < b->kind; });
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (static_cast<std::size_t>(all[i]->kind) != i)
      throw std::logic_error("each ConstantKind is described once");
  }
  return all;
}

const std::vector<const ConstantSpec*>& specs() {
  static const std::vector<const ConstantSpec*> list = all_specs();
  return list;
}

bool is_free_by_default(const ConstantSpec& spec, const Segment& segment, int index) {
  return spec.free_by_default(segment) && spec.stated(segment, index);
}

void set_length(Arm& arm, int segment, double length_m) {
  double begin = 0.0;
  for (int i = 0; i < segment; ++i) begin += at(arm.segments, i).length_m;
  Segment& changed = at(arm.segments, segment);
  const double before = changed.length_m;
  const double end = begin + before;
  const auto carry = [&](double& s) {
    if (s >= end) {
      s += length_m - before;
    } else if (s > begin) {
      s = begin + (s - begin) / before * length_m;
    }
  };
  for (MeasuredBody& body : arm.bodies) carry(body.arclength_m);
  carry(arm.payload.arclength_m);
  changed.mass_per_length_kg_m *= before / length_m;
  changed.length_m = length_m;
}

}  // namespace

double RecordedInputs::largest(const std::string& input) const {
  double result = 0.0;
  for (const double value : values(input)) result = std::max(result, std::abs(value));
  return result;
}

double RecordedInputs::range(const std::string& input) const {
  const std::vector<double> list = values(input);
  if (list.empty()) return 0.0;
  const auto [low, high] = std::minmax_element(list.begin(), list.end());
  return *high - *low;
}

double largest_or(const RecordedInputs& recorded, const std::string& input, double usual) {
  const double most = recorded.largest(input);
  return most > 0.0 ? most : usual;
}

std::string input_words(const Segment& segment, const char* item, const std::string& input, int index) {
  return fmt::format("'{}' ({} {} of {})", input, item, index + 1, segment.name);
}

const ConstantSpec& spec_of(ConstantKind kind) {
  return *specs().at(static_cast<std::size_t>(kind));
}

std::vector<int> segments_of(const ConstantRef& constant) {
  std::vector<int> segments{constant.segment};
  segments.insert(segments.end(), constant.tied.begin(), constant.tied.end());
  return segments;
}

std::string name_of(const Arm& arm, const ConstantRef& constant) {
  std::string name = at(arm.segments, constant.segment).name;
  for (const int other : constant.tied) name += "=" + at(arm.segments, other).name;
  std::string what = spec_of(constant.kind).name;
  const std::size_t number = what.find("{}");
  if (number != std::string::npos) what.replace(number, 2, std::to_string(constant.index + 1));
  return name + "." + what;
}

std::string unit_of(ConstantKind kind) {
  return spec_of(kind).unit;
}

ConstantRole role_of(ConstantKind kind) {
  return spec_of(kind).role;
}

double value_of(const Arm& arm, const ConstantRef& constant) {
  return spec_of(constant.kind).value(at(arm.segments, constant.segment), constant.index);
}

void set_value(Arm& arm, const ConstantRef& constant, double value) {
  for (const int i : segments_of(constant)) {
    if (constant.kind == ConstantKind::kLength) {
      set_length(arm, i, value);
    } else {
      spec_of(constant.kind).set(at(arm.segments, i), constant.index, value);
    }
  }
}

Range allowed_range(const Arm& arm, const ConstantRef& constant) {
  Range all{std::numeric_limits<double>::lowest(), std::numeric_limits<double>::max()};
  for (const int i : segments_of(constant)) {
    const Range one = spec_of(constant.kind).allowed(at(arm.segments, i), constant.index);
    all = {std::max(all.low, one.low), std::min(all.high, one.high)};
  }
  return all;
}

bool is_stated(const Arm& arm, const ConstantRef& constant) {
  return spec_of(constant.kind).stated(at(arm.segments, constant.segment), constant.index);
}

std::vector<ConstantRef> default_free(const Arm& arm) {
  std::vector<ConstantRef> list;
  for (int i = 0; i < static_cast<int>(arm.segments.size()); ++i) {
    const Segment& segment = at(arm.segments, i);
    for (const ConstantSpec* spec : specs()) {
      for (int k = 0; k < spec->count(segment); ++k) {
        if (is_free_by_default(*spec, segment, k)) list.push_back({spec->kind, i, k});
      }
    }
  }
  return list;
}

std::vector<ConstantRef> constants_of(const Arm& arm) {
  std::vector<ConstantRef> list = default_free(arm);
  const auto add_others = [&](ConstantKind first, ConstantKind last) {
    for (int i = 0; i < static_cast<int>(arm.segments.size()); ++i) {
      const Segment& segment = at(arm.segments, i);
      for (const ConstantSpec* spec : specs()) {
        if (spec->kind < first || spec->kind > last) continue;
        for (int k = 0; k < spec->count(segment); ++k) {
          if (!is_free_by_default(*spec, segment, k)) list.push_back({spec->kind, i, k});
        }
      }
    }
  };
  add_others(ConstantKind::kMomentGain, ConstantKind::kAxialStiffness);
  add_others(ConstantKind::kLength, ConstantKind::kLength);
  add_others(ConstantKind::kRestCurvatureX, ConstantKind::kRestCurvatureY);
  return list;
}

}  // namespace softarm::arm
