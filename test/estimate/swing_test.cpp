// Arms that swing, which a window fits as if they stood still under another gravity.
#include <gtest/gtest.h>

#include <cmath>

#include "estimate/body_rows.h"
#include "estimate/problem.h"
#include "estimate/tip_motion.h"
#include "frames.h"
#include "model/inertia.h"
#include "softarm/arm/laws.h"

namespace softarm::estimate::testing {
namespace {

using Eigen::Vector3d;

constexpr double kNoise_m = 0.0005;

TEST(TipMotion, MeanSquareIsThatOfASwing) {
  for (const double rate_hz : {120.0, 20.0, 8.0}) {
    for (const double swing_hz : {0.7, 1.4}) {
      SCOPED_TRACE(std::to_string(rate_hz) + " frames, " + std::to_string(swing_hz) + " swings a second");
      const double amplitude_m = 0.02, w = 2.0 * M_PI * swing_hz;
      estimate::TipMotion motion(kNoise_m);
      double mean = 0.0;
      const int count = static_cast<int>(10.0 * rate_hz), from = static_cast<int>(2.0 * rate_hz);
      for (int i = 0; i < count; ++i) {
        const double t_s = i / rate_hz;
        motion.add(100.0 + t_s, {amplitude_m * std::cos(w * t_s), 0.0, 0.2});
        if (i >= from) mean += motion.acceleration_variance().x() / (count - from);
      }
      // A parabola through half a swing is flatter than the swing, and the larger of two is counted.
      const double exact = 0.5 * std::pow(amplitude_m * w * w, 2);
      EXPECT_GT(mean, 0.6 * exact);
      EXPECT_LT(mean, 1.25 * exact);
      EXPECT_LT(motion.acceleration_variance().tail<2>().maxCoeff(), 1e-6 * exact);
    }
  }
}

TEST(TipMotion, NoiseIsNone) {
  std::mt19937_64 random(3);
  for (const double rate_hz : {120.0, 20.0, 5.0}) {
    estimate::TipMotion motion(kNoise_m);
    double mean = 0.0;
    constexpr int kStill = 2000;
    for (int i = 0; i < kStill; ++i) {
      motion.add(100.0 + i / rate_hz, kNoise_m * normal3(random));
      mean += motion.acceleration_variance().sum() / kStill;
    }
    EXPECT_LT(std::sqrt(mean), 0.005 * 9.81) << rate_hz;
  }
}

TEST(TipMotion, AnOnsetIsSeenAtOnceAndForgottenAfterASwing) {
  constexpr double kRate_hz = 60.0, kAcceleration = 4.0;
  estimate::TipMotion motion(kNoise_m);
  std::mt19937_64 random(4);
  double seen_s = -1.0;
  for (int i = 0; i < 120; ++i) {
    const double t_s = i / kRate_hz, moving_s = std::clamp(t_s - 1.0, 0.0, 0.2);
    const double way_m = kAcceleration * moving_s * (0.5 * moving_s + std::max(0.0, t_s - 1.2));
    motion.add(100.0 + t_s, Vector3d(way_m, 0.0, 0.0) + 0.2 * kNoise_m * normal3(random));
    if (seen_s < 0.0 && t_s > 1.0 && motion.acceleration_variance().x() > 0.1) seen_s = t_s - 1.0;
  }
  EXPECT_GT(seen_s, 0.0);
  EXPECT_LT(seen_s, 0.13);
  EXPECT_LT(motion.acceleration_variance().x(), 0.01);
}

TEST(Swing, RowsHaveTheDerivativeByGravity) {
  arm::Arm arm = paper_arm();
  arm.bodies[1].kind = arm::BodyKind::kSkinMarker;
  arm.bodies[1].radius_m = 0.02;
  arm.bodies[1].angle_rad = 0.7;
  for (arm::MeasuredBody& body : arm.bodies) body.orientation_usable = true;
  arm::EstimatorOptions options;
  options.window_s = 1.0;
  options.method = arm::Method::kEndOrientation;
  estimate::Problem problem(arm, options);
  for (int i = 0; i < 4; ++i) {
    estimate::Observation seen;
    seen.body = i;
    if (i != 1) seen.tangent = Vector3d::UnitZ();
    problem.observations().push_back(seen);
  }
  Eigen::VectorXd x(5);
  x << 0.5, -0.3, 1.1, 1.02, 1.5;
  const Vector3d gravity(1.0, -0.5, 9.7);
  const estimate::WhiteNoise noise(arm);
  const auto rows_at = [&](const Vector3d& g) {
    problem.set_gravity(g);
    EXPECT_TRUE(problem.evaluate(x));
    return estimate::body_rows(problem, x, noise, 5, 4, 20 + estimate::kMotions);
  };
  const Eigen::MatrixXd by_motion = rows_at(gravity).j.middleCols(25, estimate::kMotions);
  constexpr double kStep = 1e-3;
  for (int k = 0; k < 3; ++k) {
    const Vector3d step = kStep * Vector3d::Unit(k);
    const Eigen::VectorXd differences =
        (rows_at(gravity + step).model - rows_at(gravity - step).model) / (2.0 * kStep);
    EXPECT_GT(differences.norm(), 1e-3);
    EXPECT_LT((by_motion.col(k) - differences).norm(), 1e-4 * differences.norm());
  }
}

/// The paper's arm with a payload, swinging as D'Alembert has it: at rest under a gravity that is less by
/// what its inertia is, and as fast as that makes it.
class Swinging {
 public:
  Swinging(double payload_kg, double amplitude_m)
      : arm_(placed_exactly(paper_arm())), payload_kg_(payload_kg) {
    const double step = 0.1;
    const double compliance = (tip(Vector3d(step, 0, 0)) - tip(Vector3d(-step, 0, 0))).x() / (2.0 * step);
    share_ = model::inertia_over_weight(0.2, payload_kg);
    rate_ = 1.0 / std::sqrt(share_ * compliance);
    acceleration_ = amplitude_m * rate_ * rate_;
  }
  const arm::Arm& arm() const { return arm_; }
  double stiffness() const { return truth().segments[0].bending_stiffness_nm2; }
  double swing_hz() const { return rate_ / (2.0 * M_PI); }
  trial::Frame at(double t_s, double starts_s) const {
    const double phase = std::max(0.0, t_s - starts_s);
    const double now = t_s < starts_s ? 0.0 : acceleration_ * std::sin(rate_ * phase);
    trial::Frame frame = frame_under(Vector3d(share_ * now, 0.0, 0.0));
    frame.inputs = inputs_;
    frame.payload_kg.reset();
    frame.stamp_ns = trial::to_nanoseconds(100.0 + t_s);
    return frame;
  }

