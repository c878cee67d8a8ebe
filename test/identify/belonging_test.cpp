// Recordings that were read with other axes, units or quaternions than the arm file is for.
#include "identify/belonging.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "identify/identify_extended.h"
#include "synthetic.h"

namespace softarm::identify::testing {
namespace {

using ::testing::HasSubstr;

class Belongs : public ::testing::Test {
 protected:
  Belongs() {
    std::mt19937_64 random(4);
    Protocol protocol;
    protocol.trials = 6;
    protocol.draw = paper_inputs;
    trials_ = make_trials(arm_, protocol, random);
  }

  /// The trials as a reader with other ideas of positions and quaternions has them.
  template <typename P, typename Q>
  std::vector<trial::Trial> misread(const P& p, const Q& q) const {
    std::vector<trial::Trial> trials = trials_;
    for (trial::Trial& trial : trials) {
      for (trial::Frame& frame : trial.frames) {
        Eigen::Isometry3d base(q(Eigen::Quaterniond(frame.base_body->linear())));
        base.translation() = p(frame.base_body->translation());
        frame.base_body = base;
        for (trial::BodyObservation& body : frame.bodies) {
          body.p_mocap = p(body.p_mocap);
          if (body.q_mocap) body.q_mocap = q(*body.q_mocap);
        }
      }
    }
    return trials;
  }

  const arm::Arm arm_ = pneumatic_arm();
  std::vector<trial::Trial> trials_;
};

Eigen::Vector3d same(const Eigen::Vector3d& p) {
  return p;
}

TEST_F(Belongs, WhatBelongsTogetherIsSaidNothingOf) {
  ASSERT_TRUE(arm_.base.body);
  const Belonging found = belonging(arm_, trials_);
  EXPECT_TRUE(found.together);
  EXPECT_LT(found.mean_m.value(), 2e-3);
  EXPECT_EQ(describe(found), "");
  // Laws that are off by half are no other arm.
  arm::Arm rough = arm_;
  for (arm::Chamber& chamber : rough.segments[0].chambers) chamber.moment_gain_nm_per_pa *= 0.5;
  EXPECT_TRUE(belonging(rough, trials_).together);
}

TEST_F(Belongs, OtherUnitsAreFound) {
  for (const auto& [factor, units] : {std::pair(1e3, "mm in place of m"), std::pair(1e-3, "m in place of mm"),
                                      std::pair(1e-2, "m in place of cm")}) {
    const Belonging found = belonging(
        arm_, misread([factor = factor](const Eigen::Vector3d& p) { return Eigen::Vector3d(factor * p); },
                      [](const Eigen::Quaterniond& q) { return q; }));
    ASSERT_FALSE(found.together) << units;
    EXPECT_THAT(found.tried.front().name, HasSubstr(std::string("positions in ") + units));
    EXPECT_LT(found.tried.front().mean_m, 2e-3);
    EXPECT_THAT(describe(found), HasSubstr("DO NOT BELONG TOGETHER"));
    EXPECT_THAT(describe(found), HasSubstr(std::string("With positions in ") + units));
  }
}

TEST_F(Belongs, TheVerdictOfAnIdentificationIsThatTheyDoNot) {
  const auto in_km = misread([](const Eigen::Vector3d& p) { return Eigen::Vector3d(1e-3 * p); },
                             [](const Eigen::Quaterniond& q) { return q; });
  const Result apart = identify_extended(arm_, {}, in_km, {}, {}, 1);
  EXPECT_THAT(verdict(apart), HasSubstr("DO NOT BELONG TOGETHER"));
  EXPECT_EQ(generalises(apart), std::optional<bool>(false));
  // Whatever was fitted, an arm file can be written of it.
  EXPECT_LE(apart.prior.moment_jitter_sd_nm, 100.0);
  EXPECT_LE(apart.prior.length_jitter_sd_m, 1.0);
}

TEST_F(Belongs, GainsInOtherUnitsAreNoOtherArm) {
  arm::Arm in_psi = arm_;
  for (arm::Chamber& chamber : in_psi.segments[0].chambers) chamber.moment_gain_nm_per_pa *= 6.9;
  EXPECT_FALSE(belonging(in_psi, trials_).together);
  const Result found = identify_extended(in_psi, {}, trials_, {}, {}, 1);
  EXPECT_LT(found.fitted.mean_m, 2e-3);
  EXPECT_EQ(found.apart, "");
  ASSERT_FALSE(found.warnings.empty());
  EXPECT_THAT(found.warnings.front(), HasSubstr("are the units and order of the inputs"));
}

TEST_F(Belongs, AnotherOrderOfTheQuaternionIsFound) {
  const Belonging found = belonging(arm_, misread(same, [](const Eigen::Quaterniond& q) {
                                      return Eigen::Quaterniond(q.x(), q.y(), q.z(), q.w());
                                    }));
  ASSERT_FALSE(found.together);
  EXPECT_THAT(describe(found), HasSubstr("would be left"));
  EXPECT_LT(found.tried.front().mean_m, 2e-3);
}

TEST_F(Belongs, AnotherOrderOfTheQuaternionIsFoundWithGuessedGains) {
  for (const double guess : {0.3, 0.6, 2.5}) {
    arm::Arm rough = arm_;
    for (arm::Chamber& chamber : rough.segments[0].chambers) chamber.moment_gain_nm_per_pa *= guess;
    rough.segments[0].chambers[1].moment_gain_nm_per_pa *= 0.7;
    for (const bool w_first : {true, false}) {
      const std::string said =
          describe(belonging(rough, misread(same, [&](const Eigen::Quaterniond& q) {
                               return w_first ? Eigen::Quaterniond(q.x(), q.y(), q.z(), q.w())
                                              : Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y());
                             })));
      EXPECT_THAT(said, HasSubstr("quaternions in the order")) << guess << " " << w_first;
    }
  }
}

/// Gravity is what tells.
TEST_F(Belongs, AnotherUpAxisIsFoundWithAMeasuredBase) {
  Eigen::Matrix3d y_up;
  y_up << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  const Eigen::Quaterniond turn(y_up);
  const std::string said = describe(
      belonging(arm_, misread([&](const Eigen::Vector3d& p) { return Eigen::Vector3d(y_up * p); },
                              [&](const Eigen::Quaterniond& q) { return turn * q * turn.conjugate(); })));
  EXPECT_THAT(said, HasSubstr("axes 'x -z y'"));
}

TEST_F(Belongs, ALesserGainIsSaidWhereItIsThereInEachTrial) {
  // Laws so rough that the right order leaves half of the error, not a third.
  arm::Arm rough = arm_;
  rough.segments[0].chambers[0].moment_gain_nm_per_pa *= 0.3;
  rough.segments[0].chambers[1].moment_gain_nm_per_pa *= 1.7;
  const auto half_turn = misread(same, [](const Eigen::Quaterniond& q) {
    return Eigen::Quaterniond(q * Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()));
  });
  const Belonging found = belonging(rough, half_turn);
  EXPECT_TRUE(found.together);
  EXPECT_EQ(found.better_in, trials_.size());
  EXPECT_THAT(describe(found), HasSubstr("ANOTHER READING FITS EACH OF THE 6 TRIALS BETTER: with "));
  EXPECT_THAT(describe(found), HasSubstr("base.rod_in_body turned to its axes '-x -y z'"));
}

