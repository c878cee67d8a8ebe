// An estimate as a picture.
#pragma once

#include <visualization_msgs/MarkerArray.h>

#include <string>

#include "estimate_message.h"

namespace softarm {

/// For people: stiffness and payload with their standard deviations, "EI 31.2 ± 2.1 mN m²", or that this
/// frame does not identify them; one line each. Where the status is not ok, its reason.
std::string estimate_text(const estimate::Estimate& estimate, const arm::Arm& arm,
                          const arm::EstimatorOptions& options);

/// Markers in the mocap frame: `backbone` (tube of the arm's diameter, coloured by curvature from 0 to that
/// of a half circle), `rings` (estimated), `tendons` (and cables) where the arm has some, `measured` and
/// `estimated` points with `residuals` between them, `payload` (arrow of its weight), `text`. Where there is
/// no estimate the shapes are deleted and the text says why. All vanish half a second after the last one.
visualization_msgs::MarkerArray to_markers(const estimate::Estimate& estimate, const MessageContext& context);

}  // namespace softarm
