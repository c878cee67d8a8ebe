// An arm's description from a file.
#pragma once

#include <string>
#include <vector>

#include "softarm/arm/arm_yaml.h"

namespace softarm {

/// Finds and parses an arm file.
/// @param name a path, or the bare name of a shipped arm ("online_200mm") that is looked up in `directories`
/// @param directories folders searched for `<name>.yaml`
/// @throws ArmError if there is no such file (the line names the arms that there are), if it cannot be read,
/// or if it is not a valid arm
Arm load_arm_file(const std::string& name, const std::vector<std::string>& directories = {});

/// The text of that file, and its path.
struct ArmText {
  std::string text, source;
};
/// @throws ArmError where load_arm_file() would but for the text itself
ArmText read_arm_text(const std::string& name, const std::vector<std::string>& directories = {});

/// Bare names of the arm files in these folders, sorted.
std::vector<std::string> arm_names(const std::vector<std::string>& directories);

}  // namespace softarm
