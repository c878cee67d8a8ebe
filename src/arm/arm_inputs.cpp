// Topics, types and units.
#include <fmt/format.h>

#include <map>
#include <string>

#include "arm_parts.h"

namespace softarm::yaml {
namespace {

double metres_per(const std::string& unit) {
  static const std::map<std::string, double> kScale{{"m", 1.0}, {"cm", 1e-2}, {"mm", 1e-3}};
  return kScale.at(unit);
}

double pascals_per(const std::string& unit) {
  static const std::map<std::string, double> kScale{{"Pa", 1.0},  {"kPa", 1e3},    {"MPa", 1e6},
                                                    {"bar", 1e5}, {"mbar", 100.0}, {"psi", 6894.757293168}};
  return kScale.at(unit);
}

ScalarInput read_pressure(const Section& section) {
  ScalarInput input;
  input.name = section.name("name");
  input.topic = section.topic("topic");
  input.type = section.word("type");
  input.element = section.integer("element");
  if (input.element != 0 && input.type.find("MultiArray") == std::string::npos) {
    section.fail_value("element",
                       fmt::format("is an index of an array, but type {} holds one value", input.type));
  }
  input.scale_to_si = pascals_per(section.word("unit"));
  input.reference =
      section.word("reference") == "gauge" ? PressureReference::kGauge : PressureReference::kAbsolute;
  if (section.flag("vacuum")) input.kind = InputKind::kVacuum;
  return input;
}

}  // namespace

Inputs read_inputs(const Section& section) {
  Inputs inputs;
  const Section bodies = section.section("bodies", body_input_keys());
  inputs.body_topic = bodies.topic("topic", "<body>");
  inputs.body_type = bodies.word("type");
  inputs.body_scale_to_m = metres_per(bodies.word("unit"));
  inputs.body_sync_tolerance_s = bodies.number("sync_tolerance_s");
  for (const Section& item : section.list("pressures", pressure_input_keys())) {
    const ScalarInput input = read_pressure(item);
    for (const ScalarInput& other : inputs.scalars) {
      if (other.name == input.name)
        item.fail_value("name", "is given to another input already; names are unique");
      if (other.topic == input.topic && other.element == input.element) {
        item.fail_value(
            "topic", fmt::format("with element {} is read by input '{}' already", input.element, other.name));
      }
      if (other.topic == input.topic && other.type != input.type) {
        item.fail_value("type", fmt::format("differs from that of input '{}' on the same topic", other.name));
      }
    }
    inputs.scalars.push_back(input);
  }
  inputs.ambient_pressure_pa = section.number("ambient_pressure_pa");
  inputs.input_max_age_s = section.number("input_max_age_s");
  inputs.payload_topic = section.topic("payload_topic");
  return inputs;
}

}  // namespace softarm::yaml
