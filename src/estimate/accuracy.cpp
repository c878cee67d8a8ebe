#include "accuracy.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "math/statistics.h"
#include "model/arm_rod.h"
#include "softarm/estimate/estimator.h"
#include "softarm/rod/solver.h"

namespace softarm::estimate {
namespace {

using Eigen::Vector3d;

struct Truth {
  double moment, phi, stiffness, length, payload;
  bool hanging;
};

double uniform(std::mt19937_64& random, const arm::Range& range) {
  // 53 bits: the same on every standard library.
  return range.low + (range.high - range.low) * static_cast<double>(random() >> 11) * 0x1.0p-53;
}

/// A standard normal number (Box-Muller, one of the pair).
double normal(std::mt19937_64& random) {
  const double u = 1.0 - uniform(random, {0.0, 1.0});
  return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * M_PI * uniform(random, {0.0, 1.0}));
}

/// Marker positions and the Cramer-Rao variances of M0, phi, EI, L for one truth.
class Generator {
 public:
  Generator(const arm::Arm& arm, double sd)
      : sd_(sd), rod_(rod::make_rod(arm)), solver_(rod_, stations(arm), model::segment_parameters(arm)) {}

  /// @return false where the truth has no stable equilibrium with a tip angle in the range
  bool make(const Truth& t, const arm::Range& tip_angle, std::vector<Vector3d>& points,
            Eigen::Vector4d& variances) {
    rod::Segment& segment = rod_.segments[0];
    segment.length_m = t.length;
    segment.bending_compliance = 1.0 / t.stiffness;
    segment.moment_nm = t.moment * Vector3d(-std::sin(t.phi), std::cos(t.phi), 0.0);
    rod_.loads[rod::kPayloadLoad].mass_kg = t.payload;
    // Hanging: the base frame's z axis points down.
    rod_.gravity_m_s2 = Vector3d(0.0, 0.0, t.hanging ? 9.80665 : -9.80665);
    if (solver_.solve(rod_) != rod::SolveStatus::kConverged || !solver_.stable()) return false;
    const Vector3d tangent = solver_.station(solver_.stations() - 1).q * Vector3d::UnitZ();
    const double angle = std::acos(std::clamp(tangent.z(), -1.0, 1.0));
    if (angle < tip_angle.low || angle > tip_angle.high) return false;
    Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
    points.clear();
    for (int i = 0; i + 1 < solver_.stations(); ++i) {
      points.push_back(solver_.station(i).p);
      const Eigen::Matrix3Xd d = solver_.dp(i);
      Eigen::Matrix<double, 3, 4> j;
      j.col(0) = -std::sin(t.phi) * d.col(model::kMomentX) + std::cos(t.phi) * d.col(model::kMomentY);
      j.col(1) =
          t.moment * (-std::cos(t.phi) * d.col(model::kMomentX) - std::sin(t.phi) * d.col(model::kMomentY));
      j.col(2) = -d.col(model::kBendingCompliance) / (t.stiffness * t.stiffness);
      j.col(3) = d.col(model::kLengthColumn);
      information += j.transpose() * j / (sd_ * sd_);
    }
    const Eigen::Vector4d scale = information.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::Matrix4d scaled = scale.asDiagonal() * information * scale.asDiagonal();
    variances = (scale.asDiagonal() * scaled.inverse() * scale.asDiagonal()).diagonal();
    return variances.allFinite() && (variances.array() > 0.0).all();
  }

 private:
  static std::vector<double> stations(const arm::Arm& arm) {
    std::vector<double> list = model::body_stations(arm);
    list.push_back(arm.total_length_m());
    return list;
  }

