// Constants to what the walls keep back, along the records of the trials.
#include <algorithm>

#include "arm/wall_memory.h"
#include "law_model.h"

namespace softarm::identify {
namespace {

using Eigen::MatrixXd;

/// By a constant: curvature M0 / EI + that of cables, and length.
Eigen::Vector3d drive_by(const arm::SegmentPrediction& at, const arm::SegmentDerivative& by) {
  const double stiffness = at.bending_stiffness_nm2;
  Eigen::Vector3d d;
  d.head<2>() =
      by.prediction.curvature_per_m +
      (by.prediction.moment_nm - at.moment_nm / stiffness * by.prediction.bending_stiffness_nm2) / stiffness;
  d.z() = by.prediction.length_m;
  return d;
}

}  // namespace

bool LawModel::walk_segment(std::size_t segment, const trial::DriveRecord& record,
                            const Eigen::VectorXd& start, Eigen::Index first_start, Walk& out) const {
  const arm::Segment& own = arm_.segments[segment];
  if (own.wall.empty()) return true;
  arm::WallMemory memory(own);
  const auto count = static_cast<Eigen::Index>(constants_.size());
  const auto row = 3 * static_cast<Eigen::Index>(segment);
  std::vector<arm::WallChange> changes(constants_.size());
  std::vector<Eigen::Index> of_laws;  // the columns of constants that change what drives this wall
  for (std::size_t j = 0; j < constants_.size(); ++j) {
    const std::vector<int> of = segments_of(constants_[j]);
    if (std::find(of.begin(), of.end(), static_cast<int>(segment)) == of.end()) continue;
    const arm::ConstantSpec& spec = arm::spec_of(constants_[j].kind);
    if (spec.wall != nullptr) {
      changes[j] = spec.wall(own, constants_[j].index);
    } else {
      of_laws.push_back(static_cast<Eigen::Index>(j));
    }
  }
  for (std::size_t i = 0; i < record.stamp_s.size(); ++i) {
    const arm::InputReader inputs(arm_, record.inputs[i]);
    const std::optional<arm::SegmentResponse> response = arm::respond(own, inputs);
    if (!response) return false;
    arm::WallDrive drive =
        arm::wall_drive(own, response->prediction, arm::mean_pressure_pa(arm_, own, record.inputs[i]));
    drive.by.setZero(3, count);
    for (const Eigen::Index j : of_laws) {
      const auto by = by_constant(constants_[static_cast<std::size_t>(j)], segment, *response, inputs);
      if (!by) return false;
      drive.by.col(j) = drive_by(response->prediction, *by);
    }
    if (i == 0) {
      memory.begin(drive, start.segment(first_start, memory.starts()));
    } else {
      memory.follow(record.stamp_s[i] - record.stamp_s[i - 1], drive, changes);
    }
    out.lag[i].segment<3>(row) = memory.lag();
    out.by[i].middleRows<3>(row) = memory.lag_by(changes);
    out.by_start[i].block(row, first_start, 3, memory.starts()) = memory.lag_by_start();
  }
  return true;
}

const LawModel::Walk& LawModel::walk(const trial::StaticFrame& frame) {
  const auto known = walks_.find(frame.trial);
  if (known != walks_.end()) return known->second;
  Walk& made = walks_[frame.trial];
  const trial::DriveRecord& record = *frame.drive;
  const auto rows = 3 * static_cast<Eigen::Index>(arm_.segments.size());
  made.lag.assign(record.stamp_s.size(), Eigen::VectorXd::Zero(rows));
  made.by.assign(record.stamp_s.size(), MatrixXd::Zero(rows, static_cast<Eigen::Index>(constants_.size())));
  made.by_start.assign(record.stamp_s.size(), MatrixXd::Zero(rows, start_sd_.size()));
  const auto start = starts_.find(frame.trial);
  const Eigen::VectorXd at_start =
      start == starts_.end() ? Eigen::VectorXd::Zero(start_sd_.size()) : start->second;
  Eigen::Index first = 0;
  for (std::size_t i = 0; i < arm_.segments.size(); ++i) {
    // Constants at which the laws have no value somewhere: no frame of the trial has one.
    if (!walk_segment(i, record, at_start, first, made)) {
      made.lag.clear();
      break;
    }
    first += arm::WallMemory(arm_.segments[i]).starts();
  }
  return made;
}

bool LawModel::keep_back(const trial::StaticFrame& frame) {
  const std::vector<double>& stamps = frame.drive->stamp_s;
  const auto found = std::lower_bound(stamps.begin(), stamps.end(), frame.stamp_s);
  if (found == stamps.end()) return false;
  const Walk& walked = walk(frame);
  if (walked.lag.empty()) return false;
  walked_ = &walked;
  instant_ = static_cast<std::size_t>(found - stamps.begin());
  for (std::size_t i = 0; i < laws_.size(); ++i)
    arm::take_off(walked.lag[instant_].segment<3>(3 * static_cast<Eigen::Index>(i)), laws_[i]);
  return true;
}

MatrixXd LawModel::rod_by_start() const {
  if (walked_ == nullptr) return MatrixXd::Zero(static_cast<Eigen::Index>(parameters_.size()), 0);
  const MatrixXd& lag = walked_->by_start[instant_];
  MatrixXd rod = MatrixXd::Zero(static_cast<Eigen::Index>(parameters_.size()), lag.cols());
  for (std::size_t r = 0; r < parameters_.size(); ++r) {
    const rod::Parameter& which = parameters_[r];
    for (Eigen::Index k = 0; k < lag.cols(); ++k) {
      arm::SegmentDerivative by;
      by.prediction.modulus_ratio = 0.0;
      arm::take_off(lag.col(k).segment<3>(3 * which.index), by.prediction);
      rod(static_cast<Eigen::Index>(r), k) = parameter_derivative(which, by);
    }
  }
  return rod;
}

}  // namespace softarm::identify
