// Arm files.
#include <fmt/format.h>
#include <pybind11/stl.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>

#include "arm/arm_writer.h"
#include "arm/edit_distance.h"
#include "arm/effect_correlations.h"
#include "arm/input_kind.h"
#include "arm_handle.h"
#include "arrays.h"
#include "math/parse_number.h"
#include "parts.h"
#include "softarm/arm/laws.h"
#include "softarm/effects/arm_effects.h"

namespace softarm::python {
namespace {

py::object python_of(const YAML::Node& node) {
  if (node.IsSequence()) {
    py::list list;
    for (const YAML::Node& item : node) list.append(python_of(item));
    return std::move(list);
  }
  if (node.IsMap()) {
    py::dict dict;
    for (const auto& item : node) dict[py::str(item.first.Scalar())] = python_of(item.second);
    return std::move(dict);
  }
  if (!node.IsScalar()) return py::none();
  const std::string& word = node.Scalar();
  if (node.Tag() != "!") {  // not in quotes
    if (word == "true" || word == "false") return py::bool_(word == "true");
    if (const auto number = math::parse_number(word)) {
      const bool whole = word.find_first_not_of("0123456789", word[0] == '-' ? 1 : 0) == std::string::npos;
      if (whole) return py::reinterpret_steal<py::object>(PyLong_FromString(word.c_str(), nullptr, 10));
      return py::float_(*number);
    }
  }
  return py::str(word);
}

py::dict keys_of(const ArmHandle& handle) {
  return py::cast<py::dict>(python_of(YAML::Load(handle.text)));
}

py::list inputs_of(const ArmHandle& handle) {
  py::list list;
  for (const arm::ScalarInput& input : handle.arm.inputs.scalars) {
    py::dict one;
    one["name"] = input.name;
    one["kind"] = to_string(input.kind);
    one["unit"] = arm::unit_of(input.kind);
    one["topic"] = input.topic;
    list.append(one);
  }
  return list;
}

py::list bodies_of(const ArmHandle& handle) {
  py::list list;
  for (const arm::MeasuredBody& body : handle.arm.bodies) {
    py::dict one;
    one["name"] = body.name;
    one["kind"] = body.kind == arm::BodyKind::kRing ? "ring" : "skin_marker";
    one["arclength_m"] = body.arclength_m;
    one["orientation_usable"] = body.orientation_usable;
    one["position_sd_m"] = body.position_sd_m;
    list.append(one);
  }
  return list;
}

py::list segments_of(const ArmHandle& handle) {
  py::list list;
  for (const arm::Segment& segment : handle.arm.segments) {
    py::dict one;
    one["name"] = segment.name;
    one["length_m"] = segment.length_m;
    one["mass_kg"] = segment.mass_per_length_kg_m * segment.length_m;
    one["diameter_m"] = segment.diameter_m;
    py::list inputs;
    for (const int i : arm::inputs_of(handle.arm, segment))
      inputs.append(handle.arm.inputs.scalars[static_cast<std::size_t>(i)].name);
    one["inputs"] = inputs;
    list.append(one);
  }
  return list;
}

py::list constants_of(const ArmHandle& handle) {
  py::list list;
  for (const arm::ConstantRef& constant : arm::constants_of(handle.arm)) {
    const arm::Range range = arm::allowed_range(handle.arm, constant);
    py::dict one;
    one["name"] = arm::name_of(handle.arm, constant);
    one["unit"] = arm::unit_of(constant.kind);
    one["value"] = arm::value_of(handle.arm, constant);
    one["low"] = range.low;
    one["high"] = range.high;
    one["stated"] = arm::is_stated(handle.arm, constant);
    list.append(one);
  }
  return list;
}

py::list effects_of(const ArmHandle& handle) {
  py::list list;
  for (const arm::EffectEntry& entry : handle.entries) {
    py::dict one, numbers, sd;
    for (const arm::EffectNumber& number : entry.numbers) {
      numbers[py::str(number.name)] = number.value;
      if (number.sd) sd[py::str(number.name)] = *number.sd;
    }
    one["id"] = entry.id;
    one["numbers"] = numbers;
    one["sd"] = sd;
    list.append(one);
  }
  return list;
}

/// Of all numbers with a standard deviation, in the order of the file; what the file does not correlate has
/// 0.
py::dict effects_correlations_of(const ArmHandle& handle) {
  const std::vector<arm::EffectEntry>& entries = handle.entries;
  std::vector<std::string> names;
  std::vector<double> sd;
  for (const arm::EffectNumberAt& at : arm::uncertain_numbers(entries)) {
    const arm::EffectNumber& number = entries[at.entry].numbers[at.number];
    names.push_back(arm::name_in_file(entries, at.entry, number.name));
    sd.push_back(*number.sd);
  }
  const std::size_t n = names.size();
  const auto place = [&](std::size_t entry, const std::string& number) {
    const auto found = std::find(names.begin(), names.end(), arm::name_in_file(entries, entry, number));
    return static_cast<std::size_t>(found - names.begin());  // the parser refuses those that are not there
  };
  std::vector<double> matrix(n * n, 0.0);
  for (std::size_t i = 0; i < n; ++i) matrix[i * n + i] = 1.0;
  for (std::size_t e = 0; e < entries.size(); ++e) {
    for (const arm::EffectNumber& number : entries[e].numbers) {
      for (const arm::EffectCorrelation& with : number.correlations) {
        const std::size_t i = place(e, number.name), j = place(with.entry, with.number);
        matrix[i * n + j] = matrix[j * n + i] = with.value;
      }
    }
  }
  const auto count = static_cast<Py_ssize_t>(n);
  py::dict all;
  all["names"] = names;
  all["sd"] = array_of(std::move(sd), {count});
  all["matrix"] = array_of(std::move(matrix), {count, count});
  return all;
}

Arm with_constants(const ArmHandle& handle, const std::map<std::string, double>& values) {
  arm::Arm changed = handle.arm;
  for (const auto& [name, value] : values) {
    const arm::ConstantRef constant = handle.constant(name);
    const arm::Range range = arm::allowed_range(handle.arm, constant);
    if (!(value >= range.low && value <= range.high))
      throw std::invalid_argument(fmt::format("{}: {} must be from {} to {} {}", name, value, range.low,
                                              range.high, arm::unit_of(constant.kind)));
    arm::set_value(changed, constant, value);
  }
  return std::make_shared<ArmHandle>(arm::update_arm_text(handle.text, handle.source, changed),
                                     handle.source);
}

}  // namespace

ArmHandle::ArmHandle(std::string text_of_file, std::string source_of_text)
    : text(std::move(text_of_file)),
      source(std::move(source_of_text)),
      arm(arm::parse_arm(text, source)),
      entries(arm::parse_effect_entries(text, source)) {
  effects = effects::effects_of(arm, entries);
}

arm::ConstantRef ArmHandle::constant(const std::string& name) const {
  std::vector<std::string> names;
  for (const arm::ConstantRef& constant : arm::constants_of(arm)) {
    names.push_back(arm::name_of(arm, constant));
    if (names.back() == name) return constant;
  }
  const auto meant = arm::yaml::nearest_word(name, names);
  throw std::invalid_argument(fmt::format("{}: the arm {} has no constant of that name{}", name, arm.name,
                                          meant ? "; did you mean " + *meant + "?" : ""));
}

void add_arm(py::module& module) {
  py::class_<ArmHandle, std::shared_ptr<ArmHandle>>(module, "ArmHandle", "An arm file, parsed.")
      .def(py::init<std::string, std::string>(), py::arg("text"), py::arg("source"))
      .def_readonly("text", &ArmHandle::text)
      .def_readonly("source", &ArmHandle::source)
      .def_property_readonly("name", [](const ArmHandle& h) { return h.arm.name; })
      .def_property_readonly("length_m", [](const ArmHandle& h) { return h.arm.total_length_m(); })
      .def_property_readonly(
          "gravity_base_m_s2",
          [](const ArmHandle& h) {
            const Eigen::Vector3d g = h.arm.base.body
                                          ? h.arm.gravity_m_s2
                                          : h.arm.base.fixed_pose.linear().transpose() * h.arm.gravity_m_s2;
            return std::vector<double>(g.data(), g.data() + 3);
          },
          "With the base's pose of the file; of a measured base as if its axes were the mocap's.")
      .def_property_readonly("has_base_body", [](const ArmHandle& h) { return h.arm.base.body.has_value(); })
      .def("keys", &keys_of)
      .def("inputs", &inputs_of)
      .def("bodies", &bodies_of)
      .def("segments", &segments_of)
      .def("constants", &constants_of)
      .def("effects", &effects_of)
      .def("effects_correlations", &effects_correlations_of)
      .def("with_constants", &with_constants, py::arg("values"));
  module.def(
      "find_arm",
      [](const std::string& name, const std::vector<std::string>& folders) {
        const arm::ArmText found = arm::read_arm_text(name, folders);
        return std::make_shared<ArmHandle>(found.text, found.source);
      },
      py::arg("name"), py::arg("folders"));
  module.def("arm_names", &arm::arm_names, py::arg("folders"));
  module.def("arm_keys", &arm::describe_arm_keys);
  module.def(
      "keys_of_yaml", [](const std::string& text) { return python_of(YAML::Load(text)); }, py::arg("text"));
}

}  // namespace softarm::python
