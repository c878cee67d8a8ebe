// Cables wound up by servos: a curvature proportional to the servo's angle (cable paper (4), (5), (15)).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "actuator.h"
#include "arm/key_builders.h"
#include "arm/yaml_section.h"
#include "saturation.h"

namespace softarm::arm {
namespace {

struct CableLaw {
  using Item = Cable;
  static constexpr std::vector<Cable> Segment::*kItems = &Segment::cables;
  static constexpr std::optional<double> Cable::*kOwn = &Cable::saturation_per_rad;
  static constexpr std::optional<double> Saturation::*kCommon = &Saturation::cables_per_rad;
  static constexpr std::optional<double> Cable::*kOwnGrowth = &Cable::stiffness_gain_nm2_per_rad;
  static constexpr const char *kItem = "cable", *kInputs = "angles";
  static constexpr double kUsual = 1.0, kMost = 100.0, kMostGrowth = 100.0;
  static double size(double angle_rad) { return std::abs(angle_rad); }
  static double acting(double angle_rad) { return angle_rad; }
  static void bend(const Cable& one, double angle_rad, Drive& drive) {
    drive.curvature_per_m += one.curvature_gain_per_m_rad * angle_rad * towards(one.bending_direction_rad);
  }
};
using ByAngle = Growth<CableLaw, &StiffnessLaw::per_angle_nm2_per_rad, false>;
using ByMinAngle = MinGrowth<CableLaw, &StiffnessLaw::per_min_angle_nm2_per_rad>;
using ByCable = OwnGrowth<CableLaw>;

const Cable& cable(const Segment& segment, int i) {
  return segment.cables[static_cast<std::size_t>(i)];
}

const std::string& cable_input(const Segment& segment, int i) {
  return cable(segment, i).input;
}

ConstantSpec curvature_gain() {
  ConstantSpec c{ConstantKind::kCableGain,
                 ConstantRole::kOther,
                 "cable_{}.curvature_gain",
                 "1/(m rad)",
                 "cable",
                 cable_input};
  c.count = [](const Segment& s) { return static_cast<int>(s.cables.size()); };
  c.value = [](const Segment& s, int i) { return cable(s, i).curvature_gain_per_m_rad; };
  c.set = [](Segment& s, int i, double value) {
    s.cables[static_cast<std::size_t>(i)].curvature_gain_per_m_rad = value;
  };
  c.allowed = [](const Segment&, int) { return Range{0.0, 1e4}; };
  c.change = [](const Segment& s, int i, const InputReader& inputs, Change& change) {
    const Cable& one = cable(s, i);
    const std::optional<double> angle_rad = inputs(one.input), sum = sum_of_sizes<CableLaw>(s, inputs);
    if (!angle_rad || !sum) return false;
    change.drive.curvature_per_m =
        *angle_rad / divisor<CableLaw>(s, one, *angle_rad, *sum) * towards(one.bending_direction_rad);
    return true;
  };
  c.scale = [](const Segment& s, int i, const RecordedInputs& recorded) {
    return kBendThatMatters_rad / s.length_m / largest_or(recorded, cable_input(s, i), 1.0);
  };
  c.advice = [](const Segment& s, int i, const RecordedInputs&) {
    return fmt::format("input {} moves the arm too little: record trials with larger angles",
                       input_words(s, "cable", cable_input(s, i), i));
  };
  return c;
}

class Cables final : public ActuatorKind {
 public:
  Cables() : ActuatorKind({"cables", "cables", InputKind::kAngle, true, false}) {}
  int count(const Segment& segment) const override { return static_cast<int>(segment.cables.size()); }
  const std::string& input(const Segment& segment, int i) const override { return cable_input(segment, i); }
  bool stiffens(const Segment& segment) const override {
    return ByAngle::stiffens(segment) || ByMinAngle::stiffens(segment) || ByCable::stiffens(segment);
  }
  std::optional<double> bending_direction_rad(const Segment& segment, int i) const override {
    return cable(segment, i).bending_direction_rad;
  }
  /// On the skin: no arm file has its distance from the axis.
  std::optional<Eigen::Vector2d> place_m(const Segment& segment, int i) const override {
    return 0.5 * segment.diameter_m * towards(cable(segment, i).bending_direction_rad);
  }

