// What kinds of actuators read alike.
#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "actuator.h"
#include "arm/yaml_section.h"

namespace softarm::arm::yaml {
namespace {

const ScalarInput* find_input(const Inputs& inputs, const std::string& name) {
  for (const ScalarInput& input : inputs.scalars) {
    if (input.name == name) return &input;
  }
  return nullptr;
}

/// The list of `inputs` that declares a kind.
std::string list_of(InputKind kind) {
  switch (kind) {
    case InputKind::kPressure:
    case InputKind::kVacuum:
      return "inputs.pressures";
    case InputKind::kTension:
      return "inputs.tensions";
    case InputKind::kAngle:
      return "inputs.angles";
  }
  throw std::logic_error("kind of input without a list");
}

}  // namespace

std::string read_input(const Section& section, const std::string& key, const Inputs& inputs, InputKind wanted,
                       const std::string& user) {
  const std::string name = section.text(key);
  const ScalarInput* const input = find_input(inputs, name);
  if (input == nullptr) {
    std::string declared;
    for (const ScalarInput& known : inputs.scalars) {
      if (list_of(known.kind) == list_of(wanted)) declared += (declared.empty() ? "" : ", ") + known.name;
    }
    section.fail_value(key, fmt::format("is no input of {}; declared: {}", list_of(wanted),
                                        declared.empty() ? "none" : declared));
  }
  if (input->kind == wanted) return name;
  if (list_of(input->kind) != list_of(wanted)) {
    section.fail_value(
        key, fmt::format("is one of {}; {} needs one of {}", list_of(input->kind), user, list_of(wanted)));
  }
  section.fail_value(key, wanted == InputKind::kVacuum
                              ? "is not a vacuum input; mark it `vacuum: true` in inputs.pressures"
                              : fmt::format("is a vacuum input; {} needs a pressure", user));
}

double read_direction_rad(const Section& section) {
  return section.number("bending_direction_deg") * M_PI / 180.0;
}

}  // namespace softarm::arm::yaml
