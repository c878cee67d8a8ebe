// The papers' procedure: stiffness from a pull, and the three ground truths.
#include "published/pull.h"

#include <gtest/gtest.h>

#include <cmath>

#include "identify/synthetic.h"

namespace softarm::identify {
namespace {

published::Circle circle(double length_m, double angle_rad) {
  return {length_m, angle_rad, 0.0};
}

TEST(Circles, ThroughATip) {
  for (const double angle : {1e-9, 0.3, 1.5707963, 2.8}) {
    const double length = 0.2, r = length / angle, phi = -2.1;
    const Eigen::Vector3d tip(r * (1.0 - std::cos(angle)) * std::cos(phi),
                              r * (1.0 - std::cos(angle)) * std::sin(phi), r * std::sin(angle));
    const published::Circle c = published::circle_through(tip);
    EXPECT_NEAR(c.length_m, length, 1e-9);
    EXPECT_NEAR(c.angle_rad, angle, 1e-9);
    if (angle > 1e-6) {
      EXPECT_NEAR(c.direction_rad, phi, 1e-9);
    }
  }
}

TEST(Circles, IntegralsAreThoseByHand) {
  const double length = 0.2, theta = 1.2, force = 2.0;
  // Integral of x(L) - x(s) with x = (1 - cos(theta s / L)) L / theta.
  const double arm = length * length * (std::sin(theta) - theta * std::cos(theta)) / (theta * theta);
  EXPECT_NEAR(
      published::force_turn_times_stiffness(circle(length, theta), force, published::LoadLaw::kStatics),
      force * arm, 1e-6);
  EXPECT_NEAR(
      published::force_turn_times_stiffness(circle(length, theta), force, published::LoadLaw::kPrinted),
      force * arm * std::sin(theta), 1e-6);
  EXPECT_NEAR(published::force_turn_times_stiffness(circle(length, theta), force,
                                                    published::LoadLaw::kStatics, M_PI / 3.0),
              0.5 * force * arm, 1e-6);
  // A hardly bent arm: x = k s^2 / 2, so that W / L times the integral of x (2 s - L) is W k L^3 / 12.
  const double k = 0.01;
  EXPECT_NEAR(
      published::weight_turn_times_stiffness(circle(length, k * length), 3.0, published::LoadLaw::kStatics),
      3.0 * k * std::pow(length, 3) / 12.0, 1e-9);
}

TEST(Pull, APerpendicularForceOnACantilever) {
  // Straight before: a small deflection w = F L^3 / 3 EI, whose circle has the angle 2 w / L.
  const double stiffness = 0.05, length = 0.2, force = 0.05;
  const double angle = 2.0 * force * length * length / (3.0 * stiffness);
  const auto found = published::stiffness_from_perpendicular_force(length, 0.0, angle, force);
  ASSERT_TRUE(found);
  EXPECT_NEAR(*found, stiffness, 2e-3 * stiffness);
  // Bent beforehand, pulled back.
  const auto back = published::stiffness_from_perpendicular_force(length, 1.0, 0.8, -0.4);
  ASSERT_TRUE(back);
  EXPECT_GT(*back, 0.005);
  EXPECT_FALSE(published::stiffness_from_perpendicular_force(length, 1.0, 0.8, 0.4))
      << "it moves against the force";
}

/// Static conditions of one trial: no load, load.
std::vector<trial::Trial> pairs(const arm::Arm& truth, const Eigen::Isometry3d& base, double load_kg,
                                int count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  testing::Protocol protocol;
  protocol.trials = count;
  protocol.repeats = 20;
  protocol.payloads_kg = {0.0, load_kg};
  protocol.base = base;
  protocol.draw = testing::paper_inputs;
  return testing::make_trials(truth, protocol, random);
}

TEST(Pull, ExactStaticsFindTheStiffnessOfEveryPull) {
  const arm::Arm arm = testing::pneumatic_arm();
  const auto trials = pairs(arm, testing::hanging(), 0.2, 20, 1);
  const std::vector<published::Pull> pulls = published::find_pulls(arm, trials);
  ASSERT_EQ(pulls.size(), 20u);
  int determined = 0, inside = 0;
  for (const published::Pull& pull : pulls) {
    if (!pull.stiffness_exact_nm2) continue;
    const double truth = arm::predict_segment(arm, arm.segments[0], pull.inputs)->bending_stiffness_nm2;
    ++determined;
    inside += std::abs(*pull.stiffness_exact_nm2 - truth) < 2.0 * pull.sd_exact_nm2 ? 1 : 0;
    EXPECT_NEAR(*pull.stiffness_exact_nm2, truth, 4.0 * pull.sd_exact_nm2);
    EXPECT_DOUBLE_EQ(pull.payload_after_kg, 0.2);
  }
  EXPECT_GE(determined, 15);
  EXPECT_GE(inside, determined - 3);
}

TEST(Pull, ThePrintedLawIsNotThatOfADeadForce) {
  const arm::Arm arm = testing::pneumatic_arm();
  for (const published::Pull& pull : published::find_pulls(arm, pairs(arm, testing::hanging(), 0.2, 12, 2))) {
    if (!pull.stiffness_printed_nm2 || !pull.stiffness_circles_nm2) continue;
    EXPECT_NEAR(*pull.stiffness_printed_nm2, std::sin(pull.after.angle_rad) * *pull.stiffness_circles_nm2,
                1e-9);
  }
}

TEST(Pull, NothingIsFoundWhereInputsChangeWithTheLoad) {
  const arm::Arm arm = testing::pneumatic_arm();
  auto trials = pairs(arm, testing::hanging(), 0.2, 4, 3);
  for (trial::Trial& trial : trials) {
    for (trial::Frame& frame : trial.frames) {
      if (*frame.payload_kg > 0.0) *frame.inputs[3] += 1e4;
    }
  }
  EXPECT_TRUE(published::find_pulls(arm, trials).empty());
  EXPECT_THROW(published::find_pulls(testing::shipped("two_segment"), trials), std::invalid_argument);
}

TEST(ThreeTruths, FindTheConstantsOfALightArm) {
  // Hardly any weight: circles are the shapes before the pull, and the exact stiffness is that of the law.
  arm::Arm nominal = testing::pneumatic_arm();
  nominal.segments[0].mass_per_length_kg_m = 1e-3;
  for (arm::MeasuredBody& body : nominal.bodies) body.position_sd_m = 1e-5;
  std::mt19937_64 random(4);
  const arm::Arm truth = testing::perturbed(nominal, identify::default_free(nominal), 0.2, random);
  const auto pulls = published::find_pulls(nominal, pairs(truth, testing::hanging(), 0.2, 30, 5));
  const published::ThreeTruths found =
      published::fit_three_truths(nominal, pulls, published::LoadLaw::kStatics, true);
  EXPECT_GE(found.pulls, 25u);
  for (const identify::ConstantRef& constant : identify::default_free(nominal))
    EXPECT_NEAR(identify::value_of(found.arm, constant), identify::value_of(truth, constant),
                0.03 * identify::value_of(truth, constant))
        << identify::name_of(nominal, constant);
  EXPECT_LT(found.length_rms_m, 1e-4);
  EXPECT_THROW(published::fit_three_truths(nominal, {pulls[0], pulls[1]}, published::LoadLaw::kStatics, true),
               std::invalid_argument);
}

}  // namespace
}  // namespace softarm::identify
