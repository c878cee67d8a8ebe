// Straight tendons pulled by known tensions: they pull the segment together and bend it towards their azimuth
// (hybrid paper (5), (15)), and stiffen it in shear and twist where they are taut (Rucker and Webster 2011).
#include <algorithm>

#include "actuator.h"
#include "arm/key_builders.h"
#include "arm/yaml_section.h"

namespace softarm::arm {
namespace {

const Tendon& tendon(const Segment& segment, int i) {
  return segment.tendons[static_cast<std::size_t>(i)];
}

const std::string& tendon_input(const Segment& segment, int i) {
  return tendon(segment, i).input;
}

/// Negative tensions are slack.
std::optional<double> tension_n(const InputReader& inputs, const Tendon& one) {
  const std::optional<double> read = inputs(one.input);
  if (!read) return std::nullopt;
  return std::max(0.0, *read);
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
    const std::optional<double> tension = tension_n(inputs, one);
    if (!tension) return false;
    change.drive.moment_nm = *tension * towards(one.bending_direction_rad);
    change.drive.torsional_stiffness_nm2 = 2.0 * *tension * one.offset_m;
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
  std::optional<double> bending_direction_rad(const Segment& segment, int i) const override {
    return tendon(segment, i).bending_direction_rad;
  }
  std::optional<Eigen::Vector2d> place_m(const Segment& segment, int i) const override {
    return tendon(segment, i).offset_m * towards(tendon(segment, i).bending_direction_rad);
  }

  bool drive(const Segment& segment, const InputReader& inputs, Drive& drive) const override {
    for (const Tendon& one : segment.tendons) {
      const std::optional<double> tension = tension_n(inputs, one);
      if (!tension) return false;
      drive.axial_force_n -= *tension;
      drive.moment_nm += *tension * one.offset_m * towards(one.bending_direction_rad);
      drive.shear_stiffness_n += *tension;
      drive.torsional_stiffness_nm2 += *tension * one.offset_m * one.offset_m;
    }
    return true;
  }

  const std::vector<ConstantSpec>& constants() const override {
    static const std::vector<ConstantSpec> list{offset()};
    return list;
  }

  std::vector<yaml::KeySpec> segment_keys() const override {
    return {yaml::list("tendons", "[]", "tendons pulled by known tensions")};
  }
  std::vector<const yaml::KeyTable*> segment_tables() const override { return {&keys()}; }

  void read(const yaml::Section& section, const yaml::Section&, const Inputs& inputs,
            Segment& segment) const override {
    for (const yaml::Section& item : section.list("tendons", keys())) {
      Tendon one;
      one.input = yaml::read_input(item, "input", inputs, InputKind::kTension, "a tendon");
      one.bending_direction_rad = yaml::read_direction_rad(item);
      one.offset_m = item.number("offset_m");
      segment.tendons.push_back(one);
    }
  }

  void visit_numbers(const Segment& before, const Segment& after, const yaml::Path& at,
                     const VisitNumber& visit) const override {
    for (std::size_t k = 0; k < after.tendons.size(); ++k)
      visit({at / "tendons" / k / "offset_m", before.tendons[k].offset_m, after.tendons[k].offset_m});
  }

 private:
  static const yaml::KeyTable& keys() {
    static const yaml::KeyTable table{
        "segments[].tendons[]",
        {yaml::text("input", yaml::kRequired, "name of the tension input (inputs.tensions)"),
         yaml::number("bending_direction_deg", "deg", yaml::kRequired, -360, 360,
                      "azimuth of the tendon: towards which the arm bends when it is pulled"),
         yaml::number("offset_m", "m", yaml::kRequired, 0, 0.5,
                      "distance from the segment's axis; 0: it only compresses")}};
    return table;
  }
};

}  // namespace

const ActuatorKind& tendons_kind() {
  static const Tendons kind;
  return kind;
}

}  // namespace softarm::arm
