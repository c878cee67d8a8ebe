#include "body_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <sstream>

namespace softarm::arm::yaml {
namespace {

constexpr char kBody[] = "<body>";

double metres_per(const std::string& unit) {
  static const std::map<std::string, double> kScale{{"m", 1.0}, {"cm", 1e-2}, {"mm", 1e-3}};
  return kScale.at(unit);
}

/// "x -z y": the driver's axes along the mocap frame's x, y and z.
Eigen::Matrix3d read_axes(const Section& section) {
  Eigen::Matrix3d mocap_from_driver = Eigen::Matrix3d::Zero();
  std::istringstream words(section.text("axes"));
  std::string word;
  int row = 0;
  bool good = true;
  for (; words >> word; ++row) {
    const bool negative = word.front() == '-';
    const std::string letter = word.substr(negative || word.front() == '+' ? 1 : 0);
    good = good && row < 3 && letter.size() == 1 && letter.front() >= 'x' && letter.front() <= 'z';
    if (!good) break;
    mocap_from_driver(row, letter.front() - 'x') = negative ? -1.0 : 1.0;
  }
  good = good && row == 3 && std::abs(std::abs(mocap_from_driver.determinant()) - 1.0) < 0.5;
  if (!good) {
    section.fail_value("axes",
                       "does not name the driver's axis that points along each of x, y and z; say \"x y z\", "
                       "\"x -z y\" (y up) or \"x z y\" (mirrored)");
  }
  return mocap_from_driver;
}

std::string read_topic(const Section& section, const BodyType& type) {
  const bool one_per_body = type.message == BodyMessage::kPose || type.message == BodyMessage::kPoint;
  if (one_per_body) return section.topic("topic", kBody);
  if (!section.has("topic")) {
    if (type.message == BodyMessage::kFrames) return "/tf";
    section.require("topic", fmt::format("{} has no usual topic", type.type));
  }
  if (section.text("topic").find(kBody) != std::string::npos) {
    section.fail_value(
        "topic", fmt::format("contains {}, but a message of type {} holds all bodies", kBody, type.type));
  }
  return section.topic("topic");
}

std::string without_slash(const std::string& frame) {
  return frame.rfind('/', 0) == 0 ? frame.substr(1) : frame;
}

void refuse_unless(bool applies, const Section& section, const char* key, const char* to_what) {
  if (!applies && section.has(key)) section.fail(key, fmt::format("applies to {} only", to_what));
}

}  // namespace

const std::vector<BodyType>& body_types() {
#define SOFTARM_ROW(name, type, message, unit, server_time) {type, message, unit, server_time},
  static const std::vector<BodyType> types{SOFTARM_BODY_TYPES(SOFTARM_ROW)};
#undef SOFTARM_ROW
  return types;
}

const BodyType& body_type(const std::string& type) {
  const auto found = std::find_if(body_types().begin(), body_types().end(),
                                  [&](const BodyType& known) { return known.type == type; });
  if (found == body_types().end()) throw std::logic_error("no type of bodies: " + type);
  return *found;
}

BodySource read_body_source(const Section& section) {
  BodySource source;
  source.type = section.word("type");
  const BodyType& type = body_type(source.type);
  source.topic = read_topic(section, type);
  source.scale_to_m = metres_per(section.has("unit") ? section.word("unit") : type.unit);
  source.mocap_from_driver = read_axes(section);
  if (section.has("frame")) source.frame = without_slash(section.text("frame"));

  const bool is_tf = type.message == BodyMessage::kFrames;
  refuse_unless(is_tf, section, "child_frame", "tf2_msgs/TFMessage");
  if (is_tf) {
    source.child_frame = without_slash(section.text("child_frame"));
    if (source.child_frame.find(kBody) == std::string::npos) {
      section.fail_value("child_frame", fmt::format("does not contain {}", kBody));
    }
  }

  const std::string stamp = section.word("stamp");
  if (stamp == "server" && !type.server_time) {
    section.fail_value(
        "stamp", fmt::format("needs a time of the motion capture, which {} does not carry", source.type));
  }
  source.stamp = stamp == "header"    ? StampSource::kHeader
                 : stamp == "receipt" ? StampSource::kReceipt
                                      : StampSource::kServer;

  const bool has_labels = type.message == BodyMessage::kMarkers;
  refuse_unless(has_labels, section, "labels", "lists of markers");
  source.labelled = type.message != BodyMessage::kCloud && section.flag("labels");
  refuse_unless(has_labels && source.labelled, section, "marker_tolerance_m", "lists of labelled markers");
  source.marker_tolerance_m = section.number("marker_tolerance_m");
  return source;
}

}  // namespace softarm::arm::yaml
