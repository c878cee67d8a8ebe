// A joint that yields, in the monitor's comparison of a measured shape with the laws.
#include <gtest/gtest.h>

#include "identify/synthetic.h"
#include "monitor/monitor_shape.h"
#include "softarm/arm/laws.h"
#include "softarm/estimate/estimator.h"

namespace softarm::monitor {
namespace {

namespace made = identify::testing;

TEST(MonitorJoint, IsNoDiscrepancyWhereTheArmFileHasIt) {
  const arm::Arm rigid = made::shipped("online_200mm");
  arm::Arm arm = rigid;
  arm.segments[0].joint_compliance_rad_per_nm = 0.5;
  const arm::InputValues inputs{20e3, 8e3, 0.0};
  for (const double payload_kg : {0.0, 0.1}) {
    made::FrameMaker maker(arm);
    const auto frame = maker.make(inputs, payload_kg, made::horizontal());
    ASSERT_TRUE(frame);
    estimate::Estimator estimator(arm, arm.estimator);
    const estimate::Estimate& estimate = estimator.estimate(*frame);
    ASSERT_EQ(estimate.status, estimate::Status::kOk) << estimate.detail;
    const auto left_m = [&](const arm::Arm& by) {
      MonitorShape shape(by);
      shape.set(estimate);
      Displacements e = Displacements::Zero(static_cast<Eigen::Index>(3 * by.bodies.size()));
      const auto laws = predict(by, inputs);
      shape.discrepancy(&*laws, e);
      return e.norm();
    };
    EXPECT_GT(left_m(rigid), 5e-3);
    EXPECT_LT(left_m(arm), 0.02 * left_m(rigid)) << left_m(arm) << " m, rigid " << left_m(rigid);
  }
}

}  // namespace
}  // namespace softarm::monitor
