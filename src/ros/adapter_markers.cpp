// Lists of markers in messages of the drivers' own packages: vicon_bridge, mocap_base (mocap_qualisys,
// mocap_vicon), phasespace_msgs. They are read by the names of their fields, so versions with more of them
// are read as well.
#include <fmt/format.h>

#include <cmath>

#include "adapters.h"
#include "any_input_topic.h"
#include "body_reader.h"
#include "marker_bodies.h"
#include "message_schema.h"

namespace softarm {
namespace {

using nlohmann::json;

std::string text_at(const json& marker, const char* field) {
  const json* found = find_field(marker, field);
  return found && found->is_string() ? found->get<std::string>() : "";
}

bool flag_at(const json& marker, const char* field) {
  const json* found = find_field(marker, field);
  return found && found->is_boolean() && found->get<bool>();
}

Eigen::Vector3d position_at(const json& marker, const std::string& field, const BodyReader& reader) {
  const std::string prefix = field.empty() ? "" : field + ".";
  return reader.position(number_at(marker, prefix + "x"), number_at(marker, prefix + "y"),
                         number_at(marker, prefix + "z"));
}

/// Unlabelled ones have no name. An occluded one has a position all the same: Vicon's last.
ReportedMarker vicon_marker(const json& marker, const BodyReader& reader) {
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

ReportedMarker mocap_marker(const json& marker, const BodyReader& reader) {
  ReportedMarker reported{{}, position_at(marker, "position", reader)};
  const std::string id = text_at(marker, "id");
  if (flag_at(marker, "labeled") && !id.empty()) reported.labels = {id};
  if (!flag_at(marker, "tracked")) reported.lost = "not_tracked";
  return reported;
}

/// Several packages share the name: the position is x, y, z or a point, the condition `cond` or `condition`;
/// some have names, some the server's time in microseconds. A condition of zero or less means not seen.
ReportedMarker phasespace_marker(const json& marker, const BodyReader& reader) {
  const bool has_point = find_field(marker, "position") != nullptr;
  ReportedMarker reported{{}, position_at(marker, has_point ? "position" : "", reader)};
  const double id = number_at(marker, "id");
  if (std::isfinite(id)) reported.labels = {fmt::format("{:.0f}", id), fmt::format("m{:.0f}", id)};
  const std::string name = text_at(marker, "name");
  if (!name.empty() && name != reported.labels.front() && name != reported.labels.back()) {
    reported.labels.push_back(name);
  }
  const char* const condition = find_field(marker, "cond") ? "cond" : "condition";
  if (!(number_at(marker, condition) > 0.0)) reported.lost = "bad_condition";
  const double server_us = number_at(marker, "time");
  if (std::isfinite(server_us)) reported.server_s = 1e-6 * server_us;
  return reported;
}

using ReadMarker = ReportedMarker (*)(const json&, const BodyReader&);

std::vector<InputTopic> list_topic(const arm::Arm& arm, const arm::BodySource& source, const Bodies& bodies,
                                   const char* list, ReadMarker read) {
  const MarkerSink sink = source.labelled ? labelled_bodies(arm, source, bodies) : associated_bodies(arm);
  const auto convert = [=, reader = BodyReader(source)](const json& message, double receipt_s,
                                                        trial::FrameAssembler& assembler) {
    if (!reader.reads(text_at(message, "header.frame_id"))) {
      return assembler.count_rejected("other_frame", "markers");
    }
    const json* entries = find_field(message, list);
    if (!entries || !entries->is_array()) return assembler.count_rejected("no_points", "markers");
    std::vector<ReportedMarker> markers;
    for (const json& entry : *entries) markers.push_back(read(entry, reader));
    double stamp_s = reader.stamp_s(header_stamp_s(message).value_or(receipt_s), receipt_s);
    if (source.stamp == arm::StampSource::kServer && !markers.empty()) {
      stamp_s = markers.front().server_s.value_or(0.0);
    }
    sink(stamp_s, markers, assembler);
  };
  return {make_any_input_topic(source.topic, source.type, names_of(bodies), convert)};
}

}  // namespace

std::vector<InputTopic> vicon_marker_topics(const arm::Arm& arm, const arm::BodySource& source,
                                            const Bodies& bodies) {
  return list_topic(arm, source, bodies, "markers", vicon_marker);
}

std::vector<InputTopic> mocap_marker_topics(const arm::Arm& arm, const arm::BodySource& source,
                                            const Bodies& bodies) {
  return list_topic(arm, source, bodies, "markers", mocap_marker);
}

std::vector<InputTopic> phasespace_marker_topics(const arm::Arm& arm, const arm::BodySource& source,
                                                 const Bodies& bodies) {
  return list_topic(arm, source, bodies, "markers", phasespace_marker);
}

std::vector<InputTopic> phasespace_stamped_topics(const arm::Arm& arm, const arm::BodySource& source,
                                                  const Bodies& bodies) {
  return list_topic(arm, source, bodies, "data", phasespace_marker);
}

}  // namespace softarm
