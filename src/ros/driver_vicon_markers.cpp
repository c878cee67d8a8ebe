// vicon_bridge/Markers.
#include <softarm_estimator/ViconMarkers.h>

#include "marker_list.h"

namespace softarm {
namespace {

/// Unlabelled ones have no name. An occluded one has a position all the same: Vicon's last.
ReportedMarker vicon_marker(const nlohmann::json& marker, const BodyReader& reader) {
  ReportedMarker reported{{}, position_at(marker, "translation", reader)};
  const std::string name = text_at(marker, "marker_name"), subject = text_at(marker, "subject_name");
  if (!name.empty()) {
    reported.labels = {name};
    if (!subject.empty())
      reported.labels.insert(reported.labels.end(), {subject + "/" + name, subject + ":" + name});
  }
  if (flag_at(marker, "occluded")) reported.lost = "occluded";
  return reported;
}

std::vector<InputTopic> vicon_marker_topics(const arm::Arm& arm, const arm::BodySource& source,
                                            const Bodies& bodies) {
  return marker_list_topic(arm, source, bodies, "markers", vicon_marker);
}

}  // namespace

BodyDriver driver_vicon_markers() {
  return {vicon_marker_topics, mirror<softarm_estimator::ViconMarkers>()};
}

}  // namespace softarm
