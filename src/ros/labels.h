// What is written beside the arm in rviz: figures, colour bar, legend, what is waited for.
#pragma once

#include <visualization_msgs/MarkerArray.h>

#include <string>
#include <vector>

#include "estimate_message.h"

namespace softarm {

/// "26.4 ± 3.3": both to the second significant digit of the standard deviation; without one (0) to three.
std::string plus_minus(double value, double sd);

/// Words in lines of at most so many bytes each, where no word is longer.
std::string in_lines(const std::string& words, std::size_t width);

/// For people: EI, M0, φ and L of each segment, and the payload, with their standard deviations,
/// "EI 31.2 ± 2.1 mN m²", or that this frame does not identify them. Where the status is not ok, its reason.
std::string estimate_text(const estimate::Estimate& estimate, const arm::Arm& arm,
                          const arm::EstimatorOptions& options);

/// `text`, a marker for each line, behind the arm's base (above it where the arm is level), under the frames'
/// prefix where that is not the launch files': two arms side by side are to be told apart.
std::vector<visualization_msgs::Marker> text_lines(const std::string& words, bool trouble,
                                                   const Eigen::Isometry3d& base_in_mocap,
                                                   const MessageContext& context);

/// Beside the arm, readable from all sides: `scale`, the colours of curvature from 0 to `most_per_m`, and
/// `legend`, what the other colours are.
std::vector<visualization_msgs::Marker> key_markers(double most_per_m, const Eigen::Isometry3d& base_in_mocap,
                                                    const MessageContext& context);

/// What is waited for while there are no frames, in place of an estimate.
visualization_msgs::MarkerArray waiting_markers(const std::string& words,
                                                const Eigen::Isometry3d& base_in_mocap,
                                                const MessageContext& context);

std_msgs::ColorRGBA color(double r, double g, double b, double a);
inline const std_msgs::ColorRGBA kMeasuredColor = color(1.0, 0.65, 0.1, 1.0);
inline const std_msgs::ColorRGBA kEstimatedColor = color(0.15, 0.85, 0.95, 1.0);
inline const std_msgs::ColorRGBA kPayloadColor = color(0.75, 0.45, 1.0, 1.0);

}  // namespace softarm
