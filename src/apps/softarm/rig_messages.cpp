#include "rig_messages.h"

#include <algorithm>
#include <set>
#include <variant>

namespace softarm::app {
namespace {

/// Topics of the rig's own, as a laboratory without an arm file is asked to have them.
arm::Inputs usual_inputs(const rig::Scenario& scenario) {
  arm::Inputs inputs;
  inputs.ambient_pressure_pa = scenario.pressures.ambient_pa;
  const auto add = [&](arm::InputKind kind, rig::InputKind rigs, int count, const char* type) {
    for (int i = 0; i < count; ++i) {
      arm::ScalarInput input;
      input.kind = kind;
      input.topic = rig::topic_of(rigs, i);
      input.type = type;
      inputs.scalars.push_back(input);
    }
  };
  const char *pressure = "sensor_msgs/FluidPressure", *number = "std_msgs/Float64";
  add(arm::InputKind::kPressure, rig::InputKind::kChamber, scenario.arm.chambers, pressure);
  add(arm::InputKind::kVacuum, rig::InputKind::kVacuum, scenario.vacuum.schedule.empty() ? 0 : 1, pressure);
  add(arm::InputKind::kTension, rig::InputKind::kTendon, scenario.arm.tendons, number);
  add(arm::InputKind::kAngle, rig::InputKind::kServo, scenario.arm.servos, number);
  return inputs;
}

std::set<std::string> names_that_drive(const arm::Arm& arm) {
  std::set<std::string> names;
  for (const arm::Segment& segment : arm.segments) {
    for (const arm::Chamber& chamber : segment.chambers) names.insert(chamber.input);
    for (const arm::Tendon& tendon : segment.tendons) names.insert(tendon.input);
    for (const arm::Cable& cable : segment.cables) names.insert(cable.input);
    if (segment.central_chamber) names.insert(segment.central_chamber->input);
    if (segment.jamming_input) names.insert(*segment.jamming_input);
  }
  return names;
}

}  // namespace

std::vector<std::size_t> driven_inputs(const arm::Arm& arm, arm::InputKind kind) {
  const std::set<std::string> names = names_that_drive(arm);
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < arm.inputs.scalars.size(); ++i) {
    const arm::ScalarInput& input = arm.inputs.scalars[i];
    if (input.kind == kind && names.count(input.name) > 0) found.push_back(i);
  }
  return found;
}

Eigen::Quaterniond to_arms_mocap(const arm::Arm& arm) {
  if (arm.gravity_m_s2.head<2>().isZero(0.0) && arm.gravity_m_s2.z() <= 0.0)
    return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond::FromTwoVectors(-Eigen::Vector3d::UnitZ(), arm.gravity_m_s2);
}

RigMessages::RigMessages(const rig::Simulator& simulator, const std::optional<arm::Arm>& arm)
    : bodies_(simulator.body_names()),
      base_measured_(simulator.scenario().mocap.base_measured),
      payload_(simulator.scenario().payload.publish) {
  arm::Arm usual;
  if (arm) {
    turn_ = to_arms_mocap(*arm);
  } else {
    usual.inputs = usual_inputs(simulator.scenario());
  }
  const arm::Inputs& inputs = arm ? arm->inputs : usual.inputs;
  std::vector<std::size_t> driven;
  const std::pair<arm::InputKind, rig::InputKind> kinds[] = {
      {arm::InputKind::kPressure, rig::InputKind::kChamber},
      {arm::InputKind::kVacuum, rig::InputKind::kVacuum},
      {arm::InputKind::kTension, rig::InputKind::kTendon},
      {arm::InputKind::kAngle, rig::InputKind::kServo}};
  for (const auto& [kind, rigs] : kinds) {
    std::vector<std::size_t> of_kind;
    if (arm) of_kind = driven_inputs(*arm, kind);
    for (std::size_t i = 0; !arm && i < inputs.scalars.size(); ++i)
      if (inputs.scalars[i].kind == kind) of_kind.push_back(i);
    // The rig has one vacuum for all cores.
    for (std::size_t i = 0; i < of_kind.size(); ++i)
      inputs_[{rigs, rigs == rig::InputKind::kVacuum ? 0 : static_cast<int>(i)}].push_back(of_kind[i]);
    driven.insert(driven.end(), of_kind.begin(), of_kind.end());
  }
  std::sort(driven.begin(), driven.end());
  messages_.emplace(inputs, driven);
}

std::vector<LabMessage> RigMessages::of(const rig::Received& received, const StampOf& stamp_of) {
  if (const auto* payload = std::get_if<rig::PayloadSample>(&received.message))
    return {messages_->payload(payload->kg)};
  if (const auto* pose = std::get_if<rig::PoseSample>(&received.message))
    return {messages_->body(bodies_.at(pose->body), is_base(pose->body), stamp_of(pose->stamp_s),
                            turn_ * pose->pose.p, turn_ * pose->pose.q)};
  const auto& input = std::get<rig::InputSample>(received.message);
  std::vector<LabMessage> messages;
  for (std::size_t scalar : inputs_[{input.kind, input.number}])
    if (auto message = messages_->scalar(scalar, stamp_of(input.stamp_s), input.value))
      messages.push_back(std::move(*message));
  return messages;
}

std::vector<LabMessage> RigMessages::blank() const {
  std::vector<LabMessage> messages = messages_->blank_scalars();
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    messages.push_back(messages_->body(bodies_[i], is_base(i), ros::Time(), Eigen::Vector3d::Zero(),
                                       Eigen::Quaterniond::Identity()));
  if (payload_) messages.push_back(messages_->payload(0.0));
  return messages;
}

}  // namespace softarm::app
