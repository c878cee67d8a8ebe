#include "marker_list.h"

#include "any_input_topic.h"
#include "message_schema.h"

namespace softarm {

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

std::vector<InputTopic> marker_list_topic(const arm::Arm& arm, const arm::BodySource& source,
                                          const Bodies& bodies, const char* list, ReadMarker read) {
  const MarkerSink sink = source.labelled ? labelled_bodies(arm, source, bodies) : associated_bodies(arm);
  const auto convert = [=, reader = BodyReader(source)](const json& message, trial::Stamp receipt,
                                                        trial::FrameAssembler& assembler) {
    if (!reader.reads(text_at(message, "header.frame_id"))) {
      return assembler.count_rejected("other_frame", "markers");
    }
    const json* entries = find_field(message, list);
    if (!entries || !entries->is_array()) return assembler.count_rejected("no_points", "markers");
    std::vector<ReportedMarker> markers;
    for (const json& entry : *entries) markers.push_back(read(entry, reader));
    trial::Stamp stamp = reader.stamp(header_stamp(message).value_or(receipt), receipt);
    if (source.stamp == arm::StampSource::kServer) {
      // Only markers have the server's time. That of receipt is of another clock: two such were a new time.
      if (markers.empty()) return assembler.count_rejected("no_points", "markers");
      stamp = markers.front().server_s.value_or(0.0);
    }
    sink(stamp, markers, assembler);
  };
  return {make_any_input_topic(source.topic, source.type, names_of(bodies), convert)};
}

}  // namespace softarm
