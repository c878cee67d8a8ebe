// A core that vacuum jams: it stiffens the segment, with the pressure of the chambers around it ((8), (9) of
// the semi-physical paper).
#include <algorithm>

#include "actuator.h"
#include "arm/key_builders.h"
#include "arm/yaml_section.h"

namespace softarm::arm {
namespace {

/// V + mean(P_i), not below zero. @return nothing where one of them is absent
std::optional<double> jamming_pressure_pa(const Segment& segment, const InputReader& inputs) {
  std::optional<double> vacuum_pa = 0.0;
  if (segment.jamming_input) vacuum_pa = inputs(*segment.jamming_input);
  if (!vacuum_pa) return std::nullopt;
  double mean_pa = 0.0;
  for (const Chamber& chamber : segment.chambers) {
    const std::optional<double> pressure_pa = inputs(chamber.input);
    if (!pressure_pa) return std::nullopt;
    mean_pa += *pressure_pa;
  }
  if (!segment.chambers.empty()) mean_pa /= static_cast<double>(segment.chambers.size());
  return std::max(0.0, *vacuum_pa + mean_pa);
}

ConstantSpec per_jamming_pressure() {
  ConstantSpec c{ConstantKind::kPerJammingPressure, ConstantRole::kBendingStiffnessSlope,
                 "bending_stiffness.per_jamming_pressure", "N m^2/Pa"};
  c.count = [](const Segment& s) { return s.jamming_input && !s.chambers.empty() ? 1 : 0; };
  c.value = [](const Segment& s, int) { return s.bending_stiffness.per_jamming_pressure_nm2_per_pa; };
  c.set = [](Segment& s, int, double value) { s.bending_stiffness.per_jamming_pressure_nm2_per_pa = value; };
  c.allowed = [](const Segment&, int) { return Range{0.0, 1e-4}; };
  c.change = [](const Segment& s, int, const InputReader& inputs, Change& change) {
    const std::optional<double> jamming_pa = jamming_pressure_pa(s, inputs);
    change.drive.added_stiffness_nm2 = jamming_pa.value_or(0.0);
    return jamming_pa.has_value();
  };
  c.scale = [](const Segment& s, int, const RecordedInputs& recorded) {
    double jamming_pa = s.jamming_input ? recorded.largest(*s.jamming_input) : 0.0;
    for (const Chamber& chamber : s.chambers)
      jamming_pa += recorded.largest(chamber.input) / static_cast<double>(s.chambers.size());
    return kStiffnessThatMatters * unloaded_stiffness_nm2(s) /
           (jamming_pa > 0.0 ? jamming_pa : kUsualPressure_pa);
  };
  c.advice = [](const Segment& s, int, const RecordedInputs& recorded) -> std::string {
    if (!s.jamming_input || !(recorded.range(*s.jamming_input) > 0.0))
      return "the vacuum does not change: record trials with the vacuum on and others with it off";
    return "record trials with the vacuum on and off, with a payload; " + recorded.load_advice();
  };
  return c;
}

class JammingCore final : public ActuatorKind {
 public:
  JammingCore() : ActuatorKind({"jamming", "a jamming core", InputKind::kVacuum, false, false}) {}
  int count(const Segment& segment) const override { return segment.jamming_input ? 1 : 0; }
  const std::string& input(const Segment& segment, int) const override { return *segment.jamming_input; }
  /// Without a jammable core the vacuum does nothing, so its absence does not matter either.
  bool needs_inputs(const Segment& segment) const override { return stiffens(segment); }
  bool stiffens(const Segment& segment) const override {
    return segment.bending_stiffness.per_jamming_pressure_nm2_per_pa != 0.0;
  }

  bool drive(const Segment& segment, const InputReader& inputs, Drive& drive) const override {
    if (!stiffens(segment)) return true;
    const std::optional<double> jamming_pa = jamming_pressure_pa(segment, inputs);
    if (!jamming_pa) return false;
    drive.added_stiffness_nm2 += segment.bending_stiffness.per_jamming_pressure_nm2_per_pa * *jamming_pa;
    return true;
  }

  const std::vector<ConstantSpec>& constants() const override {
    static const std::vector<ConstantSpec> list{per_jamming_pressure()};
    return list;
  }

  std::vector<yaml::KeySpec> segment_keys() const override {
    return {yaml::text("jamming_input", yaml::kAbsent, "vacuum input of the jamming core; absent: no core")};
  }
  std::vector<yaml::KeySpec> stiffness_keys() const override {
    return {yaml::number("per_jamming_pressure_nm2_per_pa", "N m^2/Pa", "0", 0, 1e-4,
                         "b3: EI per Pa of vacuum plus mean chamber pressure")};
  }

  void read(const yaml::Section& section, const yaml::Section& stiffness, const Inputs& inputs,
            Segment& segment) const override {
    if (section.has("jamming_input"))
      segment.jamming_input =
          yaml::read_input(section, "jamming_input", inputs, InputKind::kVacuum, "a core");
    StiffnessLaw& law = segment.bending_stiffness;
    law.per_jamming_pressure_nm2_per_pa = stiffness.number("per_jamming_pressure_nm2_per_pa");
    if (law.per_jamming_pressure_nm2_per_pa > 0.0 && !segment.jamming_input)
      stiffness.fail_value("per_jamming_pressure_nm2_per_pa", "needs the segment's jamming_input");
  }

  void visit_numbers(const Segment& before, const Segment& after, const yaml::Path& at,
                     const VisitNumber& visit) const override {
    visit({at / "bending_stiffness" / "per_jamming_pressure_nm2_per_pa",
           before.bending_stiffness.per_jamming_pressure_nm2_per_pa,
           after.bending_stiffness.per_jamming_pressure_nm2_per_pa});
  }
};

}  // namespace

const ActuatorKind& jamming_kind() {
  static const JammingCore kind;
  return kind;
}

}  // namespace softarm::arm
