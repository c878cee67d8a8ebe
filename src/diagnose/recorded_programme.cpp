#include "recorded_programme.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "math/statistics.h"
#include "policy.h"
#include "softarm/arm/laws.h"

namespace softarm::diagnose {
namespace {

constexpr double kFrames_hz = 50.0;  // of what drives it

}  // namespace

using Eigen::Vector3d;
using Eigen::VectorXd;
using model::Block;
using model::TrialData;

RecordedProgramme::RecordedProgramme(const arm::Arm& arm, const std::vector<TrialData>& trials,
                                     double block_s)
    : arm_(arm), trials_(trials), block_s_(block_s) {
  const auto inputs = static_cast<Eigen::Index>(arm.inputs.scalars.size());
  low_ = VectorXd::Constant(inputs, 1e300);
  high_ = VectorXd::Constant(inputs, -1e300);
  for (const TrialData& trial : trials) {
    low_ = low_.cwiseMin(trial.series.inputs.rowwise().minCoeff());
    high_ = high_.cwiseMax(trial.series.inputs.rowwise().maxCoeff());
    most_payload_kg_ = std::max(most_payload_kg_, trial.series.payload_kg.maxCoeff());
  }
  choose_base();
  find_precision();
}

/// The trial that drives the arm most, and the payload that hangs on it at its end.
void RecordedProgramme::choose_base() {
  double most = -1.0;
  for (const TrialData& trial : trials_) {
    if (trial.series.t_s.size() < kPolicy.experiment.fewest_frames || trial.blocks.empty()) continue;
    double sum = 0.0;
    for (Eigen::Index k = 0; k < low_.size(); ++k) {
      const auto row = trial.series.inputs.row(k).array();
      const double span = high_[k] - low_[k];
      if (span > 0.0) sum += std::sqrt((row - row.mean()).square().mean()) / span;
    }
    if (sum > most) {
      most = sum;
      base_ = &trial;
    }
  }
  if (base_ == nullptr) return;
  const model::Series& series = base_->series;
  rest_ = series.inputs.col(0);
  payload_kg_ = series.payload_kg[series.payload_kg.size() - 1];
  gravity_ = base_->blocks.front().gravity_base.normalized();
  double strongest = -1.0;
  for (Eigen::Index i = 0; i < series.t_s.size(); ++i) {
    const VectorXd now = series.inputs.col(i);
    const auto made = predict(arm_, arm::InputValues(now.data(), now.data() + now.size()));
    if (!made) continue;
    double bend = 0.0;
    for (const arm::SegmentPrediction& segment : *made)
      bend += segment.actuation_nm().norm() / segment.bending_stiffness_nm2;
    if (bend > strongest) {
      strongest = bend;
      peak_ = now;
      peak_s_ = series.t_s[i];
    }
  }
  if (peak_.size() == 0) base_ = nullptr;
}

/// Bodies are seen as well as they mostly were.
void RecordedProgramme::find_precision() {
  std::vector<std::vector<double>> sd(arm_.bodies.size()), sd_rad(arm_.bodies.size());
  for (const TrialData& trial : trials_) {
    for (const Block& block : trial.blocks) {
      for (const model::Seen& seen : block.bodies)
        sd[static_cast<std::size_t>(seen.body)].push_back(seen.white_sd_m);
      for (const model::SeenTangent& seen : block.tangents)
        sd_rad[static_cast<std::size_t>(seen.body)].push_back(seen.white_sd_rad);
    }
  }
  // 0 of one that was never seen: nor will it be.
  for (std::vector<double>& of_body : sd) white_sd_m_.push_back(math::median(std::move(of_body)));
  for (std::vector<double>& of_body : sd_rad) white_sd_rad_.push_back(math::median(std::move(of_body)));
}

VectorXd RecordedProgramme::base_inputs(double t_s) const {
  const VectorXd& t = base_->series.t_s;
  const auto after = std::upper_bound(t.data(), t.data() + t.size(), t_s) - t.data();
  if (after == 0) return base_->series.inputs.col(0);
  if (after == t.size()) return base_->series.inputs.col(t.size() - 1);
  const double w = (t_s - t[after - 1]) / (t[after] - t[after - 1]);
  return (1.0 - w) * base_->series.inputs.col(after - 1) + w * base_->series.inputs.col(after);
}

TrialData RecordedProgramme::trial(double seconds, const Vector3d& gravity,
                                   const std::function<Driven(double)>& drive) const {
  TrialData data;
  data.name = "next";
  data.begin_s = base_->begin_s;
  for (const TrialData& trial : trials_) {
    const model::Series& recorded = trial.series;
    data.series.session_s =
        std::max(data.series.session_s, recorded.session_s + recorded.t_s[recorded.t_s.size() - 1]);
  }
  const auto per_block = static_cast<std::size_t>(std::max(3.0, std::round(block_s_ * kFrames_hz)));
  const double dt_s = block_s_ / static_cast<double>(per_block);
  const auto blocks = static_cast<std::size_t>(seconds / block_s_);
  const auto count = static_cast<Eigen::Index>(blocks * per_block);
  data.series.t_s = VectorXd::LinSpaced(count, 0.0, dt_s * static_cast<double>(count - 1));
  data.series.inputs.resize(low_.size(), count);
  data.series.payload_kg.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Driven now = drive(data.series.t_s[i]);
    data.series.inputs.col(i) = now.inputs.cwiseMax(low_).cwiseMin(high_);
    data.series.payload_kg[i] = now.payload_kg;
  }
  data.series.moment_inputs = data.series.inputs;
  Block block;
  const Vector3d down = arm_.gravity_m_s2.normalized();
  block.q_base_mocap = Eigen::Quaterniond::FromTwoVectors(down, gravity);
  block.gravity_base = arm_.gravity_m_s2.norm() * gravity;
  for (std::size_t b = 0; b < white_sd_m_.size(); ++b) {
    if (!(white_sd_m_[b] > 0.0)) continue;
    model::Seen seen;
    seen.body = static_cast<int>(b);
    seen.frames = static_cast<int>(per_block);
    seen.white_sd_m = white_sd_m_[b];
    block.bodies.push_back(seen);
    if (white_sd_rad_[b] > 0.0)
      block.tangents.push_back({static_cast<int>(b), Vector3d::UnitZ(), white_sd_rad_[b]});
  }
  for (std::size_t k = 0; k < blocks; ++k) {
    block.first = k * per_block;
    block.last = block.first + per_block;
    block.begins = k == 0;
    data.blocks.push_back(block);
  }
  return data;
}

TrialData RecordedProgramme::repeated(const Vector3d& gravity, double speed, double payload_kg) const {
  const VectorXd& t = base_->series.t_s;
  // To its end and back again, as often as there is time for.
  const double way_s = t[t.size() - 1] - t[0];
  return trial(kPolicy.experiment.seconds, gravity, [&](double t_s) {
    const double on_s = std::fmod(speed * t_s, 2.0 * way_s);
    return Driven{base_inputs(t[0] + std::min(on_s, 2.0 * way_s - on_s)), payload_kg};
  });
}

}  // namespace softarm::diagnose
