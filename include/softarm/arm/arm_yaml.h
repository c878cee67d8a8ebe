// An arm's YAML description.
#pragma once

#include <stdexcept>
#include <string>

#include "softarm/arm/arm.h"

namespace softarm {

/// A description that cannot be used. what() is one line: file, key, value, allowed range.
class ArmError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Parses an arm's YAML.
/// @param text the document
/// @param source its name for messages (usually the file)
/// @throws ArmError on a syntax error, an unknown or missing key, a wrong type or unit, or an impossible
/// value.
Arm parse_arm(const std::string& text, const std::string& source);

/// Every key of the format: section, key, unit or words, range, default and meaning, as a Markdown table per
/// section. It is printed from the table that parse_arm() checks against.
std::string describe_arm_keys();

/// Names used in YAML, on the command line and in messages.
std::string to_string(Method method);
std::string to_string(Unknown unknown);
std::string to_string(Objective objective);
/// @throws std::invalid_argument naming the allowed words.
Method parse_method(const std::string& word);
Unknown parse_unknown(const std::string& word);
Objective parse_objective(const std::string& word);

}  // namespace softarm