 private:
  Truth truth() const {
    const arm::SegmentPrediction law = arm::predict_segment(arm_, arm_.segments[0], inputs_).value();
    return {{{law.moment_nm.norm(), std::atan2(law.moment_nm.y(), law.moment_nm.x()),
              law.bending_stiffness_nm2, law.length_m}},
            payload_kg_,
            hanging()};
  }
  trial::Frame frame_under(const Vector3d& more) const {
    arm::Arm other = arm_;
    other.gravity_m_s2 += more;
    return make_frame(other, truth());
  }
  Vector3d tip(const Vector3d& more) const { return frame_under(more).bodies.back().p_mocap; }

  const arm::Arm arm_;
  const arm::InputValues inputs_{45e3, 12e3, 20e3};
  double payload_kg_, share_ = 1.0, rate_ = 1.0, acceleration_ = 0.0;
};

TEST(Swing, ItsShapeIsFollowed) {
  arm::EstimatorOptions options;
  options.unknown = arm::Unknown::kBoth;
  options.window_s = 5.0;
  options.prior.enabled = true;
  options.prior.moment_sd_nm = options.prior.moment_jitter_sd_nm = 0.001;
  options.prior.moment_sd_rel = options.prior.bending_stiffness_sd_rel = 0.03;
  options.prior.length_sd_m = 0.001;
  options.prior.length_jitter_sd_m = 0.0002;
  for (const double payload_kg : {0.05, 0.2}) {
    for (const double rate_hz : {20.0, 60.0}) {
      const Swinging arm(payload_kg, 0.015);
      SCOPED_TRACE(std::to_string(payload_kg) + " kg, " + std::to_string(arm.swing_hz()) + " Hz");
      std::mt19937_64 random(41);
      estimate::Estimator estimator(arm.arm(), options);
      estimator.set_backbone_points(0);
      int far = 0, count = 0;
      double squares = 0.0, still_kg = 0.0, last_kg = 0.0;
      for (int i = 0; i < static_cast<int>(12.0 * rate_hz); ++i) {
        const double t_s = i / rate_hz, starts_s = 4.0;
        const estimate::Estimate& estimate =
            estimator.estimate(with_noise(arm.arm(), arm.at(t_s, starts_s), random));
        ASSERT_EQ(estimate.status, estimate::Status::kOk) << estimate.detail;
        last_kg = estimate.sd_payload_kg.value();
        if (t_s < starts_s) still_kg = last_kg;
        if (t_s < starts_s + 0.25) continue;  // not seen yet
        ++count;
        far += std::abs(*estimate.payload_kg - payload_kg) > 3.0 * last_kg ||
               std::abs(*estimate.segments[0].bending_stiffness_nm2 - arm.stiffness()) >
                   3.0 * estimate.segments[0].sd_bending_stiffness_nm2.value();
        squares += estimate.rms_residual_m * estimate.rms_residual_m;
      }
      EXPECT_LT(far, 0.01 * count);
      EXPECT_LT(std::sqrt(squares / count), 2.0 * std::sqrt(3.0) * 0.0005)
          << "the bodies are where they were seen";
      EXPECT_GT(last_kg, still_kg);
    }
  }
}

}  // namespace
}  // namespace softarm::estimate::testing
