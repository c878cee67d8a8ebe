// Pressures, tensions, angles: std_msgs numbers and arrays without a stamp; pressures also as
// sensor_msgs/FluidPressure, with its own.
#include <sensor_msgs/FluidPressure.h>
#include <std_msgs/Float32MultiArray.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Float64MultiArray.h>

#include <limits>

#include "adapters.h"

namespace softarm {
namespace {

struct Target {
  int input;
  int element;
  double scale_to_si;
};

std::vector<Target> targets_of(const Arm& arm, const std::vector<int>& inputs) {
  std::vector<Target> targets;
  for (int i : inputs) {
    const ScalarInput& input = arm.inputs.scalars.at(static_cast<std::size_t>(i));
    targets.push_back({i, input.element, input.scale_to_si});
  }
  return targets;
}

std::string names_of(const Arm& arm, const std::vector<int>& inputs) {
  std::string names;
  for (int i : inputs) {
    names += (names.empty() ? "" : ", ") + arm.inputs.scalars.at(static_cast<std::size_t>(i)).name;
  }
  return names;
}

template <class Array>
InputTopic array_topic(const Arm& arm, const std::string& topic, const std::vector<int>& inputs) {
  const auto convert = [targets = targets_of(arm, inputs)](const Array& message, double receipt_s,
                                                           FrameAssembler& assembler) {
    const double stamp_s = headerless_stamp_s(receipt_s, assembler);
    for (const Target& target : targets) {
      const auto element = static_cast<std::size_t>(target.element);
      // An element that is not there is no number: the assembler rejects and counts it under the input's
      // name.
      const double value =
          element < message.data.size() ? message.data[element] : std::numeric_limits<double>::quiet_NaN();
      assembler.add_input(target.input, stamp_s, target.scale_to_si * value);
    }
  };
  return make_input_topic<Array>(topic, names_of(arm, inputs), convert);
}

}  // namespace

InputTopic fluid_pressure_topic(const Arm& arm, const std::string& topic, const std::vector<int>& inputs) {
  const auto convert = [targets = targets_of(arm, inputs)](const sensor_msgs::FluidPressure& message,
                                                           double receipt_s, FrameAssembler& assembler) {
    // Rigs that never stamp their commands leave zero.
    const double stamp_s = message.header.stamp.isZero() ? headerless_stamp_s(receipt_s, assembler)
                                                         : message.header.stamp.toSec();
    for (const Target& target : targets) {
      assembler.add_input(target.input, stamp_s, target.scale_to_si * message.fluid_pressure);
    }
  };
  return make_input_topic<sensor_msgs::FluidPressure>(topic, names_of(arm, inputs), convert);
}

InputTopic float64_topic(const Arm& arm, const std::string& topic, const std::vector<int>& inputs) {
  const auto convert = [targets = targets_of(arm, inputs)](const std_msgs::Float64& message, double receipt_s,
                                                           FrameAssembler& assembler) {
    const double stamp_s = headerless_stamp_s(receipt_s, assembler);
    for (const Target& target : targets) {
      assembler.add_input(target.input, stamp_s, target.scale_to_si * message.data);
    }
  };
  return make_input_topic<std_msgs::Float64>(topic, names_of(arm, inputs), convert);
}

InputTopic float32_array_topic(const Arm& arm, const std::string& topic, const std::vector<int>& inputs) {
  return array_topic<std_msgs::Float32MultiArray>(arm, topic, inputs);
}

InputTopic float64_array_topic(const Arm& arm, const std::string& topic, const std::vector<int>& inputs) {
  return array_topic<std_msgs::Float64MultiArray>(arm, topic, inputs);
}

}  // namespace softarm
