#include "alarm_wait.h"

namespace softarm {

void AlarmWait::begin(const ros::Time& now, const ros::SteadyTime& steady) {
  waiting_ = Waiting{now, now, steady};
}

bool AlarmWait::over(const ros::Time& now, const ros::SteadyTime& steady) {
  if (!waiting_) return false;
  if (now < waiting_->last) waiting_->since = now;
  if (now != waiting_->last) {
    waiting_->last = now;
    waiting_->moved = steady;
  }
  // Not by ros::Duration, which ends at 68 years: a simulated clock may leap by more.
  const double passed_s = now.toSec() - waiting_->since.toSec();
  if (passed_s < wait_s_ && (steady - waiting_->moved).toSec() < wait_s_) return false;
  waiting_.reset();
  return true;
}

}  // namespace softarm