TEST_F(Belongs, OfLawsThatAreRoughInOtherWaysNothingIsSaid) {
  for (const double gain : {0.3, 0.5, 0.7, 1.5, 2.0}) {
    for (const double stiffness : {0.5, 1.0, 2.0}) {
      for (const double odd : {1.0, 0.3}) {
        arm::Arm rough = arm_;
        for (arm::Chamber& chamber : rough.segments[0].chambers) chamber.moment_gain_nm_per_pa *= gain;
        rough.segments[0].chambers[1].moment_gain_nm_per_pa *= odd;
        rough.segments[0].bending_stiffness.base_nm2 *= stiffness;
        EXPECT_EQ(describe(belonging(rough, trials_)), "") << gain << " " << stiffness << " " << odd;
      }
    }
  }
}

TEST_F(Belongs, AnotherUpAxisIsFoundWithAFixedBase) {
  arm::Arm fixed = arm_;
  fixed.base.body.reset();
  fixed.base.fixed_pose = hanging();
  Eigen::Matrix3d y_up;
  y_up << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  const Eigen::Quaterniond turn(y_up);
  const Belonging found =
      belonging(fixed, misread([&](const Eigen::Vector3d& p) { return Eigen::Vector3d(y_up * p); },
                               [&](const Eigen::Quaterniond& q) { return turn * q * turn.conjugate(); }));
  ASSERT_FALSE(found.together);
  EXPECT_THAT(found.tried.front().name, HasSubstr("axes 'x -z y'"));
  EXPECT_LT(found.tried.front().mean_m, 2e-3);
}

TEST_F(Belongs, WhatNothingExplainsIsSaidSo) {
  std::mt19937_64 random(9);
  const Belonging found = belonging(
      arm_, misread([&](const Eigen::Vector3d& p) { return Eigen::Vector3d(p + 0.3 * normal3(random)); },
                    [](const Eigen::Quaterniond& q) { return q; }));
  ASSERT_FALSE(found.together);
  EXPECT_THAT(describe(found), HasSubstr("None of them explains it"));
}

}  // namespace
}  // namespace softarm::identify::testing
