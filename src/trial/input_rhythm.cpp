#include "input_rhythm.h"

#include <algorithm>
#include <vector>

namespace softarm::trial {
namespace {

constexpr std::size_t kFewestSteps = 2;
constexpr std::size_t kFewestForIrregular = 8;
constexpr std::size_t kMostSteps = 33;
constexpr double kSameStamp_s = 2e-5;  // stamps of one clock tick, and what a double loses
constexpr double kUsual = 0.5;         // of the median: shorter steps are bursts
constexpr double kIrregular = 0.35;    // share of steps that are neither near the median nor a multiple of it

}  // namespace

StepPattern pattern_of(std::vector<double> steps_s) {
  const auto middle = steps_s.begin() + static_cast<std::ptrdiff_t>((steps_s.size() - 1) / 2);
  std::nth_element(steps_s.begin(), middle, steps_s.end());
  const double median_s = *middle;
  const auto odd = std::count_if(steps_s.begin(), steps_s.end(),
                                 [&](double s) { return s < kUsual * median_s || s > 1.5 * median_s; });
  const auto count = static_cast<double>(steps_s.size());
  return {median_s, steps_s.size() >= kFewestForIrregular && static_cast<double>(odd) > kIrregular * count};
}

void InputRhythm::add(double stamp_s) {
  if (newest_s_ && stamp_s <= *newest_s_ + kSameStamp_s) {
    newest_s_ = std::max(*newest_s_, stamp_s);
    return;
  }
  if (newest_s_) {
    steps_s_.push_back(stamp_s - *newest_s_);
    if (steps_s_.size() > kMostSteps) steps_s_.pop_front();
    learn();
  }
  newest_s_ = stamp_s;
}

void InputRhythm::learn() {
  const StepPattern pattern = pattern_of({steps_s_.begin(), steps_s_.end()});
  median_s_ = pattern.median_s;
  irregular_ = pattern.irregular;
  shortest_s_ = median_s_;
  for (const double s : steps_s_) {
    if (s >= kUsual * median_s_) shortest_s_ = std::min(shortest_s_, s);
  }
}

bool InputRhythm::is_due(double stamp_s) const {
  if (!newest_s_) return true;
  if (*newest_s_ >= stamp_s || irregular_) return false;
  const double step_s = steps_s_.size() < kFewestSteps ? 0.0 : shortest_s_;
  return stamp_s > *newest_s_ + step_s - kSameStamp_s;
}

std::optional<StepPattern> InputRhythm::pattern() const {
  if (steps_s_.size() < kFewestSteps) return std::nullopt;
  return StepPattern{median_s_, irregular_};
}

std::optional<double> InputRhythm::period_s() const {
  if (steps_s_.size() < kFewestSteps || irregular_) return {};
  return median_s_;
}

}  // namespace softarm::trial
