// Whether the payload is known, and when.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "context.h"
#include "policy.h"

namespace softarm::check {
namespace {

void say_unknown(Context& context) {
  const arm::Arm& arm = context.arm;
  const auto topic = std::find_if(context.recording.topics.begin(), context.recording.topics.end(),
                                  [](const trial::RecordedTopic& t) { return t.of_payload; });
  const bool there = topic != context.recording.topics.end() && !topic->found_type.empty();
  // check_topics has said it
  const auto unreadable = [](const trial::RecordedTopic& t) {
    return t.messages == 0 && (t.unread > 0 || !t.undecodable_s.empty());
  };
  if (there && (topic->found_type != topic->type || unreadable(*topic))) return;
  const bool assumed = arm.payload.default_kg.has_value();
  const bool asked = arm.estimator.unknown != arm::Unknown::kStiffness;
  CheckFinding& finding = context.add(
      Severity::kInformation, "payload_unknown", arm.inputs.payload_topic,
      there ? "is recorded, but no payload was published on it: the payload is unknown throughout"
            : fmt::format("is not in the recording: the payload is unknown throughout{}",
                          assumed ? fmt::format(", {:g} kg is assumed", *arm.payload.default_kg) : ""));
  if (!asked && !assumed) {
    finding.what += "; estimating the stiffness needs it";
    finding.remedy = "publish it latched (0 for none), estimate with --payload KG, or with --unknown both";
    if (arm.payload.range_kg.low <= 0.0) finding.setting = "payload.default_kg: 0";
  }
}

/// Share of the frames that do not know it; absent without frames.
std::optional<double> unknown_share(const Context& context) {
  const auto& frames = context.recording.frames;
  if (frames.empty()) return std::nullopt;
  const auto unknown = std::count_if(frames.begin(), frames.end(),
                                     [](const trial::Frame& frame) { return !frame.payload_kg; });
  return static_cast<double>(unknown) / static_cast<double>(frames.size());
}

/// What is said before the first body goes by the time of its receipt: where the bodies' clock is behind
/// that, it is for them not said yet.
void say_in_vain(Context& context, double share) {
  const auto assumed_kg = context.arm.payload.default_kg;
  const bool needed = context.arm.estimator.unknown == arm::Unknown::kStiffness && !assumed_kg;
  CheckFinding& finding = context.add(
      needed ? Severity::kSerious : Severity::kWarning, "payload_unknown", context.arm.inputs.payload_topic,
      fmt::format("was published, but by its time of receipt after {:.0f} % of the frames: unknown in them{}",
                  100.0 * share, assumed_kg ? fmt::format(", {:g} kg is assumed", *assumed_kg) : ""));
  finding.figure = share;
  finding.unit = "1";
  finding.remedy =
      "use one clock for the recorder and for what stamps the bodies, or publish the payload repeatedly "
      "during the recording (rostopic pub -r 1); until then estimate with --payload KG";
}

void check_payload(Context& context) {
  const arm::Arm& arm = context.arm;
  const bool stray = context.strays.count("payload") > 0;
  const bool other_clock = stray || context.body_epoch.all_s() != 0.0;
  const double share = unknown_share(context).value_or(0.0);
  const bool said = !context.payload.empty() || stray;
  if (said && other_clock && share > kPolicy.timing.serious_gap_share) say_in_vain(context, share);
  if (context.payload.empty()) {
    if (!stray) say_unknown(context);
    return;
  }
  double low = context.payload.front().value, high = low;
  for (const ValuePoint& p : context.payload) {
    low = std::min(low, p.value);
    high = std::max(high, p.value);
  }
  if (!(low >= arm.payload.range_kg.low && high <= arm.payload.range_kg.high)) {
    CheckFinding& finding =
        context.add("payload_range", arm.inputs.payload_topic,
                    fmt::format("says {:g} to {:g} kg, the arm file allows {:g} to {:g} kg: refused{}", low,
                                high, arm.payload.range_kg.low, arm.payload.range_kg.high,
                                high > kPolicy.payload.grams * arm.payload.range_kg.high ? "; grams?" : ""));
    finding.figure = high;
    finding.unit = "kg";
    finding.remedy = "publish kilograms, or widen the range";
    const bool grams = high > kPolicy.payload.grams * arm.payload.range_kg.high;
    if (low >= 0.0 && high <= kPolicy.payload.most_kg && !grams) {
      finding.setting =
          fmt::format("payload.range_kg: [{:.6g}, {:.6g}]", std::min(low, arm.payload.range_kg.low),
                      std::max(high, arm.payload.range_kg.high));
    }
  }
  const double first_s = context.payload.front().t_s;
  if (!other_clock && first_s > kPolicy.payload.late_s) {
    CheckFinding& finding =
        context.add("payload_late", arm.inputs.payload_topic,
                    fmt::format("is first published after {:.1f} s: unknown until then", first_s));
    finding.figure = first_s;
    finding.unit = "s";
    finding.spans = {{0.0, first_s}};
    finding.remedy = "publish it latched before the recording begins";
  }
}

}  // namespace

Check make_payload() {
  return {check_payload,
          {{"payload_unknown", {}},
           {"payload_range", Severity::kSerious},
           {"payload_late", Severity::kInformation}}};
}

}  // namespace softarm::check
