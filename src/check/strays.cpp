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
  see(recording.payload, std::string("payload"));
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
template <typename Samples, typename Off>
void set_aside(Samples& samples, const std::string& name, bool of_receipt, const Off& off_s, Strays& strays) {
  const auto gone = [&](const auto& sample) {
    const double off = off_s(sample);
    if (off == 0.0) return false;
    Stray& stray = strays.by_source[name];
    ++stray.count;
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

void check_strays(Context& context) {
  for (const auto& [name, stray] : context.strays) {
    CheckFinding& finding =
        context.add("stray_times", name,
                    fmt::format("{} message{} {} {} {} the others, and {} left out here", stray.count,
                                stray.count == 1 ? " is" : "s are", stray.of_receipt ? "recorded" : "stamped",
                                duration(std::abs(stray.off_s)), stray.off_s < 0.0 ? "before" : "after",
                                stray.count == 1 ? "is" : "are"));
    finding.figure = std::abs(stray.off_s);
    finding.unit = "s";
    finding.remedy = "a clock that was not set yet, or damage; cut them out (rosbag filter)";
  }
}

}  // namespace

Strays without_strays(const trial::CheckRecording& recording, const arm::Arm& arm) {
  Strays strays{recording, {}};
  std::vector<double> receipts_s;
  each_series(recording, arm, [&](const auto& samples, const std::string&) {
    for (const auto& sample : samples) receipts_s.push_back(sample.receipt_s);
  });
  const std::vector<Times> kept = kept_of(stretches_of(std::move(receipts_s)));
  each_series(strays.kept, arm, [&](auto& samples, const std::string& name) {
    set_aside(
        samples, name, true,
        [&](const auto& s) {
          const double off_s = distance_s(kept, s.receipt_s);
          return s.receipt_s < kept.front().from_s ? -off_s : off_s;
        },
        strays);
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
        strays);
  });
  return strays;
}

Check make_strays() {
  return {check_strays, {{"stray_times", Severity::kWarning}}};
}

}  // namespace softarm::check
