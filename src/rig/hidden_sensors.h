// The tables of effects of the sensors and what their entries share: private to the rig.
#pragma once

#include <string>
#include <vector>

#include "hidden.h"
#include "scenario.h"
#include "scenario_parts.h"

namespace softarm::rig {

std::vector<HiddenEffect> pose_effects();
std::vector<HiddenEffect> camera_effects();
std::vector<HiddenEffect> tracking_effects();
std::vector<HiddenEffect> timing_effects();
std::vector<HiddenEffect> input_sensor_effects();

/// -1: all bodies, 0: base, 1: ring_1 ...
HiddenParameter body_parameter();
/// The same, without a default: for what seldom befalls all.
HiddenParameter one_body_parameter();
/// Those of a fault that is there at times; from its from_s on for ever where the scenario says nothing.
std::vector<HiddenParameter> with_times(std::vector<HiddenParameter> parameters);
/// -1: all inputs of a kind, 1: chamber_1, tendon_1 or servo_1 ...
HiddenParameter number_parameter();
/// Kinds of inputs as forms: pressure, vacuum, tension, angle.
std::vector<std::string> input_forms();
/// Streams of messages as forms: mocap, inputs.
std::vector<std::string> stream_forms();

/// @throws std::invalid_argument where the scenario has no such body
int body_of(const HiddenChoice& choice, const Scenario& scenario, const std::string& key = "body");
/// @throws std::invalid_argument where the times overlap
FaultTimes times_of(const HiddenChoice& choice);
MessageStream stream_of(const HiddenChoice& choice);
InputKind kind_of(const HiddenChoice& choice);
/// Number from 0, or kAll. @throws std::invalid_argument where the arm has no such input
int number_of(const HiddenChoice& choice, InputKind kind, const Scenario& scenario);

}  // namespace softarm::rig
