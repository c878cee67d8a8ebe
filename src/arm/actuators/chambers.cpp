// Pneumatic chambers along a segment, off its axis: length law (3)-(6), stiffness law (7)-(9) and moment law
// (10)-(13) of the semi-physical paper.
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "actuator.h"
#include "arm/key_builders.h"
#include "arm/yaml_section.h"
#include "saturation.h"

namespace softarm::arm {
namespace {

constexpr double kElongationThatMatters = 0.02;  // of the length at the largest pressure

/// A pressure below zero is a sensor's zero: its moment is in proportion, and it holds nothing back.
struct ChamberLaw {
  using Item = Chamber;
  static constexpr std::vector<Chamber> Segment::*kItems = &Segment::chambers;
  static constexpr std::optional<double> Chamber::*kOwn = &Chamber::saturation_per_pa;
  static constexpr std::optional<double> Saturation::*kCommon = &Saturation::chambers_per_pa;
  static constexpr std::optional<double> Chamber::*kOwnGrowth = &Chamber::stiffness_gain_nm2_per_pa;
  static constexpr const char *kItem = "chamber", *kInputs = "pressures";
  static constexpr double kUsual = kUsualPressure_pa, kMost = 1e-2, kMostGrowth = 1e-4;
  static double size(double pressure_pa) { return std::max(0.0, pressure_pa); }
  static double acting(double pressure_pa) { return pressure_pa; }
  static void bend(const Chamber& one, double pressure_pa, Drive& drive) {
    drive.moment_nm += one.moment_gain_nm_per_pa * pressure_pa * towards(one.bending_direction_rad);
  }
};
using ByMeanPressure = Growth<ChamberLaw, &StiffnessLaw::per_mean_pressure_nm2_per_pa, true>;
using ByMinPressure = MinGrowth<ChamberLaw, &StiffnessLaw::per_min_pressure_nm2_per_pa>;
using ByChamber = OwnGrowth<ChamberLaw>;

const Chamber& chamber(const Segment& segment, int i) {
  return segment.chambers[static_cast<std::size_t>(i)];
}

const std::string& chamber_input(const Segment& segment, int i) {
  return chamber(segment, i).input;
}

int chamber_count(const Segment& segment) {
  return static_cast<int>(segment.chambers.size());
}

ConstantSpec moment_gain() {
  ConstantSpec c{ConstantKind::kMomentGain,
                 ConstantRole::kMoment,
                 "chamber_{}.moment_gain",
                 "N m/Pa",
                 "chamber",
                 chamber_input};
  c.count = chamber_count;
  c.value = [](const Segment& s, int i) { return chamber(s, i).moment_gain_nm_per_pa; };
  c.set = [](Segment& s, int i, double value) {
    s.chambers[static_cast<std::size_t>(i)].moment_gain_nm_per_pa = value;
  };
  c.allowed = [](const Segment&, int) { return Range{0.0, 1e-3}; };
  c.change = [](const Segment& s, int i, const InputReader& inputs, Change& change) {
    const Chamber& one = chamber(s, i);
    const std::optional<double> pressure_pa = inputs(one.input), sum = sum_of_sizes<ChamberLaw>(s, inputs);
    if (!pressure_pa || !sum) return false;
    change.drive.moment_nm =
        *pressure_pa / divisor<ChamberLaw>(s, one, *pressure_pa, *sum) * towards(one.bending_direction_rad);
    return true;
  };
  c.scale = [](const Segment& s, int i, const RecordedInputs& recorded) {
    return kBendThatMatters_rad * unloaded_stiffness_nm2(s) / s.length_m /
           largest_or(recorded, chamber_input(s, i), kUsualPressure_pa);
  };
  c.advice = [](const Segment&, int, const RecordedInputs& recorded) { return recorded.load_advice(); };
  return c;
}

ConstantSpec elongation() {
  ConstantSpec c{ConstantKind::kElongation,
                 ConstantRole::kOther,
                 "chamber_{}.elongation",
                 "m/Pa",
                 "chamber",
                 chamber_input};
  c.count = chamber_count;
  c.value = [](const Segment& s, int i) {
    return chamber(s, i).near_elongation_m_per_pa + chamber(s, i).far_elongation_m_per_pa;
  };
  c.set = [](Segment& s, int i, double value) {
    Chamber& changed = s.chambers[static_cast<std::size_t>(i)];
    changed.near_elongation_m_per_pa = value - changed.far_elongation_m_per_pa;
  };
  c.allowed = [](const Segment& s, int i) {  // of the near one, which is changed
    const double far = chamber(s, i).far_elongation_m_per_pa;
    return Range{-1e-5 + far, 1e-5 + far};
  };
  c.change = [](const Segment& s, int i, const InputReader& inputs, Change& change) {
    const std::optional<double> pressure_pa = inputs(chamber(s, i).input);
    change.drive.length_m = pressure_pa.value_or(0.0);
    return pressure_pa.has_value();
  };
  c.scale = [](const Segment& s, int i, const RecordedInputs& recorded) {
    return kElongationThatMatters * s.length_m / largest_or(recorded, chamber_input(s, i), kUsualPressure_pa);
  };
  c.advice = [](const Segment& s, int i, const RecordedInputs&) {
    return fmt::format(
        "the length hardly responds to {}: record trials with it at higher pressure, and others at rest",
        input_words(s, "chamber", chamber_input(s, i), i));
  };
  return c;
}

class Chambers final : public ActuatorKind {
 public:
  Chambers() : ActuatorKind({"chambers", "chambers", InputKind::kPressure, true, false}) {}
  int count(const Segment& segment) const override { return chamber_count(segment); }
  const std::string& input(const Segment& segment, int i) const override { return chamber_input(segment, i); }
  bool stiffens(const Segment& segment) const override {
    return ByMinPressure::stiffens(segment) || ByMeanPressure::stiffens(segment) ||
           ByChamber::stiffens(segment);
  }
  std::optional<double> bending_direction_rad(const Segment& segment, int i) const override {
    return chamber(segment, i).bending_direction_rad;
  }

