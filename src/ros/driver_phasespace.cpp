// phasespace_msgs/Markers and MarkersStamped.
#include <fmt/format.h>
#include <softarm_estimator/PhasespaceMarkers.h>

#include <algorithm>
#include <cmath>

#include "marker_list.h"
#include "message_schema.h"

namespace softarm {
namespace {

/// Several packages share the name: the position is x, y, z or a point, the condition `cond` or `condition`;
/// some have names, some the server's time in microseconds. A condition of zero or less means not seen.
ReportedMarker phasespace_marker(const nlohmann::json& marker, const BodyReader& reader) {
  const bool has_point = find_field(marker, "position") != nullptr;
  ReportedMarker reported{{}, position_at(marker, has_point ? "position" : "", reader)};
  const double id = number_at(marker, "id");
  if (std::isfinite(id)) reported.labels = {fmt::format("{:.0f}", id), fmt::format("m{:.0f}", id)};
  const std::string name = text_at(marker, "name");
  const auto& labels = reported.labels;
  if (!name.empty() && std::find(labels.begin(), labels.end(), name) == labels.end())
    reported.labels.push_back(name);
  const char* const condition = find_field(marker, "cond") ? "cond" : "condition";
  if (!(number_at(marker, condition) > 0.0)) reported.lost = "bad_condition";
  const double server_us = number_at(marker, "time");
  if (std::isfinite(server_us)) reported.server_s = 1e-6 * server_us;
  return reported;
}

std::vector<InputTopic> phasespace_topics(const arm::Arm& arm, const arm::BodySource& source,
                                          const Bodies& bodies) {
  return marker_list_topic(arm, source, bodies, "markers", phasespace_marker);
}

std::vector<InputTopic> phasespace_stamped_topics(const arm::Arm& arm, const arm::BodySource& source,
                                                  const Bodies& bodies) {
  return marker_list_topic(arm, source, bodies, "data", phasespace_marker);
}

}  // namespace

BodyDriver driver_phasespace() {
  return {phasespace_topics, mirror<softarm_estimator::PhasespaceMarkers>()};
}

BodyDriver driver_phasespace_stamped() {
  return {phasespace_stamped_topics};
}

}  // namespace softarm
