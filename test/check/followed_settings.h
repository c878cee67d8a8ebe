// Settings that findings propose, followed to the letter in an arm file and a layout.
#pragma once

#include <gmock/gmock.h>
#include <yaml-cpp/yaml.h>

#include <regex>
#include <stdexcept>
#include <string>
#include <vector>

#include "check_fixture.h"
#include "softarm/arm/arm_file.h"
#include "trial/csv_layout.h"

namespace softarm::testing_check {

inline constexpr char kArm[] = R"(
format: 1
name: hanging
base: {body: base, rod_in_body: {rpy_deg: [0, 0, 0]}}
segments:
  - name: upper
    length_m: 0.2
    length_range_m: [0.19, 0.21]
    mass_per_length_kg_m: 0.1
    diameter_m: 0.04
    bending_stiffness: {base_nm2: 0.03}
    chambers:
      - {input: chamber_1, bending_direction_deg: 0, moment_gain_nm_per_pa: 8.0e-6}
      - {input: chamber_2, bending_direction_deg: 180, moment_gain_nm_per_pa: 8.0e-6}
payload: {arclength_m: 0.2}
noise: {position_sd_m: 0.0002, orientation_sd_rad: 0.01}
bodies:
  - {name: ring_1, arclength_m: 0.0666667, orientation_usable: true, section_in_body: {rpy_deg: [0, 0, 0]}}
  - {name: ring_2, arclength_m: 0.1333333, orientation_usable: true, position_sd_m: 0.0002}
  - {name: ring_3, arclength_m: tip, orientation_usable: true}
inputs:
  pressures:
    - {name: chamber_1, topic: /pressure/chamber_1}
    - {name: chamber_2, topic: /pressure/chamber_2}
)";

inline constexpr char kImportLayout[] = R"(
time: {column: 1, unit: s}
mocap:
  unit: m
  up: y
  bodies:
    - {name: base, position: [2, 3, 4], orientation: [5, 6, 7, 8], orientation_order: xyzw}
    - {name: ring_3, position: [9, 10, 11]}
pressures:
  unit: psi
  reference: gauge
  inputs: [{topic: /pressure/chamber_1, column: 12}, {topic: /pressure/chamber_2, column: 13}]
)";

/// Entry of a list by its number, or by its name or topic.
inline YAML::Node entry(const YAML::Node& list, const std::string& which) {
  if (which.find_first_not_of("0123456789") == std::string::npos)
    return list[static_cast<std::size_t>(std::stoul(which))];
  for (YAML::Node item : list) {
    for (const char* key : {"name", "topic"}) {
      if (item[key] && item[key].as<std::string>() == which) return item;
    }
  }
  throw std::runtime_error("no entry " + which);
}

inline void set(YAML::Node node, std::string path, const std::string& value) {
  static const std::regex kStep(R"(^([a-z_0-9]+)(\[([^\]]+)\])?(\.|$))");
  for (std::smatch step; std::regex_search(path, step, kStep);) {
    const std::string key = step[1], which = step[3];
    const bool last = step.suffix().str().empty() && !step[2].matched;
    if (last) {
      node[key] = YAML::Load(value);
      if (key == "orientation_order" || key == "fixed_orientation") {
        node.remove("orientation");  // as the layout's template says of it: in place of both
        node.remove("orientation_order");
      }
      return;
    }
    node.reset(step[2].matched ? entry(node[key], which) : node[key]);
    path = step.suffix();
  }
  throw std::runtime_error("cannot be followed: " + path);
}

struct Step {
  std::string path, value;
  bool of_layout = false;
};

inline std::vector<Step> steps_of(std::string setting) {
  static const std::string kOfTheLayout = " (of the layout)";
  std::vector<Step> steps;
  while (!setting.empty()) {
    const std::size_t end = setting.find("; ");
    std::string one = setting.substr(0, end);
    setting = end == std::string::npos ? "" : setting.substr(end + 2);
    const bool of_layout =
        one.size() > kOfTheLayout.size() &&
        one.compare(one.size() - kOfTheLayout.size(), kOfTheLayout.size(), kOfTheLayout) == 0;
    if (of_layout) one.resize(one.size() - kOfTheLayout.size());
    const std::size_t colon = one.find(": ");
    EXPECT_NE(colon, std::string::npos) << one;
    if (colon != std::string::npos) steps.push_back({one.substr(0, colon), one.substr(colon + 2), of_layout});
  }
  return steps;
}

/// Applies a setting to the document that it is of.
inline void follow(const check::CheckFinding& finding, YAML::Node arm_file, YAML::Node layout) {
  for (const Step& step : steps_of(finding.setting)) {
    try {
      set(step.of_layout ? layout : arm_file, step.path, step.value);
    } catch (const std::exception& e) {
      FAIL() << finding.id << ": " << step.path << ": " << e.what();
    }
  }
}

inline arm::Arm loaded(const YAML::Node& arm_file, const YAML::Node& layout, const std::string& what,
                       const arm::Arm& before) {
  try {
    trial::parse_csv_layout(YAML::Dump(layout), "layout");
    return arm::parse_arm(YAML::Dump(arm_file), "arm");
  } catch (const std::exception& e) {
    ADD_FAILURE() << what << "\n" << e.what();
    return before;
  }
}

/// Applies the settings of a finding to both documents and loads them.
inline void follow(const check::CheckFinding& finding, const std::string& arm_text, arm::Arm* arm) {
  YAML::Node arm_file = YAML::Load(arm_text), layout = YAML::Load(kImportLayout);
  follow(finding, arm_file, layout);
  *arm = loaded(arm_file, layout, finding.id + ": " + finding.setting, *arm);
}

}  // namespace softarm::testing_check
