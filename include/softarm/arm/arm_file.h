// An arm's description as a YAML file: the arm, and the effects that it names.
#pragma once

#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/export.h"

namespace softarm::arm {

/// A description that cannot be used. what() is one line: file, key, value, allowed range.
class SOFTARM_EXPORT ArmError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Parses an arm's YAML.
/// @param text the document
/// @param source its name for messages (usually the file)
/// @throws ArmError on a syntax error, an unknown or missing key, a wrong type or unit, or an impossible
/// value.
SOFTARM_EXPORT Arm parse_arm(const std::string& text, const std::string& source);

/// Every key of the format: section, key, unit or words, range, default and meaning, as a Markdown table per
/// section. It is printed from the table that parse_arm() checks against.
SOFTARM_EXPORT std::string describe_arm_keys();

/// Names used in YAML, on the command line and in messages.
SOFTARM_EXPORT std::string to_string(Method method);
SOFTARM_EXPORT std::string to_string(Unknown unknown);
SOFTARM_EXPORT std::string to_string(Objective objective);
SOFTARM_EXPORT std::string to_string(Dynamics dynamics);
/// @throws std::invalid_argument naming the allowed words.
SOFTARM_EXPORT Method parse_method(const std::string& word);
SOFTARM_EXPORT Unknown parse_unknown(const std::string& word);
SOFTARM_EXPORT Objective parse_objective(const std::string& word);
SOFTARM_EXPORT Dynamics parse_dynamics(const std::string& word);

/// Finds and parses an arm file.
/// @param name a path, or the bare name of a shipped arm ("online_200mm") that is looked up in `directories`
/// @param directories folders searched for `<name>.yaml`
/// @throws ArmError if there is no such file (the line names the arms that there are), if it cannot be read,
/// or if it is not a valid arm
SOFTARM_EXPORT Arm load_arm_file(const std::string& name, const std::vector<std::string>& directories = {});

/// The text of that file, and its path.
struct ArmText {
  std::string text, source;
};
/// @throws ArmError where load_arm_file() would but for the text itself
SOFTARM_EXPORT ArmText read_arm_text(const std::string& name,
                                     const std::vector<std::string>& directories = {});

/// Makes this the payload wherever no topic says otherwise.
/// @throws std::invalid_argument for a value outside PayloadMount::range_kg: "payload 7: must be from 0 to 5
/// kg for the arm ..."
SOFTARM_EXPORT void assume_payload(Arm& arm, double kg);

/// Bare names of the arm files in these folders, sorted.
SOFTARM_EXPORT std::vector<std::string> arm_names(const std::vector<std::string>& directories);

// --- Effects beyond the laws, as an arm file names them: plain data. What they do is known to effects/.

/// How the error of a number goes with that of another number of the same list.
struct EffectCorrelation {
  std::size_t entry = 0;   ///< of the list: to which the other number belongs
  std::string number;      ///< the other number's name
  double value = 0.0;      ///< -1: they err against each other; 1: together
  std::string place = {};  ///< in its file, for messages
};

/// One number of an effect, in the unit of its name.
struct EffectNumber {
  std::string name;  ///< "compliance_rad_per_nm"
  double value = 0.0;
  std::optional<double> sd = std::nullopt;  ///< standard deviation, where a diagnosis stated one
  /// With other numbers that have an sd. Each pair stands at one of the two; what stands nowhere is 0.
  std::vector<EffectCorrelation> correlations = {};
  bool fitted = true;  ///< else a comment says that the fit behind its effect held it; not read from a file
};

struct EffectEntry {
  std::string id;  ///< "base_compliance"
  std::vector<EffectNumber> numbers;
  std::string place = {};  ///< in its file, for messages: "my_arm.yaml:41"
};

/// The section `effects` of an arm's YAML, in its order, with its `effects_correlations`; empty where there
/// is none. parse_arm() leaves it out: an Arm is what its laws say.
/// @throws ArmError where the section cannot be read, or numbers cannot be correlated so; ids, names and
/// ranges are checked by effects::effects_of()
SOFTARM_EXPORT std::vector<EffectEntry> parse_effect_entries(const std::string& text,
                                                             const std::string& source);
/// The key `effects_verdict`: how the diagnosis that found them ended; nothing where the file does not say.
/// @throws ArmError as above
SOFTARM_EXPORT std::optional<std::string> parse_effects_verdict(const std::string& text,
                                                                const std::string& source);

}  // namespace softarm::arm
