#include <algorithm>
#include <cmath>

#include "body_gate.h"

namespace softarm::trial {

const char* BodyGate::name(Verdict verdict) {
  switch (verdict) {
    case Verdict::kAccept:
      return "accepted";
    case Verdict::kNan:
      return "nan";
    case Verdict::kAbsurd:
      return "absurd";
    case Verdict::kAllZero:
      return "all_zero";
    case Verdict::kZeroQuaternion:
      return "zero_quaternion";
    case Verdict::kBadQuaternion:
      return "bad_quaternion";
    case Verdict::kFrozen:
      return "frozen";
    case Verdict::kJump:
      return "jump";
  }
  return "unknown";
}

BodyGate::Verdict BodyGate::check(double stamp_s, const Eigen::Vector3d& p,
                                  std::optional<Eigen::Quaterniond>& q,
                                  std::optional<double> others_changed_s) {
  const std::optional<Eigen::Quaterniond> q_reported = q;
  const Verdict numbers = check_numbers(p, q);
  if (numbers != Verdict::kAccept) return numbers;
  if (is_frozen(stamp_s, p, q_reported, others_changed_s)) return Verdict::kFrozen;
  const Pose now{stamp_s, p, q};
  if (is_jump(now)) return Verdict::kJump;
  good_ = now;
  elsewhere_.reset();
  return Verdict::kAccept;
}

BodyGate::Verdict BodyGate::check_numbers(const Eigen::Vector3d& p,
                                          std::optional<Eigen::Quaterniond>& q) const {
  if (!p.allFinite()) return Verdict::kNan;
  if (!(p.cwiseAbs().maxCoeff() < limits_.absurd_position_m)) return Verdict::kAbsurd;
  if (p.x() == 0.0 && p.y() == 0.0 && p.z() == 0.0) return Verdict::kAllZero;
  Verdict orientation = Verdict::kAccept;
  if (!q) {
    orientation = Verdict::kZeroQuaternion;
  } else if (!q->coeffs().allFinite()) {
    orientation = Verdict::kNan;
  } else {
    const double norm = q->norm();
    if (norm < 1e-6) {
      orientation = Verdict::kZeroQuaternion;
    } else if (!(std::abs(norm - 1.0) < 0.02)) {
      orientation = Verdict::kBadQuaternion;
    } else {
      q->normalize();
      // q and -q are the same rotation; one sign keeps whatever averages or differences them safe.
      if (q->w() < 0.0) q->coeffs() *= -1.0;
    }
  }
  if (orientation == Verdict::kAccept) return orientation;
  q.reset();  // drivers of single points fill poses with zero quaternions: the position is still good
  return body_.needs_orientation ? orientation : Verdict::kAccept;
}

bool BodyGate::repeats(const Eigen::Vector3d& p, const std::optional<Eigen::Quaterniond>& q) const {
  if (!reported_ || reported_->p != p || reported_->q.has_value() != q.has_value()) return false;
  return !q || reported_->q->coeffs() == q->coeffs();
}

std::optional<double> BodyGate::surely_changed_s() const {
  if (!changed_before_s_) return {};
  return std::min(*changed_s_, *changed_before_s_);
}

bool BodyGate::is_frozen(double stamp_s, const Eigen::Vector3d& p, const std::optional<Eigen::Quaterniond>& q,
                         std::optional<double> others_changed_s) {
  if (!repeats(p, q)) {
    if (reported_) ++changes_;
    changed_before_s_ = changed_s_;
    changed_s_ = stamp_s;
    identical_ = 1;
    reported_ = Pose{stamp_s, p, q};
    return false;
  }
  ++identical_;
  if (body_.may_rest && changes_ < limits_.frozen_after_samples) return false;
  const bool long_enough =
      stamp_s - *changed_s_ > limits_.frozen_after_s && identical_ > limits_.frozen_after_samples;
  const bool others_moved =
      others_changed_s && *others_changed_s > *changed_s_ + 0.5 * limits_.frozen_after_s;
  return long_enough && others_moved;
}

bool BodyGate::reachable(const Pose& from, const Pose& to) const {
  const double dt = std::abs(to.stamp_s - from.stamp_s);
  const double reach_m = std::max(limits_.jump_allowance_m, limits_.noise_multiple * body_.position_sd_m) +
                         limits_.max_speed_m_s * dt;
  if (!((to.p - from.p).norm() <= reach_m)) return false;
  if (!body_.needs_orientation || !from.q || !to.q) return true;
  const double reach_rad =
      std::max(limits_.jump_allowance_rad, limits_.noise_multiple * body_.orientation_sd_rad) +
      limits_.max_rate_rad_s * dt;
  return from.q->angularDistance(*to.q) <= reach_rad;
}

bool BodyGate::is_jump(const Pose& now) {
  if (!good_ || reachable(*good_, now)) return false;
  if (!elsewhere_ || !reachable(*elsewhere_, now)) {
    elsewhere_since_s_ = now.stamp_s;
    elsewhere_count_ = 0;
  }
  elsewhere_ = now;
  ++elsewhere_count_;
  return elsewhere_count_ < limits_.followed_after_samples ||
         now.stamp_s - elsewhere_since_s_ < limits_.followed_after_s;
}

}  // namespace softarm::trial
