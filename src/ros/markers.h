// An estimate as a picture.
#pragma once

#include <visualization_msgs/MarkerArray.h>

#include "estimate_message.h"

namespace softarm {

/// Markers in the mocap frame: `backbone` (tube of the arm's diameter, coloured by curvature from 0 to that
/// of a half circle), `rings` (estimated), `tendons` (and cables) where the arm has some, `measured` and
/// `estimated` points with `residuals` between them, `payload` (arrow of its weight), `scale` and `legend`
/// (the colours), `text` (the figures). Where there is no estimate the shapes are deleted and the text says
/// why. All vanish half a second after the last one.
visualization_msgs::MarkerArray to_markers(const estimate::Estimate& estimate, const MessageContext& context);

}  // namespace softarm
