// The parts of an arm, each read from its section of the YAML.
#pragma once

#include <optional>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/arm/arm_file.h"
#include "yaml_section.h"

namespace softarm::arm::yaml {

/// position_m with quaternion_xyzw or rpy_deg.
Eigen::Isometry3d read_transform(const Section& section);
/// @param gravity_m_s2 in the mocap frame: what `attitude` refers to
Base read_base(const Section& section, const Eigen::Vector3d& gravity_m_s2);
Inputs read_inputs(const Section& section);
/// The labelled_markers of a body or of the base.
std::vector<LabelledMarker> read_labelled_markers(const Section& body);
/// Checks the bodies against what their sources report. @param root the whole document
void check_sources(const Section& root, const Arm& arm);
std::vector<Segment> read_segments(const Section& arm, const Inputs& inputs);
/// @param base_body must not be among them
std::vector<MeasuredBody> read_bodies(const Section& arm, const std::optional<std::string>& base_body,
                                      double total_length_m);
PayloadMount read_payload(const Section& section, double total_length_m);
/// Checks the options against what the arm offers.
EstimatorOptions read_estimator(const Section& section, const Arm& arm);

/// Ids, names and numbers as they stand; effects/ knows which there are.
std::vector<EffectEntry> read_effects(const Section& arm);
std::optional<std::string> read_effects_verdict(const Section& arm);

}  // namespace softarm::arm::yaml
