// A stream of frames: warm starts, resets, jumps, repeatability; and cold starts from shapes of all kinds.
#include <gtest/gtest.h>

#include "estimate/estimate_summary.h"
#include "finite.h"
#include "frames.h"

namespace softarm::estimate::testing {
namespace {

std::vector<trial::Frame> smooth_stream(const arm::Arm& arm, int frames, unsigned seed) {
  std::mt19937_64 random(seed);
  FrameMaker maker(arm);
  std::vector<trial::Frame> stream;
  for (int i = 0; i < frames; ++i) {
    const double t = i / 240.0 * 5.0;
    const Truth truth{
        {{0.3 + 0.15 * std::sin(t), 2.0 * t, 0.035 + 0.01 * std::sin(0.7 * t), 0.2 + 0.005 * std::cos(t)}},
        0.2,
        hanging()};
    stream.push_back(with_noise(arm, maker.make(truth).value(), random));
    stream.back().stamp_ns = trial::to_nanoseconds(i / 240.0);
  }
  return stream;
}

TEST(Stream, WarmAndColdStartsAgree) {
  const arm::Arm arm = paper_arm();
  estimate::Estimator warm(arm, with_method(arm::Method::kFullPoints)),
      cold(arm, with_method(arm::Method::kFullPoints));
  int warm_iterations = 0, cold_iterations = 0, index = 0;
  for (const trial::Frame& frame : smooth_stream(arm, 200, 1)) {
    const estimate::Estimate& w = warm.estimate(frame);
    cold.reset();
    const estimate::Estimate& c = cold.estimate(frame);
    ASSERT_EQ(w.status, estimate::Status::kOk) << w.detail;
    ASSERT_EQ(c.status, estimate::Status::kOk) << c.detail;
    EXPECT_EQ(w.solver.warm_start, index++ > 0);
    EXPECT_FALSE(c.solver.warm_start);
    warm_iterations += w.solver.iterations;
    cold_iterations += c.solver.iterations;
    // Both stop when the cost no longer changes by a small share: well within a twentieth of what the noise
    // does.
    const estimate::SegmentEstimate &a = w.segments[0], &b = c.segments[0];
    EXPECT_NEAR(*a.moment_nm, *b.moment_nm, 0.05 * *b.sd_moment_nm);
    EXPECT_NEAR(std::remainder(*a.direction_rad - *b.direction_rad, 2.0 * M_PI), 0.0,
                0.05 * *b.sd_direction_rad);
    EXPECT_NEAR(*a.bending_stiffness_nm2, *b.bending_stiffness_nm2, 0.05 * *b.sd_bending_stiffness_nm2);
    EXPECT_NEAR(*a.length_m, *b.length_m, 0.05 * *b.sd_length_m);
  }
  EXPECT_LE(warm_iterations, cold_iterations);
}

TEST(Stream, AFitThatUsesUpItsIterationsIsNoEstimate) {
  // Measured so well that one step from the measured shape mostly ends far from the fit, in standard
  // deviations.
  const arm::Arm arm = precisely_measured(paper_arm());
  estimate::Estimator hasty(arm, with_method(arm::Method::kFullPoints)),
      whole(arm, with_method(arm::Method::kFullPoints));
  hasty.set_most_iterations(1);
  EstimateSummary summary(arm);
  int refused = 0;
  for (const trial::Frame& frame : smooth_stream(arm, 40, 3)) {
    const estimate::Estimate &h = hasty.estimate(frame), &w = whole.estimate(frame);
    summary.add(h);
    ASSERT_EQ(w.status, estimate::Status::kOk) << w.detail;
    const estimate::SegmentEstimate &a = h.segments[0], &b = w.segments[0];
    if (h.status == estimate::Status::kOk) {
      EXPECT_NEAR(*a.bending_stiffness_nm2, *b.bending_stiffness_nm2, 0.15 * *b.sd_bending_stiffness_nm2);
      EXPECT_NEAR(*a.length_m, *b.length_m, 0.15 * *b.sd_length_m);
      continue;
    }
    ++refused;
    EXPECT_EQ(h.status, estimate::Status::kNoConvergence);
    EXPECT_NE(h.detail.find("had not converged after 1 iteration"), std::string::npos) << h.detail;
    EXPECT_TRUE(h.backbone.empty());
    EXPECT_FALSE(a.moment_nm || a.bending_stiffness_nm2 || h.payload_kg);
  }
  EXPECT_GT(refused, 5);
  EXPECT_NE(summary.text({}, 0).find("not ok, no_convergence"), std::string::npos) << summary.text({}, 0);
}

TEST(Stream, AJumpOfTheShapeIsFollowed) {
  const arm::Arm arm = precisely_measured(paper_arm());
  estimate::Estimator estimator(arm, with_method(arm::Method::kFullPoints));
  const Truth here{{{0.5, 0.0, 0.03, 0.2}}, 0.2, hanging()}, there{{{0.5, 3.0, 0.03, 0.2}}, 0.2, hanging()},
      elsewhere{{{0.2, -1.5, 0.06, 0.21}}, 0.1, standing()};
  for (const Truth& truth : {here, there, here, elsewhere, there}) {
    expect_truth(estimator.estimate(make_frame(arm, truth)), truth, 1e-3);
  }
}

TEST(Stream, TheSameFramesGiveTheSameBits) {
  const arm::Arm arm = paper_arm();
  const std::vector<trial::Frame> stream = smooth_stream(arm, 100, 2);
  estimate::Estimator first(arm, with_method(arm::Method::kFullPoints)),
      second(arm, with_method(arm::Method::kFullPoints));
  for (const trial::Frame& frame : stream) {
    const estimate::Estimate& a = first.estimate(frame);
    const estimate::Estimate& b = second.estimate(frame);
    ASSERT_EQ(a.status, estimate::Status::kOk);
    const estimate::SegmentEstimate &x = a.segments[0], &y = b.segments[0];
    EXPECT_EQ(x.moment_nm, y.moment_nm);
    EXPECT_EQ(x.direction_rad, y.direction_rad);
    EXPECT_EQ(x.bending_stiffness_nm2, y.bending_stiffness_nm2);
    EXPECT_EQ(x.length_m, y.length_m);
    EXPECT_TRUE(x.covariance == y.covariance);
    EXPECT_EQ(a.backbone.back().p_base, b.backbone.back().p_base);
    EXPECT_EQ(a.stamp_s, frame.stamp_s());
  }
  // And after a reset an estimator is as good as new.
  const double was = estimate::Estimator(arm, with_method(arm::Method::kFullPoints))
                         .estimate(stream[50])
                         .segments[0]
                         .length_m.value();
  first.reset();
  EXPECT_EQ(first.estimate(stream[50]).segments[0].length_m.value(), was);
}

TEST(ColdStart, ConvergesFromAnyReachableShape) {
  std::mt19937_64 random(7);
  int made = 0, drawn = 0;
  double sharpest = 0.0;
  while (made < 300 && ++drawn < 20000) {
    arm::Arm arm = precisely_measured(paper_arm());
    arm::Segment& segment = arm.segments[0];
    segment.mass_per_length_kg_m = uniform(random, 0.1, 1.5);
    segment.bending_stiffness.base_nm2 = uniform(random, 0.02, 0.06);
    arm.payload.offset_m = 0.02 * normal3(random);
    const Eigen::Quaterniond attitude(Eigen::Vector4d(normal3(random).homogeneous()).normalized());
    const Truth truth{{{uniform(random, 0.05, 0.8), uniform(random, -M_PI, M_PI), uniform(random, 0.02, 0.08),
                        uniform(random, 0.18, 0.23)}},
                      uniform(random, 0.1, 0.4),
                      pose(normal3(random), made % 3 == 0   ? Eigen::Quaterniond(hanging().linear())
                                            : made % 3 == 1 ? Eigen::Quaterniond::Identity()
                                                            : attitude)};
    FrameMaker maker(arm);
    const std::optional<trial::Frame> frame = maker.make(truth);
    if (!frame || maker.tip_angle_rad() < 0.17 || maker.tip_angle_rad() > 170.0 / 180.0 * M_PI) continue;
    ++made;
    sharpest = std::max(sharpest, maker.tip_angle_rad());
    SCOPED_TRACE("shape " + std::to_string(made));
    estimate::Estimator estimator(arm, with_method(arm::Method::kFullPoints));
    const estimate::Estimate& estimate = estimator.estimate(*frame);
    expect_truth(estimate, truth, 1e-2);
    EXPECT_LT(estimate.rms_residual_m, 1e-5);
  }
  EXPECT_EQ(made, 300);
  EXPECT_GT(sharpest, 165.0 / 180.0 * M_PI);
}

}  // namespace
}  // namespace softarm::estimate::testing