  double sd_;
  rod::Rod rod_;
  rod::Solver solver_;
};

/// The protocol's arm: one segment that hangs or stands on a body, with the weight that it states.
arm::Arm arm_of(arm::Arm arm, const AccuracyProtocol& protocol) {
  arm.segments.resize(1);
  arm.segments[0].mass_per_length_kg_m = protocol.weight_kg / arm.segments[0].length_m;
  arm.tip_mass_kg = 0.0;
  for (arm::MeasuredBody& body : arm.bodies) body.position_sd_m = protocol.position_sd_m;
  arm.base.body = "base";
  arm.base.rod_in_body.setIdentity();
  arm.gravity_m_s2 = {0.0, 0.0, -9.80665};
  return arm;
}

arm::EstimatorOptions options_of_accuracy() {
  arm::EstimatorOptions options;
  options.method = arm::Method::kFullPoints;
  options.objective = arm::Objective::kLeastSquares;
  options.unknown = arm::Unknown::kStiffness;
  return options;
}

Truth draw_truth(std::mt19937_64& random, const AccuracyProtocol& protocol, bool hanging) {
  Truth t;
  t.moment = uniform(random, protocol.moment_nm);
  t.phi = uniform(random, {-M_PI, M_PI});
  t.stiffness = uniform(random, protocol.bending_stiffness_nm2);
  t.length = uniform(random, protocol.length_m);
  t.payload = uniform(random, protocol.payload_kg);
  t.hanging = hanging;
  return t;
}

/// What a noisy motion capture sees of points in the base frame.
trial::Frame frame_of(const Truth& truth, const std::vector<Vector3d>& points, double position_sd_m,
                      std::mt19937_64& random) {
  trial::Frame frame;
  frame.payload_kg = truth.payload;
  // Hanging: turned by 180 degrees about x, so that the base's z axis points down.
  Eigen::Isometry3d base = Eigen::Isometry3d::Identity();
  if (truth.hanging) base.linear() = Eigen::AngleAxisd(M_PI, Vector3d::UnitX()).toRotationMatrix();
  frame.base_body = base;
  for (int i = 0; i < static_cast<int>(points.size()); ++i) {
    const Vector3d noise(normal(random), normal(random), normal(random));
    trial::BodyObservation seen;
    seen.body = i;
    seen.p_mocap = base * (points[static_cast<std::size_t>(i)] + position_sd_m * noise);
    frame.bodies.push_back(seen);
  }
  return frame;
}

/// Adds up what the report is made of.
class Score {
 public:
  /// @param bound variances by Cramér and Rao
  void add(const Truth& t, const SegmentEstimate& s, const Eigen::Vector4d& bound, AccuracyReport& report) {
    const double values[n] = {*s.moment_nm, *s.direction_rad, *s.bending_stiffness_nm2, *s.length_m};
    const double truths[n] = {t.moment, t.phi, t.stiffness, t.length};
    const std::optional<double> sds[n] = {s.sd_moment_nm, s.sd_direction_rad, s.sd_bending_stiffness_nm2,
                                          s.sd_length_m};
    const bool identifiable[n] = {s.identifiable_moment, s.sd_direction_rad.has_value(),
                                  s.identifiable_stiffness, s.sd_length_m.has_value()};
    const bool strong = t.moment >= 0.2;
    report.strong_frames += strong ? 1 : 0;
    for (int k = 0; k < n; ++k) {
      const auto i = static_cast<std::size_t>(k);
      double error = values[k] - truths[k];
      if (k == 1) error = std::remainder(error, 2.0 * M_PI);
      if (strong) {
        squared_error_[i] += error * error;
        variance_[i] += bound[k];
      }
      relative_[i].push_back(std::abs(error) / std::sqrt(bound[k]));
      if (identifiable[k] && sds[k]) {
        ++report.identifiable[i];
        if (std::abs(error) <= 1.959964 * *sds[k]) ++covered_[i];
      }
    }
    const double ei_bound = std::sqrt(bound[2]) / t.stiffness;
    if (ei_bound > 0.5) {
      ++report.hopeless;
      report.hopeless_claimed += s.identifiable_stiffness ? 1 : 0;
    } else if (ei_bound < 0.15) {
      ++report.clear;
      report.clear_claimed += s.identifiable_stiffness ? 1 : 0;
    }
  }

