// Whether what was identified holds on unseen trials, in one line.
#include <gtest/gtest.h>

#include "softarm/identify/identify.h"

namespace softarm::identify {
namespace {

Result held_out(double before_m, double after_m) {
  Result result;
  arm::MeasuredBody body;
  body.position_sd_m = 0.0005;
  result.arm.bodies.push_back(body);
  result.held_out_before.mean_m = before_m;
  result.held_out.mean_m = after_m;
  result.held_out_before.frames = result.held_out.frames = 100;
  return result;
}

TEST(Verdict, SaysWhetherHeldOutErrorsFell) {
  EXPECT_EQ(verdict(held_out(0.01498, 0.01516)),
            "does not generalise: 14.98 → 15.16 mm on unseen trials; run diagnose");
  EXPECT_EQ(verdict(held_out(0.01498, 0.01495)),
            "does not generalise: 14.98 → 14.95 mm on unseen trials; run diagnose");
  EXPECT_EQ(verdict(held_out(0.01498, 0.0031)), "generalises: 14.98 → 3.10 mm on unseen trials");
  EXPECT_EQ(verdict(held_out(0.0011, 0.0012)),
            "as good as before: 1.10 → 1.20 mm on unseen trials, no more than noise");
  EXPECT_EQ(verdict(Result()), "no trial is unseen: nothing says whether this generalises");
  EXPECT_FALSE(generalises(Result()));
}

TEST(Verdict, OfEachTrialByTheOthersWhereThatWasAsked) {
  Result result = held_out(0.01, 0.001);
  result.left_out_one.resize(3);
  result.left_out_one_before.mean_m = result.left_out_one_after.mean_m = 0.02;
  result.left_out_one_after.frames = 100;
  EXPECT_EQ(verdict(result), "does not generalise: 20.00 → 20.00 mm on unseen trials; run diagnose");
  EXPECT_EQ(generalises(result), false);
}

}  // namespace
}  // namespace softarm::identify
