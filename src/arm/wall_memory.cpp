#include "wall_memory.h"

#include <algorithm>
#include <cmath>

#include "input_reader.h"
#include "math/following.h"

namespace softarm::arm {
namespace {

constexpr double kStartBend_rad = 0.2, kStartLength_rel = 0.02;
// Over a longer time without a frame the inputs may have gone another way than straight.
constexpr double kGap_s = 1.0;

}  // namespace

WallDrive wall_drive(const Segment&, const SegmentPrediction& by_laws, double pressure_pa) {
  WallDrive drive;
  drive.value.head<2>() = by_laws.actuation_nm() / by_laws.bending_stiffness_nm2;
  drive.value.z() = by_laws.length_m;
  drive.by.resize(3, 0);
  drive.pressure_pa = pressure_pa;
  return drive;
}

double mean_pressure_pa(const Arm& arm, const Segment& segment, const InputValues& inputs) {
  const InputReader read(arm, inputs);
  double sum = 0.0, count = 0.0;
  const auto add = [&](const std::string& name) {
    const std::optional<double> value = read(name);
    if (!value) return;
    sum += std::max(0.0, *value);
    count += 1.0;
  };
  for (const Chamber& chamber : segment.chambers) add(chamber.input);
  if (segment.central_chamber) add(segment.central_chamber->input);
  return count > 0.0 ? sum / count : 0.0;
}

double wall_start_sd(const Segment& segment, bool axial) {
  const Wall& wall = segment.wall;
  return axial ? wall.initial_length_sd_m.value_or(kStartLength_rel * segment.length_m)
               : wall.initial_curvature_sd_per_m.value_or(kStartBend_rad / segment.length_m);
}

WallMemory::WallMemory(const Segment& segment)
    : slows_per_pa_(segment.wall.slows_per_pa.value_or(0.0)),
      shares_grow_per_pa_(segment.wall.shares_grow_per_pa.value_or(0.0)) {
  const auto add = [&](const WallElement& e, bool axial) {
    Element made{e.time_s, e.share, axial ? 2 : 0, axial ? 1 : 2, starts_, {}, {}, 1.0, {}, 0.0};
    made.at.setZero();
    made.variance.setZero();
    made.start_sd = wall_start_sd(segment, axial);
    starts_ += made.rows;
    (axial ? axial_share_ : bending_share_) += e.share;
    elements_.push_back(made);
  };
  for (const WallElement& e : segment.wall.bending) add(e, false);
  for (const WallElement& e : segment.wall.axial) add(e, true);
}

Eigen::VectorXd WallMemory::start_sd() const {
  Eigen::VectorXd sd(starts_);
  for (const Element& e : elements_) sd.segment(e.start, e.rows).setConstant(e.start_sd);
  return sd;
}

void WallMemory::begin(const WallDrive& drive, const Eigen::VectorXd& start) {
  last_ = drive;
  for (Element& e : elements_) {
    e.at.setZero();
    e.at.segment(e.row, e.rows) = drive.value.segment(e.row, e.rows);
    if (start.size() > 0) e.at.segment(e.row, e.rows) += start.segment(e.start, e.rows);
    e.by = Eigen::Matrix3Xd::Zero(3, drive.by.cols());
    e.by.middleRows(e.row, e.rows) = drive.by.middleRows(e.row, e.rows);
    e.left = 1.0;
    e.variance.setZero();
    e.variance.segment(e.row, e.rows).setConstant(e.start_sd * e.start_sd);
  }
}

void WallMemory::follow(double dt_s, const WallDrive& now, const std::vector<WallChange>& changes) {
  for (int i = 0; i < static_cast<int>(elements_.size()); ++i) follow(dt_s, now, changes, i);
  last_ = now;
}

void WallMemory::follow(double dt_s, const WallDrive& now, const std::vector<WallChange>& changes,
                        int which) {
  Element& e = elements_[static_cast<std::size_t>(which)];
  const double pressure_pa = 0.5 * (last_.pressure_pa + now.pressure_pa);
  const double slower = 1.0 + slows_per_pa_ * pressure_pa;
  const double tau_s = e.time_s * slower;
  const math::Following f = math::following(dt_s, tau_s);
  const auto rows = [&](auto& of) { return of.middleRows(e.row, e.rows); };
  // w by tau: f.kept and f.weight_now change with it, and the three weights sum to 1.
  const double kept_by_tau = dt_s > 0.0 ? f.kept * dt_s / (tau_s * tau_s) : 0.0;
  const double now_by_tau = dt_s > 0.0 ? (f.kept - (1.0 - f.weight_now)) / tau_s : 0.0;
  const Eigen::Vector3d by_tau = kept_by_tau * (e.at - last_.value) + now_by_tau * (now.value - last_.value);
  rows(e.at) =
      (f.kept * e.at + f.weight_last * last_.value + f.weight_now * now.value).segment(e.row, e.rows).eval();
  if (now.by.cols() > 0)
    rows(e.by) =
        (f.kept * e.by + f.weight_last * last_.by + f.weight_now * now.by).middleRows(e.row, e.rows).eval();
  for (std::size_t j = 0; j < changes.size(); ++j) {
    const WallChange& by = changes[j];
    const double tau =
        (by.element == which ? by.time_s * slower : 0.0) + by.slows_per_pa * e.time_s * pressure_pa;
    if (tau != 0.0)
      e.by.col(static_cast<Eigen::Index>(j)).segment(e.row, e.rows) += tau * by_tau.segment(e.row, e.rows);
  }
  e.left *= f.kept;
  e.variance *= f.kept * f.kept;
  if (dt_s > kGap_s) {
    const Eigen::Vector3d step = (1.0 - f.kept) * (now.value - last_.value);
    rows(e.variance) += step.cwiseAbs2().segment(e.row, e.rows) / 3.0;
  }
}

WallMemory::Grown WallMemory::grown(const Element& e) const {
  const double sum = e.rows == 1 ? axial_share_ : bending_share_, p = last_.pressure_pa;
  const double gp = shares_grow_per_pa_ * p, by = 1.0 + sum * gp;
  return {(1.0 + gp) / by, -(1.0 + gp) * gp / (by * by), p * (1.0 - sum) / (by * by)};
}

Eigen::Vector3d WallMemory::lag() const {
  Eigen::Vector3d lag = Eigen::Vector3d::Zero();
  for (const Element& e : elements_)
    lag.segment(e.row, e.rows) += grown(e).factor * e.share * (last_.value - e.at).segment(e.row, e.rows);
  return lag;
}

Eigen::Matrix3Xd WallMemory::lag_by(const std::vector<WallChange>& changes) const {
  Eigen::Matrix3Xd lag = Eigen::Matrix3Xd::Zero(3, last_.by.cols());
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    const Element& e = elements_[i];
    const Grown grown = this->grown(e);
    lag.middleRows(e.row, e.rows) += grown.factor * e.share * (last_.by - e.by).middleRows(e.row, e.rows);
    for (std::size_t j = 0; j < changes.size(); ++j) {
      const WallChange& by = changes[j];
      double share = e.share * grown.by_growth * by.shares_grow_per_pa;
      if (by.element == static_cast<int>(i)) share += grown.factor * by.share;
      if (by.share != 0.0 && elements_[static_cast<std::size_t>(by.element)].rows == e.rows)
        share += e.share * grown.by_sum * by.share;
      if (share != 0.0)
        lag.col(static_cast<Eigen::Index>(j)).segment(e.row, e.rows) +=
            share * (last_.value - e.at).segment(e.row, e.rows);
    }
  }
  return lag;
}