  void add_shape(const Estimate& estimate, const std::vector<Vector3d>& points) {
    double sum = 0.0;
    for (const BodyResidual& r : estimate.residuals) {
      sum += (r.estimated_base - points[static_cast<std::size_t>(r.body)]).squaredNorm();
    }
    shape_m_.push_back(std::sqrt(sum / static_cast<double>(points.size())));
  }

  void write(AccuracyReport& report) const {
    for (std::size_t i = 0; i < n; ++i) {
      report.efficiency[i] = variance_[i] > 0.0 ? std::sqrt(squared_error_[i] / variance_[i]) : 0.0;
      report.median_error_over_bound[i] = math::median(relative_[i]);
      report.coverage[i] =
          report.identifiable[i] > 0 ? static_cast<double>(covered_[i]) / report.identifiable[i] : 0.0;
    }
    report.median_shape_error_m = math::median(shape_m_);
  }

 private:
  static constexpr int n = AccuracyReport::kParameters;
  std::array<double, n> squared_error_{}, variance_{};
  std::array<std::vector<double>, n> relative_;
  std::array<int, n> covered_{};
  std::vector<double> shape_m_;
};

}  // namespace

AccuracyReport measure_accuracy(arm::Arm given, const AccuracyProtocol& protocol,
                                const std::function<void(int)>& progress) {
  const arm::Arm arm = arm_of(std::move(given), protocol);
  Estimator estimator(arm, options_of_accuracy());
  estimator.set_backbone_points(0);
  Generator generator(arm, protocol.position_sd_m);
  std::mt19937_64 random(protocol.seed);
  AccuracyReport report;
  Score score;
  std::vector<Vector3d> points;
  Eigen::Vector4d bound;
  while (report.frames < protocol.frames) {
    const Truth t = draw_truth(random, protocol, report.frames % 2 == 0);
    if (!generator.make(t, protocol.tip_angle_rad, points, bound)) continue;
    ++report.frames;
    if (progress && report.frames % 100 == 0) progress(report.frames);
    const trial::Frame frame = frame_of(t, points, protocol.position_sd_m, random);
    if (!protocol.warm) estimator.reset();
    const Estimate& estimate = estimator.estimate(frame);
    if (estimate.status != Status::kOk) continue;
    ++report.converged;
    score.add_shape(estimate, points);
    score.add(t, estimate.segments[0], bound, report);
  }
  score.write(report);
  return report;
}

std::string describe(const AccuracyReport& r) {
  const char* names[] = {"M0", "phi", "EI", "L"};
  std::string text = fmt::format("{} frames, {} converged, shape error {:.3f} mm (median)\n", r.frames,
                                 r.converged, 1e3 * r.median_shape_error_m);
  text += fmt::format("{:>4} {:>22} {:>22} {:>24}\n", "", "rms error / bound", "median |error| / bound",
                      "95 % intervals cover");
  for (std::size_t i = 0; i < AccuracyReport::kParameters; ++i) {
    text += fmt::format("{:>4} {:>22.3f} {:>22.3f} {:>15.2f} % of {:d}\n", names[i], r.efficiency[i],
                        r.median_error_over_bound[i], 100.0 * r.coverage[i], r.identifiable[i]);
  }
  text += fmt::format(
      "rms over {} frames with M0 >= 0.2 N m, median over all (0.674 is ideal), intervals where "
      "identifiable\n",
      r.strong_frames);
  text += fmt::format("bound on EI over 50 %: {} frames, of which {} claim EI as identifiable\n", r.hopeless,
                      r.hopeless_claimed);
  text += fmt::format("bound on EI under 15 %: {} frames, of which {} claim EI as identifiable\n", r.clear,
                      r.clear_claimed);
  return text;
}

}  // namespace softarm::estimate
