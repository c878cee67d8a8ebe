// The adapters of the tables in input_topics.cpp, each in a file of its own.
#pragma once

#include <string>
#include <vector>

#include "input_topics.h"

namespace softarm {

/// "base, ring_1": what a topic that holds all of them feeds.
std::string names_of(const Bodies& bodies);

std::vector<InputTopic> pose_stamped_topics(const arm::Arm& arm, const arm::BodySource& source,
                                            const Bodies& bodies);
std::vector<InputTopic> transform_stamped_topics(const arm::Arm& arm, const arm::BodySource& source,
                                                 const Bodies& bodies);
std::vector<InputTopic> odometry_topics(const arm::Arm& arm, const arm::BodySource& source,
                                        const Bodies& bodies);
std::vector<InputTopic> point_stamped_topics(const arm::Arm& arm, const arm::BodySource& source,
                                             const Bodies& bodies);
std::vector<InputTopic> tf_topics(const arm::Arm& arm, const arm::BodySource& source, const Bodies& bodies);

std::vector<InputTopic> vicon_marker_topics(const arm::Arm& arm, const arm::BodySource& source,
                                            const Bodies& bodies);
std::vector<InputTopic> mocap_marker_topics(const arm::Arm& arm, const arm::BodySource& source,
                                            const Bodies& bodies);
std::vector<InputTopic> phasespace_marker_topics(const arm::Arm& arm, const arm::BodySource& source,
                                                 const Bodies& bodies);
std::vector<InputTopic> phasespace_stamped_topics(const arm::Arm& arm, const arm::BodySource& source,
                                                  const Bodies& bodies);

std::vector<InputTopic> point_cloud_topics(const arm::Arm& arm, const arm::BodySource& source,
                                           const Bodies& bodies);
std::vector<InputTopic> point_cloud2_topics(const arm::Arm& arm, const arm::BodySource& source,
                                            const Bodies& bodies);
std::vector<InputTopic> drawn_points_topics(const arm::Arm& arm, const arm::BodySource& source,
                                            const Bodies& bodies);

InputTopic fluid_pressure_topic(const arm::Arm& arm, const std::string& topic,
                                const std::vector<int>& inputs);
InputTopic float64_topic(const arm::Arm& arm, const std::string& topic, const std::vector<int>& inputs);
InputTopic float32_array_topic(const arm::Arm& arm, const std::string& topic, const std::vector<int>& inputs);
InputTopic float64_array_topic(const arm::Arm& arm, const std::string& topic, const std::vector<int>& inputs);
/// Any other type, by ScalarInput::field.
InputTopic field_topic(const arm::Arm& arm, const std::string& topic, const std::vector<int>& inputs);

}  // namespace softarm
