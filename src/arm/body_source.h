// The source of bodies in an arm file.
#pragma once

#include "body_types.h"
#include "softarm/arm/arm.h"
#include "yaml_section.h"

namespace softarm::arm::yaml {

BodySource read_body_source(const Section& section);

}  // namespace softarm::arm::yaml
