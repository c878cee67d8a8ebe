#include <algorithm>
#include <cmath>

#include "input_rhythm.h"
#include "softarm/trial/trial.h"

namespace softarm::trial {
namespace {

constexpr double kSlowest_s = 0.5;    // steps of a sensor; a slower steady input is a programme of commands
constexpr double kLongestLine = 2.5;  // in steps
constexpr std::size_t kFewestForRhythm = 2;  // that make a rhythm
constexpr std::int64_t kSame_ns = 1'000;     // a double of seconds holds a stamp to a quarter of this

}  // namespace

void InputSeries::add(std::int64_t at_ns, double sample) {
  const auto place = std::lower_bound(stamp_ns.begin(), stamp_ns.end(), at_ns);
  const auto beside = value.begin() + (place - stamp_ns.begin());
  if (place != stamp_ns.end() && *place == at_ns) {
    *beside = sample;
    return;
  }
  value.insert(beside, sample);
  stamp_ns.insert(place, at_ns);
}

void InputSeries::decide(std::optional<arm::Between> stated) {
  std::vector<double> steps_s;
  for (std::size_t i = 1; i < stamp_ns.size(); ++i)
    steps_s.push_back(1e-9 * static_cast<double>(stamp_ns[i] - stamp_ns[i - 1]));
  decide(stated, steps_s.size() < kFewestForRhythm ? std::nullopt : std::optional(pattern_of(steps_s)));
}

void InputSeries::decide(std::optional<arm::Between> stated, const std::optional<StepPattern>& pattern) {
  const bool steady = pattern && !pattern->irregular && pattern->median_s <= kSlowest_s;
  between = stated.value_or(steady ? arm::Between::kSampled : arm::Between::kHeld);
  longest_line_ns = pattern ? std::llround(1e9 * kLongestLine * pattern->median_s) : 0;
}

std::optional<double> InputSeries::at_ns(std::int64_t t_ns) const {
  const auto after = std::upper_bound(stamp_ns.begin(), stamp_ns.end(), t_ns + kSame_ns);
  if (after == stamp_ns.begin()) return std::nullopt;
  const auto next = static_cast<std::size_t>(after - stamp_ns.begin());
  const std::int64_t begin_ns = stamp_ns[next - 1];
  const bool line =
      between == arm::Between::kSampled && after != stamp_ns.end() && *after - begin_ns <= longest_line_ns;
  if (!line) return value[next - 1];
  const double w =
      std::max(0.0, static_cast<double>(t_ns - begin_ns) / static_cast<double>(stamp_ns[next] - begin_ns));
  return value[next - 1] + w * (value[next] - value[next - 1]);
}

std::optional<double> InputSeries::fresh_at_ns(std::int64_t t_ns, double max_age_s) const {
  const auto after = std::upper_bound(stamp_ns.begin(), stamp_ns.end(), t_ns + kSame_ns);
  if (after == stamp_ns.begin() || 1e-9 * static_cast<double>(t_ns - *(after - 1)) > max_age_s)
    return std::nullopt;
  return at_ns(t_ns);
}

void InputSeries::forget_before(double stamp_s, std::size_t at_most) {
  const auto after = std::upper_bound(stamp_ns.begin(), stamp_ns.end(), to_nanoseconds(stamp_s));
  const std::ptrdiff_t stale = after - stamp_ns.begin() - 1;
  if (stale <= static_cast<std::ptrdiff_t>(at_most)) return;
  stamp_ns.erase(stamp_ns.begin(), stamp_ns.begin() + stale);
  value.erase(value.begin(), value.begin() + stale);
}

}  // namespace softarm::trial