  /// Every chamber pulls towards its own azimuth. On the bending axis, a quarter turn from there, the cosine
  /// terms of (3) cancel, and what is left is L0 + sum P_i (a_near + a_far).
  bool drive(const Segment& segment, const InputReader& inputs, Drive& drive) const override {
    const std::optional<double> sum_pa = sum_of_sizes<ChamberLaw>(segment, inputs);
    if (!sum_pa) return false;
    double lowest_pa = std::numeric_limits<double>::max();
    for (const Chamber& one : segment.chambers) {
      const double pressure_pa = *inputs(one.input);
      drive.length_m += pressure_pa * (one.near_elongation_m_per_pa + one.far_elongation_m_per_pa);
      ChamberLaw::bend(one, pressure_pa / divisor<ChamberLaw>(segment, one, pressure_pa, *sum_pa), drive);
      drive.added_stiffness_nm2 += ByChamber::added_nm2(one, pressure_pa);
      lowest_pa = std::min(lowest_pa, ChamberLaw::size(pressure_pa));
    }
    drive.added_stiffness_nm2 += ByMeanPressure::added_nm2(segment, *sum_pa);
    if (!segment.chambers.empty()) drive.added_stiffness_nm2 += ByMinPressure::added_nm2(segment, lowest_pa);
    return true;
  }

  const std::vector<ConstantSpec>& constants() const override {
    static const std::vector<ConstantSpec> list{
        moment_gain(),
        own_saturation<ChamberLaw>(ConstantKind::kChamberSaturation, "chamber_{}.saturation", "1/Pa"),
        common_saturation<ChamberLaw>(ConstantKind::kChambersSaturation, "chambers.saturation", "1/Pa"),
        elongation(),
        ByMinPressure::constant(ConstantKind::kPerMinPressure, "bending_stiffness.per_min_pressure",
                                "N m^2/Pa"),
        ByMeanPressure::constant(ConstantKind::kPerMeanPressure, "bending_stiffness.per_mean_pressure",
                                 "N m^2/Pa"),
        ByChamber::constant(ConstantKind::kPerChamber, "bending_stiffness.per_chamber_{}", "N m^2/Pa")};
    return list;
  }

  std::vector<yaml::KeySpec> segment_keys() const override {
    return {yaml::list("chambers", yaml::kMostActuators, "[]",
                       "pneumatic chambers along the segment, off its axis"),
            yaml::number("chambers_saturation_per_pa", "1/Pa", yaml::kAbsent, 0, ChamberLaw::kMost,
                         "b: the moments of all chambers are divided by 1 + b times the sum of their "
                         "pressures, in addition to each one's saturation_per_pa")};
  }
  std::vector<yaml::KeySpec> stiffness_keys() const override {
    return {
        yaml::number("per_min_pressure_nm2_per_pa", "N m^2/Pa", "0", 0, 1e-4,
                     "b2: EI per Pa of the lowest chamber pressure"),
        yaml::number("per_mean_pressure_nm2_per_pa", "N m^2/Pa", yaml::kAbsent, 0, ChamberLaw::kMostGrowth,
                     "EI per Pa of the mean chamber pressure (see also stiffness_gain_nm2_per_pa of a "
                     "chamber)")};
  }
  std::vector<const yaml::KeyTable*> segment_tables() const override { return {&keys()}; }

