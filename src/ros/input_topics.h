// All topics that an arm listens to, from its description.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "input_topic.h"
#include "softarm/arm/arm.h"

namespace softarm {

/// Topics of bodies, inputs (pressures, tensions, angles) and payload, each once however many inputs it
/// feeds.
/// @throws std::invalid_argument in one line where the arm names a type that no adapter reads, or one that
/// cannot hold the input (a FluidPressure for a tension)
std::vector<InputTopic> input_topics(const arm::Arm& arm);

/// Names and indices (into Arm::bodies, or FrameAssembler::kBaseBody) of bodies.
using Bodies = std::vector<std::pair<std::string, int>>;

/// Makes one topic that feeds the given inputs (indices into Inputs::scalars), whatever their kind.
struct ScalarAdapter {
  InputTopic (*make)(const arm::Arm& arm, const std::string& topic, const std::vector<int>& inputs) = nullptr;
  bool pressures_only = false;  ///< the message says that it is a pressure
};
/// By ScalarInput::type, of inputs without a field.
const std::map<std::string, ScalarAdapter>& scalar_adapters();

/// Name and index (FrameAssembler::kBaseBody for the base) of every body of the arm.
Bodies body_indices(const arm::Arm& arm);
/// The topic on which a body comes: its source's, with its name filled in.
std::string body_topic(const arm::Arm& arm, const std::string& body);

}  // namespace softarm
