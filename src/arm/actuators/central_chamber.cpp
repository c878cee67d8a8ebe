// A pneumatic chamber on the segment's axis: its pressure pulls the wall (hybrid paper (5), (15)), and EI may
// have been measured over it (Fig. 8).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "actuator.h"
#include "arm/key_builders.h"
#include "arm/yaml_section.h"

namespace softarm::arm {
namespace {

/// Where a pressure lies among the knots: EI = below + share * (above - below).
struct Place {
  std::size_t below = 0, above = 0;
  double share = 0.0;
};

Place place_of(const std::vector<PressureKnot>& knots, double pressure_pa) {
  const auto above = std::find_if(knots.begin(), knots.end(),
                                  [&](const PressureKnot& k) { return k.pressure_pa > pressure_pa; });
  if (above == knots.begin()) return {0, 0, 0.0};
  if (above == knots.end()) return {knots.size() - 1, knots.size() - 1, 0.0};
  const PressureKnot& below = *(above - 1);
  const auto i = static_cast<std::size_t>(above - knots.begin());
  return {i - 1, i, (pressure_pa - below.pressure_pa) / (above->pressure_pa - below.pressure_pa)};
}

/// Knots without a chamber are those of no pressure.
std::optional<double> central_pressure_pa(const Segment& segment, const InputReader& inputs) {
  return segment.central_chamber ? inputs(segment.central_chamber->input) : 0.0;
}

std::string advice_of_knot(const Segment& s, int index, const RecordedInputs& recorded) {
  constexpr double kNear = 0.25;  // of the mean distance of the knots
  const std::vector<PressureKnot>& knots = s.bending_stiffness.by_pressure;
  const double at_pa = knots[static_cast<std::size_t>(index)].pressure_pa;
  double nearest_pa = 1e300;
  if (s.central_chamber) {
    for (const double value : recorded.values(s.central_chamber->input))
      nearest_pa = std::min(nearest_pa, std::abs(value - at_pa));
  }
  if (nearest_pa > kNear * (knots.back().pressure_pa - knots.front().pressure_pa) /
                       std::max(1.0, static_cast<double>(knots.size() - 1)))
    return fmt::format("no trial is near that pressure: record some at {:g} kPa", at_pa * 1e-3);
  return recorded.load_advice();
}

ConstantSpec by_pressure() {
  ConstantSpec c{ConstantKind::kByPressure, ConstantRole::kBendingStiffness,
                 "bending_stiffness.by_pressure.{}", "N m^2"};
  c.count = [](const Segment& s) { return static_cast<int>(s.bending_stiffness.by_pressure.size()); };
  c.value = [](const Segment& s, int i) {
    return s.bending_stiffness.by_pressure[static_cast<std::size_t>(i)].bending_stiffness_nm2;
  };
  c.set = [](Segment& s, int i, double value) {
    s.bending_stiffness.by_pressure[static_cast<std::size_t>(i)].bending_stiffness_nm2 = value;
  };
  c.allowed = [](const Segment&, int) { return Range{1e-6, 1e3}; };
  c.change = [](const Segment& s, int i, const InputReader& inputs, Change& change) {
    const std::optional<double> pressure_pa = central_pressure_pa(s, inputs);
    if (!pressure_pa) return false;
    const Place place = place_of(s.bending_stiffness.by_pressure, *pressure_pa);
    const auto knot = static_cast<std::size_t>(i);
    if (knot == place.below) change.drive.base_stiffness_nm2 += 1.0 - place.share;
    if (knot == place.above) change.drive.base_stiffness_nm2 += place.share;
    return true;
  };
  c.scale = [](const Segment& s, int, const RecordedInputs&) { return 0.1 * unloaded_stiffness_nm2(s); };
  c.advice = advice_of_knot;
  return c;
}

class CentralChambers final : public ActuatorKind {
 public:
  CentralChambers()
      : ActuatorKind({"central_chamber", "a central_chamber", InputKind::kPressure, true, true}) {}
  int count(const Segment& segment) const override { return segment.central_chamber ? 1 : 0; }
  const std::string& input(const Segment& segment, int) const override {
    return segment.central_chamber->input;
  }
  bool stiffens(const Segment& segment) const override {
    return !segment.bending_stiffness.by_pressure.empty();
  }

