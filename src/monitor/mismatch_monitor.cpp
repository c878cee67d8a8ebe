#include <algorithm>
#include <cmath>
#include <vector>

#include "mismatch_description.h"
#include "mismatch_monitor_impl.h"
#include "policy.h"

namespace softarm::monitor {
namespace {

using Eigen::Vector3d;

const std::vector<arm::SegmentPrediction> kNoLaws;

}  // namespace

void MismatchMonitor::Impl::reset() {
  memory.reset();
  window.reset();
  reference.reset();
  mismatch = Mismatch();
  pasts = 0;
  last_frame_s.reset();
  last_step_s.reset();
  first_s.reset();
  payload_change_s.reset();
  over_since_s.reset();
  below_since_s.reset();
  suspicious_since_s.reset();
  alarm_since_s.reset();
  payload_kg.reset();
  payload_seen = had_laws = winner_valid = false;
  since_update_s = 0.0;
}

void MismatchMonitor::Impl::note_payload(const trial::Frame& frame) {
  if (payload_seen && frame.payload_kg != payload_kg) {
    payload_change_s = frame.stamp_s();
    over_since_s.reset();
    if (!mismatch.alarm)
      reference.doubt(kPolicy.alarm.payload_doubt);  // a scale's error, a hook's: other than before
  }
  payload_seen = true;
  payload_kg = frame.payload_kg;
}

void MismatchMonitor::Impl::add(const trial::Frame& frame, const estimate::Estimate& estimate) {
  if (last_frame_s && frame.stamp_s() < *last_frame_s - kPolicy.window.time_jump_s) reset();
  last_frame_s = frame.stamp_s();
  mismatch.stamp_s = frame.stamp_s();
  if (last_step_s && frame.stamp_s() - *last_step_s > kPolicy.window.stale_s) mismatch.valid = false;
  note_payload(frame);
  predictions = predict(arm, frame.inputs);
  if (predictions) memory.follow(frame.stamp_s(), frame.inputs, *predictions);
  if (estimate.status != estimate::Status::kOk || estimate.backbone.size() < kPolicy.window.fewest_points)
    return;

  const bool laws = predictions.has_value();
  if (laws != had_laws) {
    window.reset();
    pasts = 0;
    over_since_s.reset();
    had_laws = laws;
  }
  mismatch.laws = laws;
  shape.set(estimate);
  shape.discrepancy(laws ? &*predictions : nullptr, discrepancy);
  std::fill(seen.begin(), seen.end(), 0);
  for (const estimate::BodyResidual& residual : estimate.residuals) {
    seen[static_cast<std::size_t>(residual.body)] = 1;
    place.segment<3>(3 * residual.body) = residual.measured_base;
  }
  if (!discrepancy.allFinite()) return;
  if (window.add(frame.stamp_s(), discrepancy, place, seen)) step(frame.stamp_s());
}

void MismatchMonitor::Impl::step(double stamp_s) {
  const double dt_s =
      last_step_s ? std::clamp(stamp_s - *last_step_s, 0.0, kPolicy.window.longest_step_s) : 0.0;
  last_step_s = stamp_s;
  if (!first_s) first_s = stamp_s;
  const WindowMotion& motion = window.motion();
  inertia.setZero();
  if (predictions) shape.by_inertia(motion.acceleration, motion.usable, inertia);
  const bool payload_is_free = unknown != arm::Unknown::kStiffness;
  const std::vector<arm::SegmentPrediction>& before =
      pasts >= kPolicy.window.bins ? history[(next_past + kHistory - kPolicy.window.bins) % kHistory].laws
                                   : kNoLaws;
  reference.set_shape(shape, predictions ? &*predictions : nullptr, before, motion.velocity, payload_is_free);
  innovation = motion.discrepancy - reference.predicted() - inertia;
  for (std::size_t i = 0; i < motion.usable.size(); ++i) {
    if (!motion.usable[i]) innovation.segment<3>(static_cast<Eigen::Index>(3 * i)).setZero();
  }
  Past& past = history[next_past];
  past.to_s = motion.to_s;
  past.innovation = innovation;
  past.laws.clear();
  if (predictions) past.laws = *predictions;
  next_past = (next_past + 1) % kHistory;
  pasts = std::min(pasts + 1, kHistory);

  mismatch.valid = true;
  score();
  look_for_change();
  decide();
  learn(dt_s);
  mismatch.description = describe(mismatch, arm);
}

void MismatchMonitor::Impl::score() {
  const WindowMotion& motion = window.motion();
  double square = 0.0, square_m2 = 0.0, bend = -1.0;
  int bodies = 0;
  // Where: the body at which the discrepancy turns most away from the line through the two before it.
  Vector3d before = Vector3d::Zero(), slope = Vector3d::Zero();
  double before_s = 0.0;
  mismatch.s_m = mismatch.s_from_m = mismatch.s_to_m = 0.0;
  mismatch.body.reset();
  mismatch.axis = MismatchAxis::kNone;
  double previous_s = 0.0;
  for (std::size_t i = 0; i < motion.usable.size(); ++i) {
    if (!motion.usable[i]) continue;
    const int body = static_cast<int>(i);
    const Vector3d e = (motion.discrepancy - inertia).segment<3>(3 * body);
    const double sd = arm.bodies[i].position_sd_m;
    square += e.squaredNorm() / (3.0 * sd * sd);
    square_m2 += e.squaredNorm();
    ++bodies;
    const double s = shape.arclength_m(body);
    const double ds = std::max(1e-6, s - before_s);
    const Vector3d off = e - before - ds * slope;
    if (off.norm() > bend) {
      bend = off.norm();
      mismatch.s_from_m = previous_s;
      mismatch.s_to_m = s;
      mismatch.s_m = before_s;
      mismatch.body = body;
      mismatch.axis = axis_of(off, body);
    }
    slope = (e - before) / ds;
    before = e;
    previous_s = before_s;
    before_s = s;
  }
  mismatch.score_sd = bodies > 0 ? std::sqrt(square / bodies) : 0.0;
  mismatch.rms_m = bodies > 0 ? std::sqrt(square_m2 / bodies) : 0.0;
}

void MismatchMonitor::Impl::look_for_change() {
  const std::vector<char>& usable = window.motion().usable;
  const math::CholeskyFactor& factor = reference.innovation_covariance(usable, inertia);
  const double all = factor.whiten_vector(innovation).squaredNorm();
  const auto rows = 3.0 * static_cast<double>(std::count(usable.begin(), usable.end(), 1));
  // Of many bodies together less than chance for each may be over the threshold: no alarm is without a name.
  winner_valid = all > kPolicy.alarm.chance_chi2 * rows || all - rows > std::pow(params.threshold_sd, 2);
  if (!winner_valid) {
    mismatch.change_sd = std::sqrt(std::max(0.0, all - rows));
    return;
  }
  winner = test.best(shape, innovation, factor, usable);
  double change = winner.likelihood;
  if (winner.likelihood < kPolicy.alarm.unexplained * all) {
    winner.kind = ChangeKind::kUnclear;
    change = std::max(change, all - rows);
  }
  mismatch.change_sd = std::sqrt(std::max(0.0, change));
}

void MismatchMonitor::Impl::decide() {
  const double now_s = *last_step_s;
  const bool held_off = now_s - *first_s < params.learn_s ||
                        (payload_change_s && now_s - *payload_change_s < params.payload_hold_off_s);
  mismatch.threshold_sd = held_off && !mismatch.alarm ? 0.0 : params.threshold_sd;
  const bool over = mismatch.change_sd > params.threshold_sd;
  if (!mismatch.alarm) {
    // What swings back was a vibration.
    if (over_since_s && over_innovation.dot(innovation) <= 0.0) over_since_s.reset();
    if (!over || held_off) {
      over_since_s.reset();
    } else if (!over_since_s) {
      over_since_s = now_s;
      over_innovation = innovation;
    }
    if (!over_since_s || now_s - *over_since_s < params.confirm_s - 1e-6) return;
    mismatch.alarm = true;
    alarm_since_s = now_s;
    below_since_s.reset();
  }
  if (winner_valid && over && now_s - *alarm_since_s <= kPolicy.naming.seconds) name_change();
  mismatch.onset_s = named.onset_s;
  mismatch.kind = named.kind;
  mismatch.or_kind = named.or_kind;
  mismatch.size_m = named.size_m;
  mismatch.s_m = named.s_m;
  mismatch.s_from_m = named.s_from_m;
  mismatch.s_to_m = named.s_to_m;
  mismatch.body = named.body;
  mismatch.axis = named.axis;

  if (mismatch.change_sd > kPolicy.alarm.suspicion * params.threshold_sd) {
    below_since_s.reset();
  } else if (!below_since_s) {
    below_since_s = now_s;
  }
  const bool accepted = now_s - *alarm_since_s > params.accept_after_s;
  if (accepted) reference.doubt(1.0);
  if (accepted || (below_since_s && now_s - *below_since_s > kPolicy.alarm.clear_s)) end_alarm();
}

void MismatchMonitor::Impl::end_alarm() {
  mismatch.alarm = false;
  mismatch.onset_s.reset();
  mismatch.kind = ChangeKind::kNone;
  mismatch.or_kind.reset();
  mismatch.size_m = 0.0;
  alarm_since_s.reset();
  over_since_s.reset();
  suspicious_since_s.reset();
}

void MismatchMonitor::Impl::learn(double dt_s) {
  const double now_s = *last_step_s;
  since_update_s += dt_s;
  if (mismatch.alarm) return;
  const bool hand =
      payload_change_s && now_s - *payload_change_s < kPolicy.alarm.hand * params.payload_hold_off_s;
  const bool suspicious =
      mismatch.threshold_sd > 0.0 && mismatch.change_sd > kPolicy.alarm.suspicion * params.threshold_sd;
  if (!suspicious) {
    suspicious_since_s.reset();
  } else if (!suspicious_since_s) {
    suspicious_since_s = now_s;
  }
  if (hand || (suspicious_since_s && now_s - *suspicious_since_s < kPolicy.alarm.suspicious_s)) return;
  const std::vector<char>& usable = window.motion().usable;
  reference.learn_noise(innovation, usable, dt_s);
  if (since_update_s < kPolicy.window.seconds()) return;
  if (suspicious) reference.doubt(kPolicy.alarm.doubt);
  reference.innovation_covariance(usable, inertia);  // of what is doubted by now
  reference.update(innovation);
  reference.age(since_update_s);
  since_update_s = 0.0;
}

MismatchMonitor::MismatchMonitor(const arm::Arm& arm, const MismatchMonitorParams& params)
    : impl_(std::make_unique<Impl>(arm, params)) {}
MismatchMonitor::~MismatchMonitor() = default;
MismatchMonitor::MismatchMonitor(MismatchMonitor&&) noexcept = default;
MismatchMonitor& MismatchMonitor::operator=(MismatchMonitor&&) noexcept = default;

void MismatchMonitor::set_unknown(arm::Unknown unknown) {
  impl_->unknown = unknown;
}

const Mismatch& MismatchMonitor::add(const trial::Frame& frame, const estimate::Estimate& estimate) {
  impl_->add(frame, estimate);
  return impl_->mismatch;
}

void MismatchMonitor::reset() {
  impl_->reset();
}

}  // namespace softarm::monitor
