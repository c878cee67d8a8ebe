// Topics, types and units.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "arm_parts.h"
#include "body_source.h"

namespace softarm::arm::yaml {
namespace {

double pascals_per(const std::string& unit) {
  static const std::map<std::string, double> kScale{{"Pa", 1.0},  {"kPa", 1e3},    {"MPa", 1e6},
                                                    {"bar", 1e5}, {"mbar", 100.0}, {"psi", 6894.757293168}};
  return kScale.at(unit);
}

double newtons_per(const std::string& unit) {
  static const std::map<std::string, double> kScale{
      {"N", 1.0}, {"mN", 1e-3}, {"kgf", 9.80665}, {"gf", 9.80665e-3}};
  return kScale.at(unit);
}

double radians_per(const std::string& unit) {
  static const std::map<std::string, double> kScale{{"rad", 1.0}, {"deg", M_PI / 180.0}};
  return kScale.at(unit);
}

/// Types whose number needs no field to be named.
const std::vector<std::string>& plain_types(InputKind kind) {
  static const std::vector<std::string> numbers{"std_msgs/Float64", "std_msgs/Float32MultiArray",
                                                "std_msgs/Float64MultiArray"};
  static const std::vector<std::string> pressures = [] {
    std::vector<std::string> types = numbers;
    types.insert(types.begin(), "sensor_msgs/FluidPressure");
    return types;
  }();
  return kind == InputKind::kPressure || kind == InputKind::kVacuum ? pressures : numbers;
}

// By hand: of long words std::regex takes more stack than there is.
bool is_identifier(std::string_view word) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  const auto goes_on = [&](char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '_'; };
  return !word.empty() && is_letter(word.front()) && std::all_of(word.begin(), word.end(), goes_on);
}

/// A type of ROS: package/Name.
bool is_type(std::string_view text) {
  const std::size_t slash = text.find('/');
  return slash != std::string_view::npos && is_identifier(text.substr(0, slash)) &&
         is_identifier(text.substr(slash + 1));
}

/// name or name[3], with up to six digits.
bool is_step(std::string_view step) {
  const std::size_t bracket = step.find('[');
  if (bracket == std::string_view::npos) return is_identifier(step);
  std::string_view index = step.substr(bracket + 1);
  if (index.size() < 2 || index.size() > 7 || index.back() != ']') return false;
  index.remove_suffix(1);
  return is_identifier(step.substr(0, bracket)) &&
         std::all_of(index.begin(), index.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// A way through a message: names with indices, joined by dots.
bool is_field(std::string_view text) {
  for (;;) {
    const std::size_t dot = text.find('.');
    if (!is_step(text.substr(0, dot))) return false;
    if (dot == std::string_view::npos) return true;
    text.remove_prefix(dot + 1);
  }
}

void read_type(const Section& section, ScalarInput* input) {
  input->type = section.text("type");
  const std::vector<std::string>& plain = plain_types(input->kind);
  const bool is_plain = std::find(plain.begin(), plain.end(), input->type) != plain.end();
  if (!section.has("field")) {
    if (is_plain) return;
    section.fail_value("type", fmt::format("is none of: {}; for a message of another type give field",
                                           fmt::join(plain, ", ")));
  }
  if (is_plain) section.fail("field", fmt::format("does not apply to {}", input->type));
  if (!is_type(input->type)) section.fail_value("type", "is not a message type, package/Name");
  input->field = section.text("field");
  if (!is_field(input->field)) {
    section.fail_value("field", "is not a field of a message, such as effort[2] or chambers[0].pressure");
  }
}

/// What all kinds of inputs have.
ScalarInput read_source(const Section& section, InputKind kind) {
  ScalarInput input;
  input.kind = kind;
  input.name = section.name("name");
  input.topic = section.topic("topic");
  read_type(section, &input);
  input.element = section.integer("element");
  input.stamp = section.word("stamp") == "header" ? StampSource::kHeader : StampSource::kReceipt;
  input.latency_s = section.number("latency_s");
  if (section.has("between"))
    input.between = section.word("between") == "held" ? Between::kHeld : Between::kSampled;
  if (input.element != 0 && input.type.find("MultiArray") == std::string::npos) {
    section.fail_value("element", fmt::format("is an index of an array, but type {} {}", input.type,
                                              input.field.empty() ? "holds one value" : "has a field"));
  }
  return input;
}

/// What a value may be off by; in the unit of the values, which is known by now.
void read_errors(const Section& section, ScalarInput* input) {
  input->zero_si = section.number("zero") * input->scale_to_si;
  const double size = std::abs(input->scale_to_si);  // a count may turn the other way
  if (section.has("noise_sd")) input->noise_sd_si = section.number("noise_sd") * size;
  input->zero_sd_si = section.number("zero_sd") * size;
}

ScalarInput read_pressure(const Section& section) {
  ScalarInput input =
      read_source(section, section.flag("vacuum") ? InputKind::kVacuum : InputKind::kPressure);
  input.scale_to_si = pascals_per(section.word("unit"));
  input.reference =
      section.word("reference") == "gauge" ? PressureReference::kGauge : PressureReference::kAbsolute;
  read_errors(section, &input);
  return input;
}

ScalarInput read_tension(const Section& section) {
  ScalarInput input = read_source(section, InputKind::kTension);
  input.scale_to_si = newtons_per(section.word("unit"));
  read_errors(section, &input);
  return input;
}

ScalarInput read_angle(const Section& section) {
  ScalarInput input = read_source(section, InputKind::kAngle);
  if (section.has("rad_per_unit")) {
    if (section.has("unit")) section.fail("rad_per_unit", "is given beside unit; give one of them only");
    input.scale_to_si = section.number("rad_per_unit");
    if (input.scale_to_si == 0.0) section.fail_value("rad_per_unit", "must not be 0");
  } else {
    input.scale_to_si = radians_per(section.word("unit"));
  }
  read_errors(section, &input);
  return input;
}

/// Appends an input whose name is new and whose value nothing else reads.
void add_input(const Section& section, const ScalarInput& input, std::vector<ScalarInput>* inputs) {
  // Else reports and findings would mix the two.
  for (const char* taken : {"payload", "attitude"})
    if (input.name == taken)
      section.fail_value("name", fmt::format("is taken: reports have the arm's own {} under it", taken));
  for (const ScalarInput& other : *inputs) {
    if (other.name == input.name)
      section.fail_value("name", "is given to another input already; names are unique");
    if (other.topic == input.topic && other.element == input.element && other.field == input.field) {
      const std::string part =
          input.field.empty() ? fmt::format("element {}", input.element) : "field " + input.field;
      section.fail_value("topic", fmt::format("with {} is read by input '{}' already", part, other.name));
    }
    if (other.topic == input.topic && other.type != input.type) {
      section.fail_value("type",
                         fmt::format("differs from that of input '{}' on the same topic", other.name));
    }
  }
  inputs->push_back(input);
}

}  // namespace

Inputs read_inputs(const Section& section) {
  Inputs inputs;
  const Section bodies = section.section("bodies", body_input_keys());
  inputs.bodies = read_body_source(bodies);
  if (section.has("base")) inputs.base = read_body_source(section.section("base", base_input_keys()));
  inputs.body_sync_tolerance_s = bodies.number("sync_tolerance_s");
  inputs.body_latency_s = bodies.number("latency_s");
  for (const Section& item : section.list("pressures", pressure_input_keys())) {
    add_input(item, read_pressure(item), &inputs.scalars);
  }
  for (const Section& item : section.list("tensions", tension_input_keys())) {
    add_input(item, read_tension(item), &inputs.scalars);
  }
  for (const Section& item : section.list("angles", angle_input_keys())) {
    add_input(item, read_angle(item), &inputs.scalars);
  }
  inputs.ambient_pressure_pa = section.number("ambient_pressure_pa");
  inputs.input_max_age_s = section.number("input_max_age_s");
  inputs.payload_topic = section.topic("payload_topic");
  return inputs;
}

}  // namespace softarm::arm::yaml
