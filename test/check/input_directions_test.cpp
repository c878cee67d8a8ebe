// Inputs that bend the arm elsewhere than the arm file says.
#include <gmock/gmock.h>

#include <cmath>
#include <utility>

#include "check_fixture.h"

namespace softarm {
namespace {

using namespace testing_check;
using ::testing::HasSubstr;

class InputDirections : public ::testing::Test {
 protected:
  check::CheckReport report() const { return check::check_recording(recording, arm); }
  arm::Arm arm = hanging_arm();
  trial::CheckRecording recording = clean();
};

TEST_F(InputDirections, InputsThatBendTheArmElsewhere) {
  EXPECT_EQ(find(report(), "bends_elsewhere"), nullptr);
  std::swap(recording.inputs[0], recording.inputs[1]);
  const check::CheckReport exchanged = report();
  const check::CheckFinding* f = find(exchanged, "bends_elsewhere", "chamber_1, chamber_2");
  ASSERT_NE(f, nullptr) << to_text(exchanged);
  EXPECT_EQ(f->severity, check::Severity::kSerious);
  EXPECT_THAT(f->what, HasSubstr("chamber_1 bends the arm where the arm file's chamber_2 does"));
  EXPECT_THAT(f->what, HasSubstr("turned by 180 degrees"));
  std::swap(recording.inputs[0], recording.inputs[1]);

  for (arm::Chamber& chamber : arm.segments[0].chambers) chamber.bending_direction_rad += 0.5 * M_PI;
  const check::CheckReport turned = report();
  f = find(turned, "bends_elsewhere", "chamber_1, chamber_2");
  ASSERT_NE(f, nullptr) << to_text(turned);
  EXPECT_EQ(f->severity, check::Severity::kSerious);
  EXPECT_THAT(f->what, HasSubstr("the arm bends -90 degrees about its axis from where"));
  EXPECT_NEAR(*f->figure, -0.5 * M_PI, 0.02);

  arm = hanging_arm();
  arm.segments[0].chambers[1].bending_direction_rad += 1.2;
  // What one of several seems to do may be another's doing.
  EXPECT_EQ(find(report(), "bends_elsewhere"), nullptr) << complaints(report());
  arm.segments[0].chambers[0].bending_direction_rad += 1.5;
  EXPECT_NE(find(report(), "bends_elsewhere", "chamber_1, chamber_2"), nullptr) << to_text(report());
  // The only one there is.
  arm.segments[0].chambers.pop_back();
  EXPECT_NE(find(report(), "bends_elsewhere", "chamber_1"), nullptr) << to_text(report());
  // Chambers that are glued in a little elsewhere are none.
  arm = hanging_arm();
  for (arm::Chamber& chamber : arm.segments[0].chambers) chamber.bending_direction_rad += 0.7;
  EXPECT_EQ(find(report(), "bends_elsewhere"), nullptr) << complaints(report());
}

/// Where inputs go round in a circle a lag is a turn.
TEST_F(InputDirections, ALagOfInputsThatGoRoundIsNoTurn) {
  constexpr double kTurnsHz = 1.0;
  const auto circle = [](int i, double t_s) {
    return 12e3 * (1.0 + std::sin(2.0 * M_PI * kTurnsHz * t_s + i * 0.5 * M_PI));
  };
  arm.segments[0].chambers[1].bending_direction_rad = 0.5 * M_PI;
  for (const double lag_s : {0.0, 0.2}) {
    SCOPED_TRACE(lag_s);
    recording = clean(2, lag_s, {kSeconds, circle});
    for (std::size_t b = 1; b < 4; ++b) {
      const double s_m = arm.bodies[b - 1].arclength_m;
      for (auto& pose : recording.bodies[b]) {
        const double t_s = pose.stamp_s - kStart - lag_s;
        const Eigen::Vector3d bent(1e-4 * circle(0, t_s) * s_m * s_m, 1e-4 * circle(1, t_s) * s_m * s_m, s_m);
        pose.p_mocap =
            base_pose() * bent + 1e-4 * Eigen::Vector3d(std::sin(7e3 * t_s), std::cos(9e3 * t_s), 0.0);
      }
    }
    EXPECT_EQ(find(report(), "bends_elsewhere"), nullptr) << complaints(report());
  }
}

TEST_F(InputDirections, WhatMovesTheArmBesideItsInputsAccusesNone) {
  for (std::size_t b = 1; b < 4; ++b) {
    for (auto& pose : recording.bodies[b]) {
      const double t = pose.stamp_s - kStart;
      pose.p_mocap.y() += 0.06 * (b / 3.0) * (b / 3.0) * std::sin(2.6 * t + 0.02 * t * t);
    }
  }
  for (arm::Chamber& chamber : arm.segments[0].chambers) chamber.bending_direction_rad += 0.5 * M_PI;
  EXPECT_EQ(find(report(), "bends_elsewhere"), nullptr) << complaints(report());
}

}  // namespace
}  // namespace softarm
