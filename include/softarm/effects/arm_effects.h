// Effects as an arm file has them, and as models use them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/arm/arm_file.h"
#include "softarm/export.h"
#include "softarm/model/present.h"

namespace softarm::effects {

/// The effects of an arm file with all their numbers: those that the file leaves out are 0 where they are
/// sizes, else as usual.
/// @throws ArmError (file, key, value, allowed) for an effect that the catalogue does not have, that this arm
/// cannot have, or whose numbers are unknown, missing or outside their range, or cannot be correlated so
SOFTARM_EXPORT std::vector<model::Present> effects_of(const arm::Arm& arm,
                                                      const std::vector<arm::EffectEntry>& entries);

/// How an arm file names it. @param sd of its values, in place of Present::sd; not positive: not of this one
SOFTARM_EXPORT arm::EffectEntry entry_of(const model::Present& present,
                                         const std::optional<model::Values>& sd = std::nullopt);

/// The same of all of a list, with their correlations.
SOFTARM_EXPORT std::vector<arm::EffectEntry> entries_of(const std::vector<model::Present>& effects);

/// Those of the file that load_arm_file() finds under this name.
/// @throws ArmError as both
SOFTARM_EXPORT std::vector<model::Present> load_effects(const arm::Arm& arm, const std::string& name,
                                                        const std::vector<std::string>& directories = {});

/// Why the effects of that file are not to be trusted with the whole of it, in a sentence: the diagnosis that
/// found them ended with "unknown". Empty where it did not, or there are none.
/// @throws ArmError as load_effects()
SOFTARM_EXPORT std::string doubt_about_effects(const std::string& name,
                                               const std::vector<std::string>& directories = {});

SOFTARM_EXPORT std::string doubt_about_effects(const arm::ArmText& file);

}  // namespace softarm::effects
