// Straight tendons pulled by known tensions: they pull the segment together and bend it towards their azimuth
// (hybrid paper (5), (15)), and stiffen it in shear and twist where they are taut (Rucker and Webster 2011).
#include <algorithm>
#include <limits>

#include "actuator.h"
#include "arm/key_builders.h"
#include "arm/yaml_section.h"
#include "saturation.h"

namespace softarm::arm {
namespace {

/// Negative tensions are slack.
struct TendonLaw {
  using Item = Tendon;
  static constexpr std::vector<Tendon> Segment::*kItems = &Segment::tendons;
  static constexpr std::optional<double> Tendon::*kOwn = &Tendon::saturation_per_n;
  static constexpr std::optional<double> Saturation::*kCommon = &Saturation::tendons_per_n;
  static constexpr std::optional<double> Tendon::*kOwnGrowth = &Tendon::stiffness_gain_nm2_per_n;
  static constexpr const char *kItem = "tendon", *kInputs = "tensions";
  static constexpr double kUsual = 1.0, kMost = 100.0, kMostGrowth = 10.0;
  static double size(double tension_n) { return std::max(0.0, tension_n); }
  static double acting(double tension_n) { return size(tension_n); }
  static void bend(const Tendon& one, double tension_n, Drive& drive) {
    drive.moment_nm += tension_n * one.offset_m * towards(one.bending_direction_rad);
  }
};
using ByTension = Growth<TendonLaw, &StiffnessLaw::per_tension_nm2_per_n, false>;
using ByMinTension = MinGrowth<TendonLaw, &StiffnessLaw::per_min_tension_nm2_per_n>;
using ByTendon = OwnGrowth<TendonLaw>;

const Tendon& tendon(const Segment& segment, int i) {
  return segment.tendons[static_cast<std::size_t>(i)];
}

const std::string& tendon_input(const Segment& segment, int i) {
  return tendon(segment, i).input;
}

ConstantSpec offset() {
  ConstantSpec c{ConstantKind::kTendonOffset,
                 ConstantRole::kMoment,
                 "tendon_{}.offset",
                 "m",
                 "tendon",
                 tendon_input,
                 kMovesTwist};
  c.count = [](const Segment& s) { return static_cast<int>(s.tendons.size()); };
  c.value = [](const Segment& s, int i) { return tendon(s, i).offset_m; };
  c.set = [](Segment& s, int i, double value) { s.tendons[static_cast<std::size_t>(i)].offset_m = value; };
  c.allowed = [](const Segment&, int) { return Range{0.0, 0.5}; };
  c.change = [](const Segment& s, int i, const InputReader& inputs, Change& change) {
    const Tendon& one = tendon(s, i);
    const std::optional<double> read = inputs(one.input), sum = sum_of_sizes<TendonLaw>(s, inputs);
    if (!read || !sum) return false;
    const double tension = TendonLaw::size(*read);
    change.drive.moment_nm =
        tension / divisor<TendonLaw>(s, one, tension, *sum) * towards(one.bending_direction_rad);
    change.drive.torsional_stiffness_nm2 = 2.0 * tension * one.offset_m;
    return true;
  };
  c.scale = [](const Segment& s, int i, const RecordedInputs& recorded) {
    return kBendThatMatters_rad * unloaded_stiffness_nm2(s) / s.length_m /
           largest_or(recorded, tendon_input(s, i), 1.0);
  };
  c.advice = [](const Segment&, int, const RecordedInputs& recorded) { return recorded.load_advice(); };
  return c;
}

class Tendons final : public ActuatorKind {
 public:
  Tendons() : ActuatorKind({"tendons", "tendons", InputKind::kTension, true, true}) {}
  int count(const Segment& segment) const override { return static_cast<int>(segment.tendons.size()); }
  const std::string& input(const Segment& segment, int i) const override { return tendon_input(segment, i); }
  bool stiffens(const Segment& segment) const override {
    return ByTension::stiffens(segment) || ByMinTension::stiffens(segment) || ByTendon::stiffens(segment);
  }
  std::optional<double> bending_direction_rad(const Segment& segment, int i) const override {
    return tendon(segment, i).bending_direction_rad;
  }
  std::optional<Eigen::Vector2d> place_m(const Segment& segment, int i) const override {
    return tendon(segment, i).offset_m * towards(tendon(segment, i).bending_direction_rad);
  }

  bool drive(const Segment& segment, const InputReader& inputs, Drive& drive) const override {
    const std::optional<double> sum_n = sum_of_sizes<TendonLaw>(segment, inputs);
    if (!sum_n) return false;
    double lowest_n = std::numeric_limits<double>::max();
    for (const Tendon& one : segment.tendons) {
      const double tension = TendonLaw::size(*inputs(one.input));
      drive.axial_force_n -= tension;
      TendonLaw::bend(one, tension / divisor<TendonLaw>(segment, one, tension, *sum_n), drive);
      drive.shear_stiffness_n += tension;
      drive.torsional_stiffness_nm2 += tension * one.offset_m * one.offset_m;
      drive.added_stiffness_nm2 += ByTendon::added_nm2(one, tension);
      lowest_n = std::min(lowest_n, tension);
    }
    drive.added_stiffness_nm2 += ByTension::added_nm2(segment, *sum_n);
    if (!segment.tendons.empty()) drive.added_stiffness_nm2 += ByMinTension::added_nm2(segment, lowest_n);
    return true;
  }

