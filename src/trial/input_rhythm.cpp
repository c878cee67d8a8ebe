#include "softarm/trial/input_rhythm.h"

#include <algorithm>
#include <vector>

namespace softarm {
namespace {

constexpr std::size_t kFewestSteps = 2;
constexpr std::size_t kMostSteps = 33;
constexpr double kSameStamp_s = 2e-5;  // stamps of one clock tick, and what a double loses
constexpr double kUsual = 0.5;         // of the median: shorter steps are bursts
constexpr double kIrregular = 0.35;    // share of steps that are neither near the median nor a multiple of it

}  // namespace

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
  std::vector<double> sorted(steps_s_.begin(), steps_s_.end());
  std::sort(sorted.begin(), sorted.end());
  median_s_ = sorted[(sorted.size() - 1) / 2];
  shortest_s_ =
      *std::find_if(sorted.begin(), sorted.end(), [&](double s) { return s >= kUsual * median_s_; });
  const auto odd = std::count_if(sorted.begin(), sorted.end(),
                                 [&](double s) { return s < kUsual * median_s_ || s > 1.5 * median_s_; });
  irregular_ =
      sorted.size() >= 8 && static_cast<double>(odd) > kIrregular * static_cast<double>(sorted.size());
}

bool InputRhythm::is_due(double stamp_s) const {
  if (!newest_s_) return true;
  if (*newest_s_ >= stamp_s || irregular_) return false;
  const double step_s = steps_s_.size() < kFewestSteps ? 0.0 : shortest_s_;
  return stamp_s > *newest_s_ + step_s + kSameStamp_s;
}

std::optional<double> InputRhythm::period_s() const {
  if (steps_s_.size() < kFewestSteps || irregular_) return {};
  return median_s_;
}

}  // namespace softarm