Eigen::Matrix3Xd WallMemory::lag_by_start() const {
  Eigen::Matrix3Xd lag = Eigen::Matrix3Xd::Zero(3, starts_);
  for (const Element& e : elements_) {
    for (int k = 0; k < e.rows; ++k) lag(e.row + k, e.start + k) = -grown(e).factor * e.share * e.left;
  }
  return lag;
}

Eigen::Vector3d WallMemory::lag_variance() const {
  Eigen::Vector3d variance = Eigen::Vector3d::Zero();
  for (const Element& e : elements_) {
    const double share = grown(e).factor * e.share;
    variance += share * share * e.variance;
  }
  return variance;
}

LawMemory::LawMemory(const Arm& arm) : arm_(arm) {
  if (!has_wall(arm)) return;
  for (const Segment& segment : arm.segments) walls_.emplace_back(segment);
  kept_back_.assign(walls_.size(), Eigen::Vector3d::Zero());
}

void LawMemory::follow(double stamp_s, const InputValues& inputs,
                       std::vector<SegmentPrediction>& predictions) {
  const bool begins = !last_s_ || stamp_s < *last_s_;
  for (std::size_t i = 0; i < walls_.size(); ++i) {
    const Segment& segment = arm_.segments[i];
    const WallDrive drive = wall_drive(segment, predictions[i], mean_pressure_pa(arm_, segment, inputs));
    if (begins) {
      walls_[i].begin(drive);
    } else {
      walls_[i].follow(stamp_s - *last_s_, drive);
    }
    kept_back_[i] = walls_[i].lag();
    take_off(kept_back_[i], predictions[i]);
  }
  last_s_ = stamp_s;
}

Eigen::Vector3d LawMemory::variance(std::size_t segment) const {
  if (walls_.empty() || !last_s_) return Eigen::Vector3d::Zero();
  return walls_[segment].lag_variance();
}

void take_off(const Eigen::Vector3d& lag, SegmentPrediction& prediction) {
  prediction.curvature_per_m -= lag.head<2>();
  prediction.length_m -= lag.z();
}

bool has_wall(const Arm& arm) {
  return std::any_of(arm.segments.begin(), arm.segments.end(),
                     [](const Segment& segment) { return !segment.wall.empty(); });
}

}  // namespace softarm::arm