  const std::vector<ConstantSpec>& constants() const override {
    static const std::vector<ConstantSpec> list{
        offset(),
        own_saturation<TendonLaw>(ConstantKind::kTendonSaturation, "tendon_{}.saturation", "1/N"),
        common_saturation<TendonLaw>(ConstantKind::kTendonsSaturation, "tendons.saturation", "1/N"),
        ByTension::constant(ConstantKind::kPerTension, "bending_stiffness.per_tension", "N m^2/N"),
        ByMinTension::constant(ConstantKind::kPerMinTension, "bending_stiffness.per_min_tension", "N m^2/N"),
        ByTendon::constant(ConstantKind::kPerTendon, "bending_stiffness.per_tendon_{}", "N m^2/N")};
    return list;
  }

  std::vector<yaml::KeySpec> segment_keys() const override {
    return {yaml::list("tendons", yaml::kMostActuators, "[]", "tendons pulled by known tensions"),
            yaml::number("tendons_saturation_per_n", "1/N", yaml::kAbsent, 0, TendonLaw::kMost,
                         "b: the moments of all tendons are divided by 1 + b times the sum of their "
                         "tensions, in addition to each one's saturation_per_n")};
  }
  std::vector<yaml::KeySpec> stiffness_keys() const override {
    return {yaml::number("per_tension_nm2_per_n", "N m^2/N", yaml::kAbsent, 0, TendonLaw::kMostGrowth,
                         "EI per N of the sum of the tensions (per N of their mean: n times that)"),
            yaml::number("per_min_tension_nm2_per_n", "N m^2/N", yaml::kAbsent, 0, TendonLaw::kMostGrowth,
                         "EI per N of the lowest tension (see also stiffness_gain_nm2_per_n of a tendon)")};
  }
  std::vector<const yaml::KeyTable*> segment_tables() const override { return {&keys()}; }

  void read(const yaml::Section& section, const yaml::Section& stiffness, const Inputs& inputs,
            Segment& segment) const override {
    segment.saturation.tendons_per_n =
        number_with_items<TendonLaw>(section, "tendons_saturation_per_n", section);
    segment.bending_stiffness.per_tension_nm2_per_n =
        number_with_items<TendonLaw>(stiffness, "per_tension_nm2_per_n", section);
    segment.bending_stiffness.per_min_tension_nm2_per_n =
        number_with_items<TendonLaw>(stiffness, "per_min_tension_nm2_per_n", section);
    for (const yaml::Section& item : section.list("tendons", keys())) {
      Tendon one;
      one.input = yaml::read_input(item, "input", inputs, InputKind::kTension, "a tendon");
      one.bending_direction_rad = yaml::read_direction_rad(item);
      one.offset_m = item.number("offset_m");
      one.saturation_per_n = number_if_given(item, "saturation_per_n");
      one.stiffness_gain_nm2_per_n = number_if_given(item, "stiffness_gain_nm2_per_n");
      segment.tendons.push_back(one);
    }
  }

  void visit_numbers(const Segment& before, const Segment& after, const yaml::Path& at,
                     const VisitNumber& visit) const override {
    visit({at / "tendons_saturation_per_n", before.saturation.tendons_per_n.value_or(0.0),
           after.saturation.tendons_per_n.value_or(0.0)});
    visit({at / "bending_stiffness" / "per_tension_nm2_per_n",
           before.bending_stiffness.per_tension_nm2_per_n.value_or(0.0),
           after.bending_stiffness.per_tension_nm2_per_n.value_or(0.0)});
    visit({at / "bending_stiffness" / "per_min_tension_nm2_per_n",
           before.bending_stiffness.per_min_tension_nm2_per_n.value_or(0.0),
           after.bending_stiffness.per_min_tension_nm2_per_n.value_or(0.0)});
    for (std::size_t k = 0; k < after.tendons.size(); ++k) {
      const Tendon &a = before.tendons[k], &b = after.tendons[k];
      const yaml::Path path = at / "tendons" / k;
      visit({path / "offset_m", a.offset_m, b.offset_m});
      visit({path / "saturation_per_n", a.saturation_per_n.value_or(0.0), b.saturation_per_n.value_or(0.0)});
      visit({path / "stiffness_gain_nm2_per_n", a.stiffness_gain_nm2_per_n.value_or(0.0),
             b.stiffness_gain_nm2_per_n.value_or(0.0)});
    }
  }

 private:
  static const yaml::KeyTable& keys() {
    static const yaml::KeyTable table{
        "segments[].tendons[]",
        {yaml::text("input", yaml::kRequired, "name of the tension input (inputs.tensions)"),
         yaml::number("bending_direction_deg", "deg", yaml::kRequired, -360, 360,
                      "azimuth of the tendon: the arm bends towards it when the tendon is pulled"),
         yaml::number("offset_m", "m", yaml::kRequired, 0, 0.5,
                      "distance from the segment's axis; 0: the tendon only compresses"),
         yaml::number("saturation_per_n", "1/N", yaml::kAbsent, 0, TendonLaw::kMost,
                      "a: the tendon's moment is offset T / (1 + a T); absent: proportional"),
         yaml::number("stiffness_gain_nm2_per_n", "N m^2/N", yaml::kAbsent, 0, TendonLaw::kMostGrowth,
                      "EI of the segment per tension of this tendon")}};
    return table;
  }
};

}  // namespace

const ActuatorKind& tendons_kind() {
  static const Tendons kind;
  return kind;
}

}  // namespace softarm::arm
