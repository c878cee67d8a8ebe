// Whether the payload is known, and when.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "context.h"
#include "policy.h"

namespace softarm::check {
namespace {

void check_payload(Context& context) {
  const arm::Arm& arm = context.arm;
  const auto topic = std::find_if(context.recording.topics.begin(), context.recording.topics.end(),
                                  [](const trial::RecordedTopic& t) { return t.of_payload; });
  if (context.payload.empty()) {
    const bool assumed = arm.payload.default_kg.has_value();
    const bool asked = arm.estimator.unknown != arm::Unknown::kStiffness;
    CheckFinding& finding = context.add(
        "payload_unknown", arm.inputs.payload_topic,
        topic != context.recording.topics.end() && !topic->found_type.empty()
            ? "is there, but nothing was published on it: the payload is unknown throughout"
            : fmt::format("is not in the recording: the payload is unknown throughout{}",
                          assumed ? fmt::format(", {:g} kg is assumed", *arm.payload.default_kg) : ""));
    if (!asked && !assumed) {
      finding.what += "; estimating the stiffness needs it";
      finding.remedy = "publish it latched (0 for none), estimate with --payload KG, or with --unknown both";
      if (arm.payload.range_kg.low <= 0.0) finding.setting = "payload.default_kg: 0";
    }
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
  if (first_s > kPolicy.payload.late_s) {
    CheckFinding& finding =
        context.add("payload_late", arm.inputs.payload_topic,
                    fmt::format("is first said after {:.1f} s: unknown until then", first_s));
    finding.figure = first_s;
    finding.unit = "s";
    finding.spans = {{0.0, first_s}};
    finding.remedy = "publish it latched before the recording begins";
  }
}

}  // namespace

Check make_payload() {
  return {check_payload,
          {{"payload_unknown", Severity::kInformation},
           {"payload_range", Severity::kSerious},
           {"payload_late", Severity::kInformation}}};
}

}  // namespace softarm::check
