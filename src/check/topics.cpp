// Topics that the arm expects, against those that the recording has.
#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>

#include "arm/edit_distance.h"
#include "context.h"

namespace softarm::check {
namespace {

/// Another topic of the right type that may be the missing one under another name.
std::optional<std::string> near_miss(const trial::RecordedTopic& missing,
                                     const trial::CheckRecording& recording) {
  std::vector<std::string> same_type, any;
  for (const auto& [topic, type] : recording.other_topics) {
    any.push_back(topic);
    if (type == missing.type) same_type.push_back(topic);
  }
  if (const auto near = arm::yaml::nearest_word(missing.topic, same_type)) return near;
  if (const auto near = arm::yaml::nearest_word(missing.topic, any)) return near;
  // "/vrpn_client_node/tip/pose" for "/mocap/tip/pose": the body's name is in it.
  const std::string name = boost::to_lower_copy(missing.feeds);
  for (const std::string& topic : same_type) {
    if (boost::contains(boost::to_lower_copy(topic), name)) return topic;
  }
  return std::nullopt;
}

std::string listed(const trial::CheckRecording& recording) {
  std::string text;
  for (const auto& [topic, type] : recording.other_topics) text += (text.empty() ? "" : ", ") + topic;
  return text.empty() ? "no topic that the arm does not use" : "also " + text;
}

const char* key_of(const trial::RecordedTopic& topic) {
  return topic.of_bodies ? "inputs.bodies.topic" : "inputs.….topic";
}

void say_missing(Context& context, const trial::RecordedTopic& topic, bool no_body_at_all) {
  if (topic.of_payload) return;  // check_payload has its own words
  const bool serious = topic.is_base || (topic.of_bodies && no_body_at_all);
  CheckFinding& finding =
      context.add(serious ? Severity::kSerious : Severity::kWarning, "missing_topic", topic.topic,
                  fmt::format("is not in the recording ({} comes by it, as {}); the recording has {}",
                              topic.feeds, topic.type, listed(context.recording)));
  finding.remedy =
      "record it (rosbag record), or correct its name in the arm file or of the body in the "
      "driver";
  if (const auto near = near_miss(topic, context.recording)) {
    finding.remedy =
        fmt::format("{} is meant? Then name it so in the arm file, or rename it with rosbag filter", *near);
    finding.setting = fmt::format("{}: {}", key_of(topic), *near);
  }
}

void check_topics(Context& context) {
  const auto& topics = context.recording.topics;
  const bool no_body = std::none_of(topics.begin(), topics.end(), [](const trial::RecordedTopic& t) {
    return t.of_bodies && !t.is_base && t.found_type == t.type && t.messages > 0;
  });
  for (const trial::RecordedTopic& topic : topics) {
    if (topic.found_type.empty()) {
      say_missing(context, topic, no_body);
    } else if (topic.found_type != topic.type) {
      const bool serious = topic.is_base || (topic.of_bodies && no_body);
      CheckFinding& finding = context.add(
          serious ? Severity::kSerious : Severity::kWarning, "wrong_type", topic.topic,
          fmt::format("is {}, the arm expects {} ({})", topic.found_type, topic.type, topic.feeds));
      finding.remedy = "name the type that the driver publishes in the arm file";
      finding.setting =
          fmt::format("{}: {}", topic.of_bodies ? "inputs.bodies.type" : "inputs.….type", topic.found_type);
    } else if (topic.messages == 0 && !topic.of_payload) {
      context
          .add(topic.is_base ? Severity::kSerious : Severity::kWarning, "empty_topic", topic.topic,
               fmt::format("is announced, but not one message was recorded ({})", topic.feeds))
          .remedy = "look whether the driver sees the body, or the sensor is connected";
    }
  }
}

}  // namespace

Check make_topics() {
  return {check_topics, {{"missing_topic", {}}, {"wrong_type", {}}, {"empty_topic", {}}}};
}

}  // namespace softarm::check
