// A wall that creeps is no mismatch where the arm file has it.
#include <gtest/gtest.h>

#include "arm/wall_memory.h"
#include "identify/synthetic.h"
#include "softarm/arm/laws.h"
#include "softarm/estimate/estimator.h"
#include "softarm/monitor/mismatch_monitor.h"

namespace softarm::monitor {
namespace {

namespace made = identify::testing;

TEST(MonitorWall, IsNoMismatchWhereTheArmFileHasIt) {
  const arm::Arm unaware = made::shipped("online_200mm");
  arm::Arm arm = unaware;
  arm.segments[0].wall.bending = {{1.5, 0.4}};
  made::FrameMaker maker(arm);
  arm::LawMemory memory(arm);
  estimate::Estimator estimator(unaware, unaware.estimator);
  MismatchMonitor with(arm), without(unaware);
  double largest = 0.0, largest_without = 0.0;
  for (int i = 0; i < 600; ++i) {
    const double t_s = 0.05 * i;
    const arm::InputValues inputs{(i / 80) % 2 == 0 ? 5e3 : 40e3, 8e3, 0.0};
    auto laws = arm::predict(arm, inputs);
    memory.follow(t_s, inputs, *laws);
    auto frame = maker.make_lagging(inputs, 0.0, made::horizontal(), memory.kept_back().front());
    ASSERT_TRUE(frame);
    frame->stamp_ns = trial::to_nanoseconds(t_s);
    const estimate::Estimate& estimate = estimator.estimate(*frame);
    ASSERT_EQ(estimate.status, estimate::Status::kOk) << estimate.detail;
    const double now = with.add(*frame, estimate).rms_m, now_without = without.add(*frame, estimate).rms_m;
    if (i % 80 < 10) continue;  // means over a step of the inputs are of both sides
    largest = std::max(largest, now);
    largest_without = std::max(largest_without, now_without);
  }
  EXPECT_GT(largest_without, 5e-3);
  EXPECT_LT(largest, 0.02 * largest_without);
}

}  // namespace
}  // namespace softarm::monitor
