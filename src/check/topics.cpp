// Topics that the arm expects, against those that the recording has.
#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <string>
#include <vector>

#include "arm/body_types.h"
#include "arm/edit_distance.h"
#include "context.h"
#include "policy.h"
#include "settings.h"

namespace softarm::check {
namespace {

/// Whether every part of a topic's name is another's, or nearly: "tip" is no slip of the pen for "base".
bool alike(const std::string& a, const std::string& b) {
  std::vector<std::string> of_a, of_b;
  boost::split(of_a, a, boost::is_any_of("/"));
  boost::split(of_b, b, boost::is_any_of("/"));
  if (of_a.size() != of_b.size()) return true;  // a prefix more or less
  return std::equal(of_a.begin(), of_a.end(), of_b.begin(), [](const std::string& x, const std::string& y) {
    return x == y || arm::yaml::nearest_word(x, {y});
  });
}

/// Another topic of the right type that may be the missing one under another name.
std::optional<std::string> near_miss(const trial::RecordedTopic& missing,
                                     const trial::CheckRecording& recording) {
  std::vector<std::string> same_type, any;
  for (const auto& [topic, type] : recording.other_topics) {
    any.push_back(topic);
    if (type == missing.type) same_type.push_back(topic);
  }
  for (const std::vector<std::string>& list : {same_type, any}) {
    const auto near = arm::yaml::nearest_word(missing.topic, list);
    if (near && alike(missing.topic, *near)) return near;
  }
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

/// Inputs that come by a topic.
std::vector<const arm::ScalarInput*> inputs_by(const Context& context, const trial::RecordedTopic& topic) {
  std::vector<const arm::ScalarInput*> inputs;
  for (const arm::ScalarInput& input : context.arm.inputs.scalars) {
    if (input.topic == topic.topic) inputs.push_back(&input);
  }
  return inputs;
}

/// Where the arm file names a topic: of an input, of all bodies, or, where <body> stands in it, the body.
std::string renamed(const Context& context, const trial::RecordedTopic& topic, const std::string& name) {
  if (!topic.of_bodies) {
    std::vector<std::string> settings;
    for (const arm::ScalarInput* input : inputs_by(context, topic))
      settings.push_back(path_of(*input) + ".topic: " + name);
    return joined(settings);
  }
  const arm::Inputs& inputs = context.arm.inputs;
  const bool own_source = topic.is_base && inputs.base;
  const std::string& pattern = (own_source ? *inputs.base : inputs.bodies).topic;
  const std::string key = own_source ? "inputs.base.topic: " : "inputs.bodies.topic: ";
  const std::string word = "<body>";
  const std::size_t at = pattern.find(word);
  if (at == std::string::npos) return key + name;
  const std::string before = pattern.substr(0, at), after = pattern.substr(at + word.size());
  const bool fits = name.size() > before.size() + after.size() && boost::starts_with(name, before) &&
                    boost::ends_with(name, after);
  if (fits) {
    const std::string body = name.substr(before.size(), name.size() - before.size() - after.size());
    if (boost::contains(body, "/")) return "";
    return (topic.is_base ? "base.body" : "bodies[" + topic.feeds + "].name") + std::string(": ") + body;
  }
  // Another place for all of them, if the body's name stands there as it does here.
  std::string other = name;
  boost::replace_all(other, topic.feeds, word);
  return other != name ? key + other : "";
}

/// Where the arm file names a type; empty where more than the type would differ.
std::string retyped(const Context& context, const trial::RecordedTopic& topic) {
  if (topic.of_bodies) {
    const auto& types = arm::yaml::body_types();
    const auto message_of = [&](const std::string& type) {
      const auto known = std::find_if(types.begin(), types.end(),
                                      [&](const arm::yaml::BodyType& t) { return t.type == type; });
      return known == types.end() ? std::nullopt : std::optional(known->message);
    };
    const bool poses = message_of(topic.found_type) == arm::yaml::BodyMessage::kPose &&
                       message_of(topic.type) == arm::yaml::BodyMessage::kPose;
    const bool own_source = topic.is_base && context.arm.inputs.base;
    return poses ? (own_source ? "inputs.base.type: " : "inputs.bodies.type: ") + topic.found_type : "";
  }
  std::vector<std::string> settings;
  for (const arm::ScalarInput* input : inputs_by(context, topic)) {
    const bool pressure = input->kind == arm::InputKind::kPressure || input->kind == arm::InputKind::kVacuum;
    const bool plain = topic.found_type == "std_msgs/Float64" ||
                       (pressure && topic.found_type == "sensor_msgs/FluidPressure");
    if (!plain || !input->field.empty() || input->element != 0) return "";
    settings.push_back(path_of(*input) + ".type: " + topic.found_type);
  }
  return joined(settings);
}

void say_missing(Context& context, const trial::RecordedTopic& topic, bool no_body_at_all) {
  if (topic.of_payload) return;  // check_payload has its own words
  const bool serious = topic.is_base || (topic.of_bodies && no_body_at_all);
  CheckFinding& finding =
      context.add(serious ? Severity::kSerious : Severity::kWarning, "missing_topic", topic.topic,
                  fmt::format("is not in the recording ({} is expected on it, as {}); the recording has {}",
                              topic.feeds, topic.type, listed(context.recording)));
  finding.remedy =
      "record it (rosbag record), or correct its name in the arm file or of the body in the "
      "driver";
  if (const auto near = near_miss(topic, context.recording)) {
    finding.remedy = fmt::format(
        "is {} meant? Then use that name in the arm file, or rename the topic with rosbag filter", *near);
    finding.setting = renamed(context, topic, *near);
  }
}

/// Whether two names differ in one part alone: /pressure/chamber_3, or /mocap/ring_4/pose.
bool differ_in_one_part(const std::string& a, const std::string& b) {
  std::vector<std::string> of_a, of_b;
  boost::split(of_a, a, boost::is_any_of("/"));
  boost::split(of_b, b, boost::is_any_of("/"));
  if (of_a.size() != of_b.size()) return false;
  int other = 0;
  for (std::size_t i = 0; i < of_a.size(); ++i) other += of_a[i] != of_b[i];
  return other == 1;
}

/// What is published beside, and as, what the arm file names: a fourth ring, a third chamber. Another that is
/// missing may go by that name instead; then this is said of that one.
void say_unused(Context& context) {
  const auto& topics = context.recording.topics;
  for (const auto& [name, type] : context.recording.other_topics) {
    const auto like =
        std::find_if(topics.begin(), topics.end(), [&, &topic = name, &of_type = type](const auto& known) {
          return known.type == of_type && !known.of_payload && differ_in_one_part(known.topic, topic);
        });
    if (like == topics.end()) continue;
    const bool instead = std::any_of(topics.begin(), topics.end(), [&, &topic = name](const auto& known) {
      return known.found_type.empty() && near_miss(known, context.recording) == topic;
    });
    if (instead) continue;
    CheckFinding& finding =
        context.add(like->of_bodies ? Severity::kInformation : Severity::kWarning, "unused_topic", name,
                    fmt::format("is recorded beside {}, and the arm file does not name it", like->topic));
    finding.remedy = like->of_bodies ? "one more body says more about the shape: add it under 'bodies'"
                                     : "add it under 'inputs' if it drives this arm; otherwise what it does "
                                       "is taken for errors of the other inputs";
  }
}

/// How bad it is that nothing of a topic can be read.
Severity severity_without(const Context& context, const trial::RecordedTopic& topic, bool no_body_at_all) {
  const bool payload_is_needed =
      topic.of_payload && context.arm.estimator.unknown == arm::Unknown::kStiffness;
  const bool serious = topic.is_base || (topic.of_bodies && no_body_at_all) || payload_is_needed;
  return serious ? Severity::kSerious : Severity::kWarning;
}

std::string payload_unknown(const Context& context) {
  const auto assumed = context.arm.payload.default_kg;
  return ": the payload is unknown throughout" +
         (assumed ? fmt::format(", {:g} kg is assumed", *assumed) : std::string());
}

void say_wrong_type(Context& context, const trial::RecordedTopic& topic, bool no_body_at_all) {
  CheckFinding& finding =
      context.add(severity_without(context, topic, no_body_at_all), "wrong_type", topic.topic,
                  fmt::format("is {}, the arm expects {} ({})", topic.found_type, topic.type, topic.feeds));
  if (topic.of_payload) {  // the arm file has no key for it
    finding.what += payload_unknown(context);
    finding.remedy = fmt::format("publish it as {}, in kg; or estimate with --payload KG", topic.type);
    return;
  }
  finding.remedy = "name the type that the driver publishes in the arm file";
  finding.setting = retyped(context, topic);
}

/// A type's name does not say what it holds: where the recording was made it was defined otherwise.
void say_other_definition(Context& context, const trial::RecordedTopic& topic, bool no_body_at_all) {
  const bool all = topic.messages == 0;
  const std::uint64_t count = topic.messages + topic.unread;
  CheckFinding& finding = context.add(
      all ? severity_without(context, topic, no_body_at_all) : Severity::kWarning, "other_definition",
      topic.topic,
      fmt::format("{} {} by another definition (MD5 {}) than the one known here, and not read ({})",
                  all ? "is" : fmt::format("in {} of {} messages is", topic.unread, count), topic.type,
                  topic.unread_md5, topic.feeds));
  finding.figure = static_cast<double>(topic.unread) / static_cast<double>(count);
  finding.unit = "1";
  if (all && topic.of_payload) finding.what += payload_unknown(context);
  finding.remedy = fmt::format(
      "record it again with the messages known here, or convert the recording: rosbag fix; rosmsg md5 {} "
      "tells which definition a machine has{}",
      topic.type, topic.of_payload ? "; or estimate with --payload KG" : "");
}

/// Messages that no estimate can use. Where that is every one, estimates end there, or lack what it feeds.
void say_undecodable(Context& context, const trial::RecordedTopic& topic) {
  const std::size_t lost = topic.undecodable_s.size();
  const std::uint64_t count = topic.messages + lost;
  CheckFinding& finding =
      context.add(topic.messages == 0 ? Severity::kSerious : Severity::kWarning, "undecodable", topic.topic,
                  fmt::format("{} of {} messages cannot be read, as their bytes do not fit their definition "
                              "({}); they are left out",
                              lost, count, topic.feeds));
  finding.figure = static_cast<double>(lost) / static_cast<double>(count);
  finding.unit = "1";
  std::vector<double> times_s;
  for (const double receipt_s : topic.undecodable_s)
    times_s.push_back(std::max(0.0, receipt_s - context.begin_s));
  finding.spans = spans_of(times_s, kPolicy.timing.one_stretch_s);
  finding.remedy = fmt::format(
      "damaged on their way, or of another version of their driver: copy the recording again, or record it "
      "again{}",
      topic.of_payload ? "; or estimate with --payload KG" : "");
}

void check_topics(Context& context) {
  const auto& topics = context.recording.topics;
  const bool no_body = std::none_of(topics.begin(), topics.end(), [](const trial::RecordedTopic& t) {
    return t.of_bodies && !t.is_base && t.found_type == t.type && t.messages > 0;
  });
  for (const trial::RecordedTopic& topic : topics) {
    if (!topic.undecodable_s.empty()) say_undecodable(context, topic);
    if (topic.found_type.empty()) {
      say_missing(context, topic, no_body);
    } else if (topic.found_type != topic.type) {
      say_wrong_type(context, topic, no_body);
    } else if (topic.unread > 0) {
      say_other_definition(context, topic, no_body);
    } else if (topic.messages == 0 && topic.undecodable_s.empty() && !topic.of_payload) {
      context
          .add(topic.is_base ? Severity::kSerious : Severity::kWarning, "empty_topic", topic.topic,
               fmt::format("is announced, but not one message was recorded ({})", topic.feeds))
          .remedy = "check whether the driver sees the body, or the sensor is connected";
    }
  }
  say_unused(context);
}

}  // namespace

Check make_topics() {
  return {check_topics,
          {{"missing_topic", {}},
           {"wrong_type", {}},
           {"other_definition", {}},
           {"undecodable", {}},
           {"empty_topic", {}},
           {"unused_topic", {}}}};
}

}  // namespace softarm::check
