#include "strays.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "context.h"
#include "math/statistics.h"
#include "policy.h"

namespace softarm::check {
namespace {

const std::string kPayload = "payload";

struct Times {
  double from_s = 0.0, to_s = 0.0;
  std::size_t count = 0;
};

/// Calls see(samples, name) for every series of a recording.
template <typename Recording, typename See>
void each_series(Recording& recording, const arm::Arm& arm, const See& see) {
  for (std::size_t i = 0; i < recording.bodies.size(); ++i)
    see(recording.bodies[i], i == 0 ? arm.base.body.value_or("base") : arm.bodies[i - 1].name);
  for (std::size_t i = 0; i < recording.inputs.size(); ++i)
    see(recording.inputs[i], arm.inputs.scalars[i].name);
  see(recording.payload, kPayload);
}

/// Stretches of times without a pause that is too long.
std::vector<Times> stretches_of(std::vector<double> times_s) {
  std::sort(times_s.begin(), times_s.end());
  std::vector<Times> list;
  for (const double t : times_s) {
    if (list.empty() || t - list.back().to_s > kPolicy.timing.stray_s) list.push_back({t, t, 0});
    list.back().to_s = t;
    ++list.back().count;
  }
  return list;
}

/// Those that are the recording's.
std::vector<Times> kept_of(const std::vector<Times>& all) {
  if (all.size() < 2) return all;
  const auto main = std::max_element(all.begin(), all.end(),
                                     [](const Times& a, const Times& b) { return a.count < b.count; });
  std::vector<Times> kept;
  for (const Times& span : all)
    if (span.count > kPolicy.timing.few_strays || &span == &*main) kept.push_back(span);
  if (kept.back().to_s - kept.front().from_s > kPolicy.timing.longest_s) kept = {*main};
  return kept;
}

/// How far a time is from all of the spans.
double distance_s(const std::vector<Times>& spans, double t_s) {
  double least = std::numeric_limits<double>::infinity();
  for (const Times& span : spans)
    least = std::min(least, std::max({0.0, span.from_s - t_s, t_s - span.to_s}));
  return least;
}

/// @param off_s of a sample, 0: it stays
/// @param by_stamp whether the stamp of one that goes is elsewhere, too
template <typename Samples, typename Off, typename ByStamp>
void set_aside(Samples& samples, const std::string& name, bool of_receipt, const Off& off_s,
               const ByStamp& by_stamp, Strays& strays) {
  const std::size_t all = samples.size();
  const auto gone = [&](const auto& sample) {
    const double off = off_s(sample);
    if (off == 0.0) return false;
    Stray& stray = strays.by_source[name];
    ++stray.count;
    stray.of = std::max(stray.of, all);
    stray.stamped += by_stamp(sample);
    if (std::abs(off) > std::abs(stray.off_s)) {
      stray.off_s = off;
      stray.of_receipt = of_receipt;
    }
    return true;
  };
  samples.erase(std::remove_if(samples.begin(), samples.end(), gone), samples.end());
}

std::string duration(double s) {
  constexpr double kHour_s = 3600.0, kDay_s = 24.0 * kHour_s;
  return s < 2.0 * kDay_s ? fmt::format("{:.3g} hours", s / kHour_s) : fmt::format("{:.3g} days", s / kDay_s);
}

/// Share of the frames that have a body or an input; absent where it is not known.
std::optional<double> share_of_frames_with(const Context& context, const std::string& name) {
  std::size_t known = 0, with = 0;
  const auto& scalars = context.arm.inputs.scalars;
  const auto input =
      std::find_if(scalars.begin(), scalars.end(), [&](const arm::ScalarInput& s) { return s.name == name; });
  for (const trial::Frame& frame : context.recording.frames) {
    if (input != scalars.end()) {
      if (frame.inputs.empty()) continue;
      const auto number = static_cast<std::size_t>(input - scalars.begin());
      with += number < frame.inputs.size() && frame.inputs[number].has_value();
    } else if (name == context.arm.base.body) {
      with += frame.base_body.has_value();
    } else {
      with += std::any_of(frame.bodies.begin(), frame.bodies.end(), [&](const trial::BodyObservation& b) {
        return context.arm.bodies[static_cast<std::size_t>(b.body)].name == name;
      });
    }
    ++known;
  }
  return known > 0 ? std::optional(static_cast<double>(with) / static_cast<double>(known)) : std::nullopt;
}

/// Serious: more than single messages, and the programs do without them, as they go by the stamps. Of the
/// payload check_payload says what frames do without.
Severity severity_of(const Context& context, const std::string& name, const Stray& stray) {
  constexpr const Policy::Timing& kBy = kPolicy.timing;
  const auto much = [&](std::size_t part) {
    return static_cast<double>(part) > kBy.serious_gap_share * static_cast<double>(stray.of);
  };
  if (name == kPayload) {
    const auto& frames = context.recording.frames;
    const bool known = std::all_of(frames.begin(), frames.end(),
                                   [](const trial::Frame& f) { return f.payload_kg.has_value(); });
    // Where all bodies are of another clock, what came before the first of them is bound to be stray.
    const bool of_that = context.body_epoch.all_s() != 0.0 && !frames.empty() && known;
    return of_that ? Severity::kInformation : Severity::kWarning;
  }
  if (stray.count <= kBy.few_strays || !much(stray.count)) return Severity::kWarning;
  const std::optional<double> seen = share_of_frames_with(context, name);
  const bool lost = much(stray.stamped) || (seen && *seen < 1.0 - kBy.serious_gap_share);
  return lost ? Severity::kSerious : Severity::kWarning;
}

void check_strays(Context& context) {
  for (const auto& [name, stray] : context.strays) {
    const Severity severity = severity_of(context, name, stray);
    CheckFinding& finding =
        context.add(severity, "stray_times", name,
                    fmt::format("{} message{} {} {} {} the others, and {} left out here", stray.count,
                                stray.count == 1 ? " is" : "s are", stray.of_receipt ? "recorded" : "stamped",
                                duration(std::abs(stray.off_s)), stray.off_s < 0.0 ? "before" : "after",
                                stray.count == 1 ? "is" : "are"));
    finding.figure = std::abs(stray.off_s);
    finding.unit = "s";
    finding.remedy =
        severity == Severity::kSerious
            ? "one clock for all that is recorded, set before the recording begins (chrony); cut "
              "this one there (rosbag filter)"
            : "a clock that was not set yet, or damage; cut them out (rosbag filter)";
  }
}

}  // namespace

Strays without_strays(const trial::CheckRecording& recording, const arm::Arm& arm) {
  Strays strays{recording, {}};
  std::vector<double> receipts_s, stamps_s;
  each_series(recording, arm, [&](const auto& samples, const std::string&) {
    for (const auto& sample : samples) receipts_s.push_back(sample.receipt_s);
  });
  const std::vector<Times> kept = kept_of(stretches_of(std::move(receipts_s)));
  each_series(recording, arm, [&](const auto& samples, const std::string&) {
    for (const auto& sample : samples)
      if (distance_s(kept, sample.receipt_s) == 0.0 && sample.stamp_s > 0.0 && std::isfinite(sample.stamp_s))
        stamps_s.push_back(sample.stamp_s);
  });
  const std::vector<Times> stamped = stretches_of(std::move(stamps_s));
  each_series(strays.kept, arm, [&](auto& samples, const std::string& name) {
    set_aside(
        samples, name, true,
        [&](const auto& s) {
          const double off_s = distance_s(kept, s.receipt_s);
          return s.receipt_s < kept.front().from_s ? -off_s : off_s;
        },
        [&](const auto& s) { return !(distance_s(stamped, s.stamp_s) < kPolicy.timing.stray_s); }, strays);
    // A clock of its own may have any epoch; few samples of it cannot have another.
    std::vector<double> ahead_s;
    for (const auto& s : samples)
      if (s.stamp_s > 0.0 && std::isfinite(s.stamp_s)) ahead_s.push_back(s.stamp_s - s.receipt_s);
    const std::vector<Times> clocks = kept_of(stretches_of(ahead_s));
    set_aside(
        samples, name, false,
        [&](const auto& s) {
          if (!(s.stamp_s > 0.0) || !std::isfinite(s.stamp_s)) return 0.0;  // said elsewhere
          const double ahead = s.stamp_s - s.receipt_s, off_s = distance_s(clocks, ahead);
          return ahead < clocks.front().from_s ? -off_s : off_s;
        },
        [](const auto&) { return true; }, strays);
  });
  return strays;
}

Check make_strays() {
  return {check_strays, {{"stray_times", {}}}};
}

}  // namespace softarm::check
