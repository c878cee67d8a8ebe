// What the estimator node says of the arm's departures from its laws.
#include <fmt/format.h>

#include <cmath>

#include "estimator_node.h"
#include "mismatch_message.h"

namespace softarm {

using diagnostic_msgs::DiagnosticStatus;
using monitor::Mismatch;

/// @return whether an alarm has begun or ended
bool EstimatorNode::watch(const trial::Frame& frame) {
  if (!monitor_) return false;
  const bool was_alarm = mismatch_ && mismatch_->alarm;
  const estimate::Estimator::ByLaws plain = estimator_.by_laws();
  mismatch_ = &monitor_->add(plain.frame, plain.estimate);
  const MessageContext context{params_.arm, estimator_.options(), params_.frames,
                               nearest_time(frame.stamp_ns)};
  publish_finite(mismatch_publisher_, to_message(*mismatch_, context));
  if (mismatch_->alarm) {
    last_alarm_ = *mismatch_;
    alarms_ += !was_alarm;
  }
  if (mismatch_->alarm == was_alarm) return false;
  if (mismatch_->alarm) {
    ROS_WARN("mismatch: %s", mismatch_->description.c_str());
  } else {
    ROS_INFO("mismatch: the alarm is over");
  }
  return true;
}

void EstimatorNode::diagnose_mismatch(diagnostic_updater::DiagnosticStatusWrapper& status) {
  if (!monitor_) {
    status.summary(DiagnosticStatus::OK, "not watched (monitor is false)");
    return;
  }
  if (!mismatch_ || !mismatch_->valid) {
    status.summary(DiagnosticStatus::OK, "not enough frames yet");
  } else if (mismatch_->alarm) {
    status.summary(DiagnosticStatus::WARN,
                   fmt::format("{}, for {:.1f} s (since {:.3f})", mismatch_->description,
                               mismatch_->stamp_s - mismatch_->onset_s.value_or(mismatch_->stamp_s),
                               mismatch_->onset_s.value_or(mismatch_->stamp_s)));
  } else {
    status.summary(DiagnosticStatus::OK, mismatch_->description);
  }
  if (mismatch_ && mismatch_->valid) {
    status.add("score (sd of the noise)", fmt::format("{:.2f}", mismatch_->score_sd));
    status.add("rms (mm)", fmt::format("{:.2f}", 1e3 * mismatch_->rms_m));
    status.add("change (sd)", fmt::format("{:.1f}", mismatch_->change_sd));
    status.add("threshold (sd)", fmt::format("{:g}", mismatch_->threshold_sd));
    status.add("laws", mismatch_->laws ? "applied" : "inputs missing: only the fit's residuals are watched");
  }
  status.add("alarms", alarms_);
  if (last_alarm_) {
    status.add("last alarm", last_alarm_->description);
    status.add("last alarm, kind", to_string(last_alarm_->kind));
    status.add("last alarm, onset (s)", fmt::format("{:.3f}", last_alarm_->onset_s.value_or(0.0)));
  }
}

}  // namespace softarm
