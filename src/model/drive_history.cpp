#include "drive_history.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace softarm::model {
namespace {

constexpr std::size_t kMost = 600;  // points; the oldest go first
constexpr double kLine_s = 0.5;     // the longest line that takes the place of points, unless it is level
// Nearer to a line than this, a point is on it.
constexpr double kSame_pa = 30.0, kSame_n = 0.005, kSame_rad = 0.001;
constexpr std::size_t kMostStale = 64;  // samples that no open frame needs

}  // namespace

DriveHistory::DriveHistory(const arm::Arm& arm)
    : tolerance_(static_cast<Eigen::Index>(arm.inputs.scalars.size())) {
  for (Eigen::Index k = 0; k < tolerance_.size(); ++k) {
    const arm::ScalarInput& input = arm.inputs.scalars[static_cast<std::size_t>(k)];
    tolerance_[k] = input.kind == arm::InputKind::kTension ? kSame_n
                    : input.kind == arm::InputKind::kAngle ? kSame_rad
                                                           : kSame_pa;
    sources_.push_back({input.between, false, {}, {}});
  }
}

void DriveHistory::clear() {
  points_.clear();
  open_.clear();
  least_slope_.resize(0);
  for (Source& source : sources_) source = {source.stated, false, {}, {}};
}

void DriveHistory::add(Source& source, std::int64_t stamp_ns, double value) {
  source.rhythm.add(1e-9 * static_cast<double>(stamp_ns));
  source.recent.add(stamp_ns, value);
  source.recent.decide(source.stated, source.rhythm.pattern());
}

void DriveHistory::add(double stamp_s, const Eigen::VectorXd& inputs,
                       const std::vector<trial::InputSample>& samples) {
  for (const trial::InputSample& sample : samples) {
    Source& source = sources_.at(static_cast<std::size_t>(sample.input));
    source.has_samples = true;
    add(source, sample.stamp_ns, sample.value);
  }
  for (std::size_t k = 0; k < sources_.size(); ++k) {
    if (!sources_[k].has_samples)
      add(sources_[k], std::llround(1e9 * stamp_s), inputs[static_cast<Eigen::Index>(k)]);
  }
  for (Point& frame : open_) {
    for (std::size_t k = 0; k < sources_.size(); ++k) {
      double& value = frame.inputs[static_cast<Eigen::Index>(k)];
      value = sources_[k].recent.at(frame.stamp_s).value_or(value);
    }
  }
  open_.push_back({stamp_s, inputs});
  while (!open_.empty() && !is_open(open_.front())) {
    close(std::move(open_.front()));
    open_.pop_front();
  }
  for (Source& source : sources_)
    source.recent.forget_before(open_.empty() ? stamp_s : open_.front().stamp_s, kMostStale);
}

bool DriveHistory::is_open(const Point& frame) const {
  const auto at_ns = static_cast<std::int64_t>(std::llround(1e9 * frame.stamp_s));
  return std::any_of(sources_.begin(), sources_.end(), [&](const Source& source) {
    const trial::InputSeries& recent = source.recent;
    return recent.between == arm::Between::kSampled && !recent.stamp_ns.empty() &&
           recent.stamp_ns.back() < at_ns && at_ns - recent.stamp_ns.back() < recent.longest_line_ns;
  });
}

void DriveHistory::close(Point point) {
  const auto slopes_to = [&](const Point& from, double above) -> Eigen::ArrayXd {
    return ((point.inputs - from.inputs).array() + above * tolerance_.array()) /
           (point.stamp_s - from.stamp_s);
  };
  const std::size_t n = points_.size();
  if (n >= 2) {
    const Point &a = points_[n - 2], &b = points_[n - 1];
    const Eigen::ArrayXd slope = slopes_to(a, 0.0);
    const bool straight = (slope >= least_slope_).all() && (slope <= most_slope_).all();
    const bool level = a.inputs == b.inputs && b.inputs == point.inputs;
    if (straight && (level || point.stamp_s - a.stamp_s < kLine_s)) {
      points_.pop_back();
    } else {
      least_slope_.resize(0);
    }
  }
  if (!points_.empty()) {
    const Eigen::ArrayXd least = slopes_to(points_.back(), -1.0), most = slopes_to(points_.back(), 1.0);
    const bool begins = least_slope_.size() == 0;
    least_slope_ = begins ? least : Eigen::ArrayXd(least_slope_.max(least));
    most_slope_ = begins ? most : Eigen::ArrayXd(most_slope_.min(most));
  }
  points_.push_back(std::move(point));
  if (points_.size() > kMost) points_.pop_front();
}

Series DriveHistory::series(double begin_s, double payload_kg) const {
  const auto closed = static_cast<Eigen::Index>(points_.size());
  const Eigen::Index count = closed + static_cast<Eigen::Index>(open_.size());
  Series series;
  series.t_s.resize(count);
  series.inputs.resize(tolerance_.size(), count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Point& point =
        i < closed ? points_[static_cast<std::size_t>(i)] : open_[static_cast<std::size_t>(i - closed)];
    series.t_s[i] = point.stamp_s - begin_s;
    series.inputs.col(i) = point.inputs;
  }
  series.moment_inputs = series.inputs;
  series.payload_kg = Eigen::VectorXd::Constant(count, payload_kg);
  return series;
}

}  // namespace softarm::model
