// The points of one instant to the bodies that they belong to.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "input_topics.h"

namespace softarm {

/// A marker as a driver reports it.
struct ReportedMarker {
  std::vector<std::string> labels;  ///< names it answers to; empty: none
  Eigen::Vector3d p_mocap;          ///< m
  const char* lost = nullptr;       ///< why the position is none: "occluded", ...; null: it is one
  std::optional<double> server_s = std::nullopt;  ///< when it was seen, by the motion capture's clock
};

/// Adds the bodies that the markers of one instant give: (stamp, markers, assembler).
using MarkerSink =
    std::function<void(trial::Stamp, const std::vector<ReportedMarker>&, trial::FrameAssembler&)>;

/// Bodies by the labels of their markers (MeasuredBody::labelled_markers). A body whose markers are not all
/// there (with positions on the body: fewer than three, or more than marker_tolerance_m off) is added as
/// missing, with the reason, so that no frame waits for it.
MarkerSink labelled_bodies(const arm::Arm& arm, const arm::BodySource& source, const Bodies& bodies);

/// Bodies of points without labels, by data association (PointAssociator).
MarkerSink associated_bodies(const arm::Arm& arm);

}  // namespace softarm