  void read(const yaml::Section& section, const yaml::Section& stiffness, const Inputs& inputs,
            Segment& segment) const override {
    segment.bending_stiffness.per_min_pressure_nm2_per_pa = stiffness.number("per_min_pressure_nm2_per_pa");
    segment.bending_stiffness.per_mean_pressure_nm2_per_pa =
        number_with_items<ChamberLaw>(stiffness, "per_mean_pressure_nm2_per_pa", section);
    segment.saturation.chambers_per_pa =
        number_with_items<ChamberLaw>(section, "chambers_saturation_per_pa", section);
    for (const yaml::Section& item : section.list("chambers", keys())) {
      Chamber one;
      one.input = yaml::read_input(item, "input", inputs, InputKind::kPressure, "a chamber");
      one.bending_direction_rad = yaml::read_direction_rad(item);
      one.moment_gain_nm_per_pa = item.number("moment_gain_nm_per_pa");
      one.near_elongation_m_per_pa = item.number("near_elongation_m_per_pa");
      one.far_elongation_m_per_pa = item.number("far_elongation_m_per_pa");
      one.saturation_per_pa = number_if_given(item, "saturation_per_pa");
      one.stiffness_gain_nm2_per_pa = number_if_given(item, "stiffness_gain_nm2_per_pa");
      segment.chambers.push_back(one);
    }
  }

  void visit_numbers(const Segment& before, const Segment& after, const yaml::Path& at,
                     const VisitNumber& visit) const override {
    visit({at / "bending_stiffness" / "per_min_pressure_nm2_per_pa",
           before.bending_stiffness.per_min_pressure_nm2_per_pa,
           after.bending_stiffness.per_min_pressure_nm2_per_pa});
    visit({at / "bending_stiffness" / "per_mean_pressure_nm2_per_pa",
           before.bending_stiffness.per_mean_pressure_nm2_per_pa.value_or(0.0),
           after.bending_stiffness.per_mean_pressure_nm2_per_pa.value_or(0.0)});
    visit({at / "chambers_saturation_per_pa", before.saturation.chambers_per_pa.value_or(0.0),
           after.saturation.chambers_per_pa.value_or(0.0)});
    for (std::size_t k = 0; k < after.chambers.size(); ++k) {
      const Chamber &a = before.chambers[k], &b = after.chambers[k];
      const yaml::Path path = at / "chambers" / k;
      visit({path / "moment_gain_nm_per_pa", a.moment_gain_nm_per_pa, b.moment_gain_nm_per_pa});
      visit({path / "near_elongation_m_per_pa", a.near_elongation_m_per_pa, b.near_elongation_m_per_pa});
      visit({path / "far_elongation_m_per_pa", a.far_elongation_m_per_pa, b.far_elongation_m_per_pa});
      visit(
          {path / "saturation_per_pa", a.saturation_per_pa.value_or(0.0), b.saturation_per_pa.value_or(0.0)});
      visit({path / "stiffness_gain_nm2_per_pa", a.stiffness_gain_nm2_per_pa.value_or(0.0),
             b.stiffness_gain_nm2_per_pa.value_or(0.0)});
    }
  }

 private:
  static const yaml::KeyTable& keys() {
    static const yaml::KeyTable table{
        "segments[].chambers[]",
        {yaml::text("input", yaml::kRequired, "name of the chamber's pressure input (inputs.pressures)"),
         yaml::number("bending_direction_deg", "deg", yaml::kRequired, -360, 360,
                      "azimuth towards which the arm bends when the chamber is inflated"),
         yaml::number("moment_gain_nm_per_pa", "N m/Pa", yaml::kRequired, 0, 1e-3,
                      "c: bending moment per gauge pressure"),
         yaml::number("near_elongation_m_per_pa", "m/Pa", "0", -1e-5, 1e-5,
                      "a1, a3, a5: elongation at the chamber's side"),
         yaml::number("far_elongation_m_per_pa", "m/Pa", "0", -1e-5, 1e-5,
                      "a2, a4, a6: elongation opposite the chamber"),
         yaml::number(
             "saturation_per_pa", "1/Pa", yaml::kAbsent, 0, ChamberLaw::kMost,
             "a: the chamber's moment is c p / (1 + a p), which tends to c / a; absent: proportional"),
         yaml::number("stiffness_gain_nm2_per_pa", "N m^2/Pa", yaml::kAbsent, 0, ChamberLaw::kMostGrowth,
                      "EI of the segment per gauge pressure of this chamber")}};
    return table;
  }
};

}  // namespace

const ActuatorKind& chambers_kind() {
  static const Chambers kind;
  return kind;
}

}  // namespace softarm::arm
