// An arm file as the module hands it around.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "softarm/arm/arm.h"
#include "softarm/arm/arm_file.h"
#include "softarm/arm/constants.h"
#include "softarm/model/present.h"

namespace softarm::python {

/// Never changes. Its text and the arm are the same thing: another arm is another text.
struct ArmHandle {
  /// @throws arm::ArmError
  ArmHandle(std::string text_of_file, std::string source_of_text);

  std::string text, source;
  arm::Arm arm;
  std::vector<model::Present> effects;
  std::vector<arm::EffectEntry> entries;

  /// @throws std::invalid_argument for a name that the arm does not have, with the one that was meant
  arm::ConstantRef constant(const std::string& name) const;
};

using Arm = std::shared_ptr<const ArmHandle>;

}  // namespace softarm::python
