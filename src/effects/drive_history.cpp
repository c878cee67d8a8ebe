#include "drive_history.h"

namespace softarm::effects {
namespace {

constexpr std::size_t kMost = 600;  // points; the oldest go first
constexpr double kHeld_s = 0.1;     // without a change: inputs were held, not on their way
constexpr double kLine_s = 0.5;     // the longest line that takes the place of points
// Nearer to a line than this, a point is on it.
constexpr double kSame_pa = 30.0, kSame_n = 0.005, kSame_rad = 0.001;

}  // namespace

DriveHistory::DriveHistory(const Arm& arm)
    : tolerance_(static_cast<Eigen::Index>(arm.inputs.scalars.size())) {
  for (Eigen::Index k = 0; k < tolerance_.size(); ++k) {
    const InputKind kind = arm.inputs.scalars[static_cast<std::size_t>(k)].kind;
    tolerance_[k] = kind == InputKind::kTension ? kSame_n : kind == InputKind::kAngle ? kSame_rad : kSame_pa;
  }
}

void DriveHistory::push(const Point& point) {
  points_.push_back(point);
  const std::size_t n = points_.size();
  if (n >= 3 && points_[n - 1].t_s - points_[n - 3].t_s < kLine_s) {
    const Point &a = points_[n - 3], &b = points_[n - 2], &c = points_[n - 1];
    const double w = (b.t_s - a.t_s) / (c.t_s - a.t_s);
    const Eigen::ArrayXd off = (b.inputs - (1.0 - w) * a.inputs - w * c.inputs).array().abs();
    if ((off <= tolerance_.array()).all()) points_.erase(points_.end() - 2);
  }
  if (points_.size() > kMost) points_.pop_front();
}

void DriveHistory::add(double t_s, const Eigen::VectorXd& inputs) {
  if (points_.empty()) {
    push({t_s, inputs});
  } else if (inputs != points_.back().inputs) {
    if (last_.t_s - points_.back().t_s > kHeld_s) push({last_.t_s, points_.back().inputs});
    push({t_s, inputs});
  }
  last_ = {t_s, inputs};
}

Series DriveHistory::series(double payload_kg) const {
  const bool also_now = last_.t_s > points_.back().t_s;
  const auto count = static_cast<Eigen::Index>(points_.size() + (also_now ? 1 : 0));
  Series series;
  series.t_s.resize(count);
  series.inputs.resize(tolerance_.size(), count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Point& point =
        i < static_cast<Eigen::Index>(points_.size()) ? points_[static_cast<std::size_t>(i)] : last_;
    series.t_s[i] = point.t_s;
    series.inputs.col(i) = point.inputs;
  }
  series.moment_inputs = series.inputs;
  series.payload_kg = Eigen::VectorXd::Constant(count, payload_kg);
  return series;
}

}  // namespace softarm::effects
