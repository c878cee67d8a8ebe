#include "input_topics.h"

#include <fmt/format.h>
#include <std_msgs/Float64.h>

#include <cmath>
#include <stdexcept>

#include "arm/input_kind.h"
#include "body_driver.h"
#include "body_reader.h"
#include "scalar_adapters.h"

namespace softarm {
namespace {

constexpr double kOtherEpoch_s = 2.0;  // more than any queue delays a message

template <class Table>
const auto& adapter_for(const Table& table, const std::string& type, const std::string& what) {
  const auto found = table.find(type);
  if (found != table.end()) return found->second;
  std::string known;
  for (const auto& entry : table) known += (known.empty() ? "" : ", ") + entry.first;
  throw std::invalid_argument(
      fmt::format("{}: type '{}' cannot be read, known types are {}", what, type, known));
}

InputTopic payload_topic(const arm::Arm& arm) {
  const auto convert = [](const std_msgs::Float64& message, trial::Stamp receipt,
                          trial::FrameAssembler& assembler) {
    assembler.add_payload(headerless_stamp(receipt, assembler), message.data);
  };
  InputTopic topic = make_input_topic<std_msgs::Float64>(arm.inputs.payload_topic, "payload", convert);
  topic.many_publish = true;  // whoever hangs another one
  return topic;
}

/// The topics of the base's body and of the measured ones, which may come two ways.
std::vector<InputTopic> body_topics(const arm::Arm& arm) {
  Bodies base, rest;
  for (const auto& body : body_indices(arm)) {
    (arm.inputs.base && body.second == trial::FrameAssembler::kBaseBody ? base : rest).push_back(body);
  }
  std::vector<InputTopic> topics;
  const auto add = [&](const arm::BodySource& source, const Bodies& bodies) {
    for (InputTopic& topic : adapter_for(body_drivers(), source.type, "arm '" + arm.name + "', bodies")
                                 .topics(arm, source, bodies)) {
      for (const auto& [name, index] : bodies) {
        if (topic.feeds != name && topic.feeds != names_of(bodies)) continue;
        (index == trial::FrameAssembler::kBaseBody ? topic.feeds_base : topic.feeds_bodies) = true;
      }
      topics.push_back(std::move(topic));
    }
  };
  if (!base.empty()) add(*arm.inputs.base, base);
  add(arm.inputs.bodies, rest);
  return topics;
}

}  // namespace

const std::map<std::string, ScalarAdapter>& scalar_adapters() {
  static const std::map<std::string, ScalarAdapter> table{
      {"sensor_msgs/FluidPressure", {fluid_pressure_topic, true}},
      {"std_msgs/Float64", {float64_topic}},
      {"std_msgs/Float32MultiArray", {float32_array_topic}},
      {"std_msgs/Float64MultiArray", {float64_array_topic}},
  };
  return table;
}

trial::Stamp headerless_stamp(trial::Stamp receipt, const trial::FrameAssembler& assembler) {
  const std::optional<double> newest = assembler.newest_s();
  return newest && std::abs(receipt.s - *newest) > kOtherEpoch_s ? trial::Stamp(*newest) : receipt;
}

Bodies body_indices(const arm::Arm& arm) {
  Bodies indices;
  if (arm.base.body) indices.emplace_back(*arm.base.body, trial::FrameAssembler::kBaseBody);
  for (std::size_t i = 0; i < arm.bodies.size(); ++i)
    indices.emplace_back(arm.bodies[i].name, static_cast<int>(i));
  return indices;
}

std::string body_topic(const arm::Arm& arm, const std::string& body) {
  const bool is_base = arm.inputs.base && arm.base.body == body;
  return with_body((is_base ? *arm.inputs.base : arm.inputs.bodies).topic, body);
}

std::string names_of(const Bodies& bodies) {
  std::string names;
  for (const auto& entry : bodies) names += (names.empty() ? "" : ", ") + entry.first;
  return names;
}

std::vector<InputTopic> input_topics(const arm::Arm& arm) {
  std::vector<InputTopic> topics = body_topics(arm);
  std::map<std::pair<std::string, std::string>, std::vector<int>> by_topic;
  for (std::size_t i = 0; i < arm.inputs.scalars.size(); ++i) {
    const arm::ScalarInput& input = arm.inputs.scalars[i];
    const std::string what = fmt::format("arm '{}', {} '{}'", arm.name, to_string(input.kind), input.name);
    by_topic[{input.topic, input.type}].push_back(static_cast<int>(i));
    if (!input.field.empty()) continue;
    const ScalarAdapter& adapter = adapter_for(scalar_adapters(), input.type, what);
    const bool is_pressure = input.kind == arm::InputKind::kPressure || input.kind == arm::InputKind::kVacuum;
    if (adapter.pressures_only && !is_pressure) {
      throw std::invalid_argument(
          fmt::format("{}: type '{}' is for pressures; use std_msgs/Float64 or an array", what, input.type));
    }
  }
  for (const auto& [key, inputs] : by_topic) {
    const auto adapter = scalar_adapters().find(key.second);
    topics.push_back(adapter == scalar_adapters().end() ? field_topic(arm, key.first, inputs)
                                                        : adapter->second.make(arm, key.first, inputs));
  }
  if (!arm.inputs.payload_topic.empty()) topics.push_back(payload_topic(arm));
  return topics;
}

}  // namespace softarm
