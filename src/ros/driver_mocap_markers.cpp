// mocap_base/MarkerList of mocap_qualisys, mocap_vicon.
#include <softarm_estimator/MocapMarkerList.h>

#include "marker_list.h"

namespace softarm {
namespace {

ReportedMarker mocap_marker(const nlohmann::json& marker, const BodyReader& reader) {
  ReportedMarker reported{{}, position_at(marker, "position", reader)};
  const std::string id = text_at(marker, "id");
  if (flag_at(marker, "labeled") && !id.empty()) reported.labels = {id};
  if (!flag_at(marker, "tracked")) reported.lost = "not_tracked";
  return reported;
}

std::vector<InputTopic> mocap_marker_topics(const arm::Arm& arm, const arm::BodySource& source,
                                            const Bodies& bodies) {
  return marker_list_topic(arm, source, bodies, "markers", mocap_marker);
}

}  // namespace

BodyDriver driver_mocap_markers() {
  return {mocap_marker_topics, mirror<softarm_estimator::MocapMarkerList>()};
}

}  // namespace softarm
