// The converters of scalar_adapters(), by message.
#pragma once

#include <string>
#include <vector>

#include "input_topics.h"

namespace softarm {

InputTopic fluid_pressure_topic(const arm::Arm& arm, const std::string& topic,
                                const std::vector<int>& inputs);
InputTopic float64_topic(const arm::Arm& arm, const std::string& topic, const std::vector<int>& inputs);
InputTopic float32_array_topic(const arm::Arm& arm, const std::string& topic, const std::vector<int>& inputs);
InputTopic float64_array_topic(const arm::Arm& arm, const std::string& topic, const std::vector<int>& inputs);
/// Any other type, by ScalarInput::field.
InputTopic field_topic(const arm::Arm& arm, const std::string& topic, const std::vector<int>& inputs);

}  // namespace softarm
