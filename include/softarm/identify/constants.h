// Which constants of an arm's laws (softarm/arm/constants.h) identification is to fit.
#pragma once

#include <string>
#include <vector>

#include "softarm/arm/constants.h"
#include "softarm/export.h"

namespace softarm::identify {

using arm::allowed_range;
using arm::ConstantKind;
using arm::ConstantRef;
using arm::ConstantRole;
using arm::constants_of;
using arm::default_free;
using arm::name_of;
using arm::role_of;
using arm::segments_of;
using arm::set_value;
using arm::strained_by_inputs;
using arm::unit_of;
using arm::value_of;

/// The constants whose name matches one of the shell patterns ("*.moment_gain", "segment_1.length"); a
/// pattern without a dot matches the last part of a name ("length").
/// @throws std::invalid_argument where a pattern matches none; the line lists the names
SOFTARM_EXPORT std::vector<ConstantRef> matching(const arm::Arm& arm,
                                                 const std::vector<std::string>& patterns);

/// Ties constants of several segments to one value each: of those of `list` that match a pattern, such as
/// "*.bending_stiffness.base", the ones of one kind and index become one constant.
/// @throws std::invalid_argument where a pattern matches none of the arm's, or none of the list's in two
/// segments
SOFTARM_EXPORT std::vector<ConstantRef> tie_constants(const arm::Arm& arm,
                                                      const std::vector<ConstantRef>& list,
                                                      const std::vector<std::string>& patterns);

}  // namespace softarm::identify
