// Puts changed constants into the text of an arm's YAML, and leaves everything else as it was written.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/arm/arm_file.h"

namespace softarm::arm {

/// The text with the constants of `arm`: lengths, masses per length, arclengths of bodies and payload,
/// stiffnesses, rest curvatures, gains, elongations, offsets and the estimator's prior. Only values that
/// differ are replaced, keys that were left out are added; comments, order and units stay. Effects that
/// differ are written as a section of their own at the end, in place of an earlier one.
///
/// @param text a valid arm; @param source its name for messages
/// @param arm as parse_arm() reads `text`, but for those constants
/// @param header lines put in front as comments, in place of the header of an earlier call
/// @return text that parse_arm() reads as `arm` does, to nine digits
/// @throws ArmError if the text is no valid arm, has another structure than `arm`, or is written in a way
/// that cannot be edited (aliases, quoted numbers)
std::string update_arm_text(const std::string& text, const std::string& source, const Arm& arm,
                            const std::vector<std::string>& header = {});

/// The same with other effects: where they differ, as a section at the end in place of an earlier one.
/// @param program that writes, "identify" or "diagnose": stands in each line of the header
/// @param verdict of the diagnosis that found them; nothing: as the text has it
std::string update_arm_text(const std::string& text, const std::string& source, const Arm& arm,
                            const std::vector<EffectEntry>& effects, const std::vector<std::string>& header,
                            const std::string& program,
                            const std::optional<std::string>& verdict = std::nullopt);

}  // namespace softarm::arm
