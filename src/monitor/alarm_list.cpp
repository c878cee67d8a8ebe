#include "alarm_list.h"

#include <fmt/format.h>

#include <algorithm>

namespace softarm::monitor {
namespace {

constexpr std::size_t kMostAlarms = 20;

}  // namespace

void AlarmList::add(const Mismatch& mismatch) {
  if (!first_s_) first_s_ = mismatch.stamp_s;
  if (mismatch.alarm) {
    if (!alarmed_) {
      if (alarms_.size() < kMostAlarms) {
        alarms_.emplace_back();
      } else {
        ++more_;
      }
    }
    if (more_ == 0) {
      alarms_.back() = {mismatch.onset_s.value_or(mismatch.stamp_s) - *first_s_, mismatch.stamp_s - *first_s_,
                        mismatch.description};
    }
  }
  alarmed_ = mismatch.alarm;
}

std::string AlarmList::text() const {
  if (alarms_.empty()) return fmt::format("{:<28}none\n", "alarms (sudden changes):");
  std::string text = fmt::format("{:<28}{}\n", "alarms (sudden changes):", alarms_.size() + more_);
  for (const Alarm& alarm : alarms_) {
    text += fmt::format("  {:<26}{}\n", fmt::format("{:.2f} ... {:.2f} s", alarm.onset_s, alarm.seen_s),
                        alarm.description);
  }
  if (more_ > 0) text += fmt::format("  ... and {} more\n", more_);
  return text;
}

}  // namespace softarm::monitor
