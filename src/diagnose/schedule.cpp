#include "schedule.h"

#include <algorithm>
#include <utility>

namespace softarm::diagnose {

Schedule::Schedule(Progress progress, std::function<double()> now_s)
    : progress_(std::move(progress)), now_s_(std::move(now_s)), begin_s_(now_s_()) {}

void Schedule::within(double from, double to) {
  from_ = from;
  to_ = to;
}

void Schedule::first_part(double share, const std::string& what) {
  tell(share, what);
}

void Schedule::begin_first_part(const std::string& what) {
  begin_s_ = now_s_();
  tell(0.0, what);
}

void Schedule::end_first_part() {
  part_s_ = now_s_() - begin_s_;
}

void Schedule::left(double parts, const std::string& what) {
  const double done_s = now_s_() - begin_s_, all_s = done_s + parts * part_s_;
  tell(all_s > 0.0 ? done_s / all_s : 0.0, what);
}

void Schedule::end() {
  within(0.0, 1.0);
  tell(1.0, "");
}

/// Never less than before: what turns out to take longer than it was thought to makes it wait.
void Schedule::tell(double share, const std::string& what) {
  share_ = std::clamp(from_ + (to_ - from_) * share, share_, 1.0);
  if (progress_) progress_(share_, what);
}

}  // namespace softarm::diagnose