  bool drive(const Segment& segment, const InputReader& inputs, Drive& drive) const override {
    const std::optional<double> sum_rad = sum_of_sizes<CableLaw>(segment, inputs);
    if (!sum_rad) return false;
    double lowest_rad = std::numeric_limits<double>::max();
    for (const Cable& one : segment.cables) {
      const double angle_rad = *inputs(one.input);
      CableLaw::bend(one, angle_rad / divisor<CableLaw>(segment, one, angle_rad, *sum_rad), drive);
      drive.added_stiffness_nm2 += ByCable::added_nm2(one, angle_rad);
      lowest_rad = std::min(lowest_rad, CableLaw::size(angle_rad));
    }
    drive.added_stiffness_nm2 += ByAngle::added_nm2(segment, *sum_rad);
    if (!segment.cables.empty()) drive.added_stiffness_nm2 += ByMinAngle::added_nm2(segment, lowest_rad);
    return true;
  }

  const std::vector<ConstantSpec>& constants() const override {
    static const std::vector<ConstantSpec> list{
        curvature_gain(),
        own_saturation<CableLaw>(ConstantKind::kCableSaturation, "cable_{}.saturation", "1/rad"),
        common_saturation<CableLaw>(ConstantKind::kCablesSaturation, "cables.saturation", "1/rad"),
        ByAngle::constant(ConstantKind::kPerAngle, "bending_stiffness.per_angle", "N m^2/rad"),
        ByMinAngle::constant(ConstantKind::kPerMinAngle, "bending_stiffness.per_min_angle", "N m^2/rad"),
        ByCable::constant(ConstantKind::kPerCable, "bending_stiffness.per_cable_{}", "N m^2/rad")};
    return list;
  }

  std::vector<yaml::KeySpec> segment_keys() const override {
    return {yaml::list("cables", yaml::kMostActuators, "[]", "cables wound up by servos"),
            yaml::number("cables_saturation_per_rad", "1/rad", yaml::kAbsent, 0, CableLaw::kMost,
                         "b: the curvatures by all cables are divided by 1 + b times the sum of their "
                         "angles' sizes, in addition to each one's saturation_per_rad")};
  }
  std::vector<yaml::KeySpec> stiffness_keys() const override {
    return {
        yaml::number(
            "per_angle_nm2_per_rad", "N m^2/rad", yaml::kAbsent, 0, CableLaw::kMostGrowth,
            "EI per rad of the sum of the servo angles' sizes (per rad of their mean: n times that)"),
        yaml::number("per_min_angle_nm2_per_rad", "N m^2/rad", yaml::kAbsent, 0, CableLaw::kMostGrowth,
                     "EI per rad of the smallest of those sizes (see also stiffness_gain_nm2_per_rad of a "
                     "cable)")};
  }
  std::vector<const yaml::KeyTable*> segment_tables() const override { return {&keys()}; }

  void read(const yaml::Section& section, const yaml::Section& stiffness, const Inputs& inputs,
            Segment& segment) const override {
    segment.saturation.cables_per_rad =
        number_with_items<CableLaw>(section, "cables_saturation_per_rad", section);
    segment.bending_stiffness.per_angle_nm2_per_rad =
        number_with_items<CableLaw>(stiffness, "per_angle_nm2_per_rad", section);
    segment.bending_stiffness.per_min_angle_nm2_per_rad =
        number_with_items<CableLaw>(stiffness, "per_min_angle_nm2_per_rad", section);
    for (const yaml::Section& item : section.list("cables", keys())) {
      Cable one;
      one.input = yaml::read_input(item, "input", inputs, InputKind::kAngle, "a cable");
      one.bending_direction_rad = yaml::read_direction_rad(item);
      one.curvature_gain_per_m_rad = read_gain(item, segment.length_m);
      one.saturation_per_rad = number_if_given(item, "saturation_per_rad");
      one.stiffness_gain_nm2_per_rad = number_if_given(item, "stiffness_gain_nm2_per_rad");
      segment.cables.push_back(one);
    }
  }

