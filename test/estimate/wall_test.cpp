// A wall that creeps, frame by frame: where the laws are the prior, they are what the wall lets through, and
// as uncertain as the beginning of the recording makes them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "arm/wall_memory.h"
#include "frames.h"
#include "softarm/arm/laws.h"

namespace softarm::estimate::testing {
namespace {

constexpr double kTime_s = 2.0, kShare = 0.4;

arm::Arm walled_arm() {
  arm::Arm arm = paper_arm();
  arm.segments[0].wall.bending = {{kTime_s, kShare}};
  arm.segments[0].wall.initial_curvature_sd_per_m = 2.0;
  arm.estimator.prior.enabled = true;
  arm.estimator.prior.moment_sd_nm = 1e-3;
  arm.estimator.prior.bending_stiffness_sd_rel = 0.01;
  return arm;
}

arm::InputValues pressures_at(const arm::Arm& arm, double t_s) {
  arm::InputValues inputs(arm.inputs.scalars.size(), 0.0);
  inputs[0] = t_s < 1.0 ? 10e3 : 40e3;
  return inputs;
}

/// What the wall lets through, base to tip, as if from so far beyond the laws.
class Creeping {
 public:
  explicit Creeping(const arm::Arm& arm) : arm_(arm), memory_(arm) {}
  trial::Frame at(double t_s) {
    const arm::InputValues inputs = pressures_at(arm_, t_s);
    auto laws = arm::predict(arm_, inputs);
    memory_.follow(t_s, inputs, *laws);
    const Eigen::Vector2d moment = laws->front().actuation_nm();
    const Truth truth{{{moment.norm(), std::atan2(moment.y(), moment.x()),
                        laws->front().bending_stiffness_nm2, laws->front().length_m}},
                      0.0,
                      hanging()};
    trial::Frame frame = make_frame(arm_, truth);
    frame.stamp_ns = trial::to_nanoseconds(t_s);
    frame.inputs = inputs;
    moment_nm = moment.norm();
    return frame;
  }
  double moment_nm = 0.0;

 private:
  const arm::Arm arm_;
  arm::LawMemory memory_;
};

TEST(EstimateWall, PriorFollowsTheWall) {
  const arm::Arm arm = walled_arm();
  arm::Arm unaware = arm;
  unaware.segments[0].wall = {};
  Creeping truth(arm);
  estimate::Estimator with(arm, arm.estimator), without(unaware, unaware.estimator);
  double largest = 0.0, largest_without = 0.0;
  for (int i = 0; i <= 80; ++i) {
    const trial::Frame frame = truth.at(0.1 * i);
    const Estimate& estimate = with.estimate(frame);
    ASSERT_EQ(estimate.status, Status::kOk) << estimate.detail;
    largest = std::max(largest, std::abs(*estimate.segments[0].moment_nm - truth.moment_nm));
    const Estimate& wrong = without.estimate(frame);
    ASSERT_EQ(wrong.status, Status::kOk) << wrong.detail;
    largest_without = std::max(largest_without, std::abs(*wrong.segments[0].moment_nm - truth.moment_nm));
  }
  EXPECT_LT(largest, 0.2 * largest_without);
}

TEST(EstimateWall, HowTheRecordingFoundItIsNotKnownAndIsForgotten) {
  arm::Arm arm = walled_arm();
  for (arm::MeasuredBody& body : arm.bodies) {  // what bodies do not tell, the laws do
    body.position_sd_m = 0.02;
    body.orientation_sd_rad = 0.5;
  }
  Creeping truth(arm);
  estimate::Estimator estimator(arm, arm.estimator);
  std::vector<double> sd_nm;
  for (int i = 0; i < 10; ++i) {  // at constant inputs
    const Estimate& estimate = estimator.estimate(truth.at(0.1 * i));
    ASSERT_EQ(estimate.status, Status::kOk) << estimate.detail;
    sd_nm.push_back(*estimate.segments[0].sd_moment_nm);
  }
  EXPECT_GT(sd_nm.front(), 1.2 * sd_nm.back());
  EXPECT_TRUE(std::is_sorted(sd_nm.rbegin(), sd_nm.rend()));
}

TEST(EstimateWall, GoesOnWhileBodiesAreHiddenAndBeginsAnewAfterAReset) {
  const arm::Arm arm = walled_arm();
  Creeping truth(arm);
  estimate::Estimator seen(arm, arm.estimator), hidden(arm, arm.estimator);
  for (int i = 0; i <= 40; ++i) {
    trial::Frame frame = truth.at(0.1 * i);
    seen.estimate(frame);
    if (i > 5 && i < 38) frame.bodies.clear();
    hidden.estimate(frame);
  }
  const trial::Frame last = truth.at(4.1);
  EXPECT_NEAR(*hidden.estimate(last).segments[0].moment_nm, *seen.estimate(last).segments[0].moment_nm, 1e-5);
  seen.reset();
  EXPECT_GT(*seen.estimate(last).segments[0].sd_moment_nm, *hidden.estimate(last).segments[0].sd_moment_nm);
}

}  // namespace
}  // namespace softarm::estimate::testing
