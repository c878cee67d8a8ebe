// A small arm's YAML for the tests, and edits of it.
#pragma once

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "softarm/arm/arm_file.h"

namespace softarm {

inline const std::string kSmallArm = R"(format: 1
name: small
base: {body: base}
segments:
  - name: lower
    length_m: 0.2
    mass_per_length_kg_m: 1.0
    diameter_m: 0.04
    bending_stiffness: {base_nm2: 0.03}
    chambers:
      - {input: chamber_1, bending_direction_deg: 90, moment_gain_nm_per_pa: 6.0e-6}
bodies:
  - {name: ring_1, arclength_m: 0.1}
  - {name: ring_2, arclength_m: tip, orientation_usable: true}
inputs:
  pressures:
    - {name: chamber_1, topic: /pressure/chamber_1}
estimator: {method: full_points}
)";

/// The text with `from` replaced, once; `from` must be in it.
inline std::string edited(const std::string& text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("the test edits what is not there: " + from);
  return std::string(text).replace(at, from.size(), to);
}

inline std::string edited(const std::string& from, const std::string& to) {
  return edited(kSmallArm, from, to);
}

/// An edit of a text that must be refused with exactly this message.
struct Refusal {
  const char* name;
  const char* from;
  const char* to;
  const char* message;
};

inline void PrintTo(const Refusal& refusal, std::ostream* out) {
  *out << refusal.name;
}

/// What parse_arm() says of a text that it must refuse; checks that it is a single line that begins with the
/// source.
inline std::string refusal(const std::string& text) {
  try {
    arm::parse_arm(text, "arm.yaml");
  } catch (const arm::ArmError& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_EQ(message.rfind("arm.yaml:", 0), 0u) << message;
    return message;
  }
  ADD_FAILURE() << "accepted:\n" << text;
  return "";
}

}  // namespace softarm
