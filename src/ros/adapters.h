// The adapters of the table in input_topics.cpp, each in a file of its own.
#pragma once

#include <string>
#include <vector>

#include "softarm/ros/input_topics.h"

namespace softarm {

std::vector<InputTopic> pose_stamped_topics(const Arm& arm);

InputTopic fluid_pressure_topic(const Arm& arm, const std::string& topic, const std::vector<int>& inputs);
InputTopic float64_topic(const Arm& arm, const std::string& topic, const std::vector<int>& inputs);
InputTopic float32_array_topic(const Arm& arm, const std::string& topic, const std::vector<int>& inputs);
InputTopic float64_array_topic(const Arm& arm, const std::string& topic, const std::vector<int>& inputs);

}  // namespace softarm