  bool drive(const Segment& segment, const InputReader& inputs, Drive& drive) const override {
    const std::optional<double> pressure_pa = central_pressure_pa(segment, inputs);
    if (!pressure_pa) return false;
    if (segment.central_chamber) drive.axial_force_n += *pressure_pa * segment.central_chamber->area_m2;
    const std::vector<PressureKnot>& knots = segment.bending_stiffness.by_pressure;
    if (knots.empty()) return true;
    const Place place = place_of(knots, *pressure_pa);
    const double below_nm2 = knots[place.below].bending_stiffness_nm2;
    drive.base_stiffness_nm2 =
        below_nm2 + place.share * (knots[place.above].bending_stiffness_nm2 - below_nm2);
    drive.base_with_modulus = false;
    return true;
  }

  const std::vector<ConstantSpec>& constants() const override {
    static const std::vector<ConstantSpec> list{by_pressure()};
    return list;
  }

  std::vector<yaml::KeySpec> segment_keys() const override {
    return {
        yaml::map("central_chamber", yaml::kAbsent, "pneumatic chamber on the segment's axis; absent: none")};
  }
  std::vector<yaml::KeySpec> stiffness_keys() const override {
    return {yaml::list(
        "by_pressure", yaml::kMostOfATable, "[]",
        "knots of EI over the central chamber's pressure; they replace b1 and the material's stiffening")};
  }
  std::vector<const yaml::KeyTable*> segment_tables() const override { return {&keys()}; }
  std::vector<const yaml::KeyTable*> stiffness_tables() const override { return {&knot_keys()}; }

  void read(const yaml::Section& section, const yaml::Section& stiffness, const Inputs& inputs,
            Segment& segment) const override {
    if (section.has("central_chamber")) {
      const yaml::Section own = section.section("central_chamber", keys());
      segment.central_chamber = {yaml::read_input(own, "input", inputs, InputKind::kPressure, "a chamber"),
                                 own.number("area_m2")};
    }
    segment.bending_stiffness.by_pressure = read_knots(stiffness, segment.bending_stiffness_range_nm2);
    if (!segment.bending_stiffness.by_pressure.empty() && !segment.central_chamber)
      stiffness.fail("by_pressure", "needs the segment's central_chamber, whose pressure it is about");
  }

  void visit_numbers(const Segment& before, const Segment& after, const yaml::Path& at,
                     const VisitNumber& visit) const override {
    const auto &a = before.bending_stiffness.by_pressure, &b = after.bending_stiffness.by_pressure;
    for (std::size_t k = 0; k < b.size(); ++k)
      visit({at / "bending_stiffness" / "by_pressure" / k / "bending_stiffness_nm2",
             a[k].bending_stiffness_nm2, b[k].bending_stiffness_nm2});
  }

 private:
  static std::vector<PressureKnot> read_knots(const yaml::Section& stiffness, const Range& range) {
    std::vector<PressureKnot> knots;
    for (const yaml::Section& item : stiffness.list("by_pressure", knot_keys())) {
      const PressureKnot knot{item.number("pressure_pa"), item.number("bending_stiffness_nm2")};
      if (!knots.empty() && !(knot.pressure_pa > knots.back().pressure_pa)) {
        item.fail_value("pressure_pa", fmt::format("does not lie beyond the knot before it, {:g} Pa",
                                                   knots.back().pressure_pa));
      }
      if (!(knot.bending_stiffness_nm2 >= range.low && knot.bending_stiffness_nm2 <= range.high)) {
        item.fail_value(
            "bending_stiffness_nm2",
            fmt::format("is outside the segment's own range_nm2 [{:g}, {:g}] N m^2", range.low, range.high));
      }
      knots.push_back(knot);
    }
    return knots;
  }

  static const yaml::KeyTable& keys() {
    static const yaml::KeyTable table{
        "segments[].central_chamber",
        {yaml::text("input", yaml::kRequired, "name of the chamber's pressure input (inputs.pressures)"),
         yaml::number("area_m2", "m^2", yaml::kRequired, 1e-9, 0.1,
                      "cross-section of the chamber: its gauge pressure times this stretches the wall")}};
    return table;
  }
  static const yaml::KeyTable& knot_keys() {
    static const yaml::KeyTable table{
        "segments[].bending_stiffness.by_pressure[]",
        {yaml::number("pressure_pa", "Pa", yaml::kRequired, -1.2e5, 1e7,
                      "gauge pressure, increasing from knot to knot"),
         yaml::number("bending_stiffness_nm2", "N m^2", yaml::kRequired, 1e-6, 1e3,
                      "EI at this pressure; linear in between, constant beyond the ends")}};
    return table;
  }
};

}  // namespace

const ActuatorKind& central_chamber_kind() {
  static const CentralChambers kind;
  return kind;
}

}  // namespace softarm::arm
