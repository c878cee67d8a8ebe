// Pressures, tensions, angles: std_msgs numbers and arrays without a stamp; pressures also as
// sensor_msgs/FluidPressure, with its own; and fields of messages of any other type.
#include "scalar_adapters.h"

#include <sensor_msgs/FluidPressure.h>
#include <std_msgs/Float32MultiArray.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Float64MultiArray.h>

#include <limits>

#include "any_input_topic.h"
#include "message_schema.h"

namespace softarm {
namespace {

struct Target {
  int input;
  int element;
  double scale_to_si;
  std::string field;
  arm::StampSource stamp;
};

/// Stamp of a sample: the header's where it counts and is there (rigs that never stamp their commands leave
/// zero), else that of receipt.
trial::Stamp stamp_for(const Target& target, trial::Stamp header, trial::Stamp receipt,
                       const trial::FrameAssembler& assembler) {
  const bool by_header = target.stamp == arm::StampSource::kHeader && header.s > 0.0;
  return by_header ? header : headerless_stamp(receipt, assembler);
}

std::vector<Target> targets_of(const arm::Arm& arm, const std::vector<int>& inputs) {
  std::vector<Target> targets;
  for (int i : inputs) {
    const arm::ScalarInput& input = arm.inputs.scalars.at(static_cast<std::size_t>(i));
    targets.push_back({i, input.element, input.scale_to_si, input.field, input.stamp});
  }
  return targets;
}

std::string names_of(const arm::Arm& arm, const std::vector<int>& inputs) {
  std::string names;
  for (int i : inputs) {
    names += (names.empty() ? "" : ", ") + arm.inputs.scalars.at(static_cast<std::size_t>(i)).name;
  }
  return names;
}

template <class Array>
InputTopic array_topic(const arm::Arm& arm, const std::string& topic, const std::vector<int>& inputs) {
  const auto convert = [targets = targets_of(arm, inputs)](const Array& message, trial::Stamp receipt,
                                                           trial::FrameAssembler& assembler) {
    const trial::Stamp stamp = headerless_stamp(receipt, assembler);
    for (const Target& target : targets) {
      const auto element = static_cast<std::size_t>(target.element);
      // An element that is not there is no number: the assembler rejects and counts it under the input's
      // name.
      const double value =
          element < message.data.size() ? message.data[element] : std::numeric_limits<double>::quiet_NaN();
      assembler.add_input(target.input, stamp, target.scale_to_si * value);
    }
  };
  return make_input_topic<Array>(topic, names_of(arm, inputs), convert);
}

}  // namespace

InputTopic fluid_pressure_topic(const arm::Arm& arm, const std::string& topic,
                                const std::vector<int>& inputs) {
  const auto convert = [targets = targets_of(arm, inputs)](const sensor_msgs::FluidPressure& message,
                                                           trial::Stamp receipt,
                                                           trial::FrameAssembler& assembler) {
    for (const Target& target : targets) {
      assembler.add_input(target.input, stamp_for(target, to_stamp(message.header.stamp), receipt, assembler),
                          target.scale_to_si * message.fluid_pressure);
    }
  };
  return make_input_topic<sensor_msgs::FluidPressure>(topic, names_of(arm, inputs), convert);
}

InputTopic float64_topic(const arm::Arm& arm, const std::string& topic, const std::vector<int>& inputs) {
  const auto convert = [targets = targets_of(arm, inputs)](const std_msgs::Float64& message,
                                                           trial::Stamp receipt,
                                                           trial::FrameAssembler& assembler) {
    const trial::Stamp stamp = headerless_stamp(receipt, assembler);
    for (const Target& target : targets) {
      assembler.add_input(target.input, stamp, target.scale_to_si * message.data);
    }
  };
  return make_input_topic<std_msgs::Float64>(topic, names_of(arm, inputs), convert);
}

InputTopic float32_array_topic(const arm::Arm& arm, const std::string& topic,
                               const std::vector<int>& inputs) {
  return array_topic<std_msgs::Float32MultiArray>(arm, topic, inputs);
}

InputTopic float64_array_topic(const arm::Arm& arm, const std::string& topic,
                               const std::vector<int>& inputs) {
  return array_topic<std_msgs::Float64MultiArray>(arm, topic, inputs);
}

InputTopic field_topic(const arm::Arm& arm, const std::string& topic, const std::vector<int>& inputs) {
  const auto convert = [targets = targets_of(arm, inputs)](const nlohmann::json& message,
                                                           trial::Stamp receipt,
                                                           trial::FrameAssembler& assembler) {
    const trial::Stamp header = header_stamp(message).value_or(trial::Stamp());
    for (const Target& target : targets) {
      // A field that is not there is no number: the assembler rejects and counts it under the input's name.
      assembler.add_input(target.input, stamp_for(target, header, receipt, assembler),
                          target.scale_to_si * number_at(message, target.field));
    }
  };
  const std::string& type = arm.inputs.scalars.at(static_cast<std::size_t>(inputs.front())).type;
  return make_any_input_topic(topic, type, names_of(arm, inputs), convert);
}

}  // namespace softarm
