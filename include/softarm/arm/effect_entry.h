// Effects beyond the laws, as an arm file names them: plain data. What they do is known to effects/.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace softarm {

/// One number of an effect, in the unit of its name.
struct EffectNumber {
  std::string name;  ///< "compliance_rad_per_nm"
  double value = 0.0;
  std::optional<double> sd = std::nullopt;  ///< standard deviation, where a diagnosis stated one
};

struct EffectEntry {
  std::string id;  ///< "base_compliance"
  std::vector<EffectNumber> numbers;
  std::string place = {};  ///< in its file, for messages: "my_arm.yaml:41"
};

/// The section `effects` of an arm's YAML, in its order; empty where there is none. parse_arm() leaves it
/// out: an Arm is what its laws say.
/// @throws ArmError where the section cannot be read; ids, names and ranges are checked by
/// effects::effects_of()
std::vector<EffectEntry> parse_effect_entries(const std::string& text, const std::string& source);

}  // namespace softarm