  /// A gain may be written as the spool's radius over the lever and the segment's length. The radius is what
  /// is least well known: where the cable leaves the spool.
  void visit_numbers(const Segment& before, const Segment& after, const yaml::Path& at,
                     const VisitNumber& visit) const override {
    const double longer = after.length_m / before.length_m;
    visit({at / "cables_saturation_per_rad", before.saturation.cables_per_rad.value_or(0.0),
           after.saturation.cables_per_rad.value_or(0.0)});
    visit({at / "bending_stiffness" / "per_angle_nm2_per_rad",
           before.bending_stiffness.per_angle_nm2_per_rad.value_or(0.0),
           after.bending_stiffness.per_angle_nm2_per_rad.value_or(0.0)});
    visit({at / "bending_stiffness" / "per_min_angle_nm2_per_rad",
           before.bending_stiffness.per_min_angle_nm2_per_rad.value_or(0.0),
           after.bending_stiffness.per_min_angle_nm2_per_rad.value_or(0.0)});
    for (std::size_t k = 0; k < after.cables.size(); ++k) {
      const double a = before.cables[k].curvature_gain_per_m_rad,
                   b = after.cables[k].curvature_gain_per_m_rad;
      const yaml::Path path = at / "cables" / k;
      visit({path / "curvature_gain_per_m_rad", a, b, path / "spool_radius_m", b / a * longer});
      visit({path / "saturation_per_rad", before.cables[k].saturation_per_rad.value_or(0.0),
             after.cables[k].saturation_per_rad.value_or(0.0)});
      visit({path / "stiffness_gain_nm2_per_rad", before.cables[k].stiffness_gain_nm2_per_rad.value_or(0.0),
             after.cables[k].stiffness_gain_nm2_per_rad.value_or(0.0)});
    }
  }

 private:
  static double read_gain(const yaml::Section& section, double length_m) {
    constexpr const char* kParts[] = {"spool_radius_m", "lever_m"};
    if (section.has("curvature_gain_per_m_rad")) {
      for (const char* const key : kParts) {
        if (section.has(key))
          section.fail(key, "is given beside curvature_gain_per_m_rad, which it is part of");
      }
      return section.number("curvature_gain_per_m_rad");
    }
    for (const char* const key : kParts)
      section.require(key, "a cable needs it, or curvature_gain_per_m_rad");
    return section.number("spool_radius_m") / (length_m * section.number("lever_m"));
  }

  static const yaml::KeyTable& keys() {
    static const yaml::KeyTable table{
        "segments[].cables[]",
        {yaml::text("input", yaml::kRequired,
                    "name of the angle input (inputs.angles) of the servo that winds up the cable"),
         yaml::number("bending_direction_deg", "deg", yaml::kRequired, -360, 360,
                      "azimuth of the cable: the arm bends towards it for positive angles"),
         yaml::number("curvature_gain_per_m_rad", "1/(m rad)", yaml::kAbsent, 0, 1e4,
                      "curvature of the unloaded segment per angle (or spool_radius_m and lever_m)"),
         yaml::number("spool_radius_m", "m", yaml::kAbsent, 1e-4, 1,
                      "r_s: radius of the spool; the gain is spool_radius_m / (length_m * lever_m)"),
         yaml::number("lever_m", "m", yaml::kAbsent, 1e-4, 1,
                      "r + r_t: distance of the cable from the segment's axis"),
         yaml::number("saturation_per_rad", "1/rad", yaml::kAbsent, 0, CableLaw::kMost,
                      "a: the cable's curvature is divided by 1 + a times the size of its angle; absent: "
                      "proportional"),
         yaml::number("stiffness_gain_nm2_per_rad", "N m^2/rad", yaml::kAbsent, 0, CableLaw::kMostGrowth,
                      "EI of the segment per size of this cable's angle")}};
    return table;
  }
};

}  // namespace

const ActuatorKind& cables_kind() {
  static const Cables kind;
  return kind;
}

}  // namespace softarm::arm
