#include "softarm/ros/input_topics.h"

#include <fmt/format.h>
#include <std_msgs/Float64.h>

#include <cmath>
#include <stdexcept>

#include "adapters.h"

namespace softarm {
namespace {

constexpr double kOtherClock_s = 2.0;  // more than any queue delays a message

template <class Table>
const auto& adapter_for(const Table& table, const std::string& type, const std::string& what) {
  const auto found = table.find(type);
  if (found != table.end()) return found->second;
  std::string known;
  for (const auto& entry : table) known += (known.empty() ? "" : ", ") + entry.first;
  throw std::invalid_argument(
      fmt::format("{}: type '{}' cannot be read, known types are {}", what, type, known));
}

InputTopic payload_topic(const Arm& arm) {
  const auto convert = [](const std_msgs::Float64& message, double receipt_s, FrameAssembler& assembler) {
    assembler.add_payload(headerless_stamp_s(receipt_s, assembler), message.data);
  };
  return make_input_topic<std_msgs::Float64>(arm.inputs.payload_topic, "payload", convert);
}

}  // namespace

const std::map<std::string, BodyAdapter>& body_adapters() {
  static const std::map<std::string, BodyAdapter> table{
      {"geometry_msgs/PoseStamped", pose_stamped_topics},
  };
  return table;
}

const std::map<std::string, ScalarAdapter>& scalar_adapters() {
  static const std::map<std::string, ScalarAdapter> table{
      {"sensor_msgs/FluidPressure", {fluid_pressure_topic, true}},
      {"std_msgs/Float64", {float64_topic}},
      {"std_msgs/Float32MultiArray", {float32_array_topic}},
      {"std_msgs/Float64MultiArray", {float64_array_topic}},
  };
  return table;
}

std::string to_string(InputKind kind) {
  switch (kind) {
    case InputKind::kPressure:
      return "pressure";
    case InputKind::kVacuum:
      return "vacuum";
    case InputKind::kTension:
      return "tension";
    case InputKind::kAngle:
      return "angle";
  }
  throw std::logic_error("kind of input without a word");
}

double headerless_stamp_s(double receipt_s, const FrameAssembler& assembler) {
  const std::optional<double> newest = assembler.newest_s();
  return newest && std::abs(receipt_s - *newest) > kOtherClock_s ? *newest : receipt_s;
}

std::vector<std::pair<std::string, int>> body_indices(const Arm& arm) {
  std::vector<std::pair<std::string, int>> indices;
  if (arm.base.body) indices.emplace_back(*arm.base.body, FrameAssembler::kBaseBody);
  for (std::size_t i = 0; i < arm.bodies.size(); ++i)
    indices.emplace_back(arm.bodies[i].name, static_cast<int>(i));
  return indices;
}

std::string body_topic(const Arm& arm, const std::string& body) {
  static const std::string kPlaceholder = "<body>";
  std::string topic = arm.inputs.body_topic;
  const std::size_t at = topic.find(kPlaceholder);
  return at == std::string::npos ? topic : topic.replace(at, kPlaceholder.size(), body);
}

std::vector<InputTopic> input_topics(const Arm& arm) {
  std::vector<InputTopic> topics =
      adapter_for(body_adapters(), arm.inputs.body_type, "arm '" + arm.name + "', bodies")(arm);
  std::map<std::pair<std::string, std::string>, std::vector<int>> by_topic;
  for (std::size_t i = 0; i < arm.inputs.scalars.size(); ++i) {
    const ScalarInput& input = arm.inputs.scalars[i];
    const std::string what = fmt::format("arm '{}', {} '{}'", arm.name, to_string(input.kind), input.name);
    const ScalarAdapter& adapter = adapter_for(scalar_adapters(), input.type, what);
    const bool is_pressure = input.kind == InputKind::kPressure || input.kind == InputKind::kVacuum;
    if (adapter.pressures_only && !is_pressure) {
      throw std::invalid_argument(
          fmt::format("{}: type '{}' is for pressures; use std_msgs/Float64 or an array", what, input.type));
    }
    by_topic[{input.topic, input.type}].push_back(static_cast<int>(i));
  }
  for (const auto& [key, inputs] : by_topic) {
    topics.push_back(scalar_adapters().at(key.second).make(arm, key.first, inputs));
  }
  if (!arm.inputs.payload_topic.empty()) topics.push_back(payload_topic(arm));
  return topics;
}

}  // namespace softarm
