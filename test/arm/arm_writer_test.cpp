// Constants written back into an arm's text.
#include "arm/arm_writer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "arm_text.h"
#include "softarm/identify/identify.h"

namespace softarm {
namespace {

std::string shipped_text(const std::string& name) {
  std::ifstream file(std::string(SOFTARM_SOURCE_DIR) + "/config/arms/" + name + ".yaml");
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

/// Each constant 3 % larger (rest curvatures from zero), and another prior.
arm::Arm changed(arm::Arm arm) {
  for (const identify::ConstantRef& constant : identify::constants_of(arm)) {
    const double value = identify::value_of(arm, constant);
    const arm::Range range = identify::allowed_range(arm, constant);
    const double other = value == 0.0 ? 0.01 * range.high : 1.03 * value;
    identify::set_value(arm, constant, std::min(other, range.high));
  }
  arm.estimator.prior.enabled = true;
  arm.estimator.prior.moment_sd_nm = 0.0123;
  arm.estimator.prior.moment_sd_rel = 0.0456;
  arm.estimator.prior.bending_stiffness_sd_rel = 0.0789;
  arm.estimator.prior.length_sd_m = 0.00234;
  arm.estimator.prior.moment_jitter_sd_nm = 0.00345;
  arm.estimator.prior.length_jitter_sd_m = 0.000456;
  return arm;
}

void expect_same(const arm::Arm& a, const arm::Arm& b) {
  for (const identify::ConstantRef& constant : identify::constants_of(b)) {
    const double value = identify::value_of(b, constant);
    EXPECT_NEAR(identify::value_of(a, constant), value, 1e-8 * std::abs(value))
        << identify::name_of(b, constant);
  }
  for (std::size_t i = 0; i < b.bodies.size(); ++i)
    EXPECT_NEAR(a.bodies[i].arclength_m, b.bodies[i].arclength_m, 1e-9);
  for (std::size_t i = 0; i < b.segments.size(); ++i)
    EXPECT_NEAR(a.segments[i].mass_per_length_kg_m, b.segments[i].mass_per_length_kg_m, 1e-8);
  EXPECT_NEAR(a.payload.arclength_m, b.payload.arclength_m, 1e-9);
  EXPECT_EQ(a.estimator.prior.enabled, b.estimator.prior.enabled);
  EXPECT_NEAR(a.estimator.prior.moment_sd_rel, b.estimator.prior.moment_sd_rel, 1e-9);
  EXPECT_NEAR(a.estimator.prior.length_jitter_sd_m, b.estimator.prior.length_jitter_sd_m, 1e-12);
}

std::vector<std::string> comments(const std::string& text) {
  std::vector<std::string> list;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t at = line.find('#');
    if (at != std::string::npos) list.push_back(line.substr(at));
  }
  return list;
}

class ArmWriter : public ::testing::TestWithParam<const char*> {};

TEST_P(ArmWriter, EveryConstantOfShippedArmsComesBackAndCommentsStay) {
  const std::string text = shipped_text(GetParam());
  const arm::Arm arm = changed(arm::parse_arm(text, "arm.yaml"));
  const std::string written = arm::update_arm_text(text, "arm.yaml", arm);
  expect_same(arm::parse_arm(written, "written.yaml"), arm);
  EXPECT_EQ(comments(written), comments(text));
  EXPECT_EQ(arm::update_arm_text(written, "arm.yaml", arm), written) << "nothing is left to change";
}

INSTANTIATE_TEST_SUITE_P(Shipped, ArmWriter,
                         ::testing::Values("online_200mm", "semi_physical_200mm", "single_chamber_85mm",
                                           "hybrid_85mm", "cable_235mm", "two_segment"));

TEST(ArmWriterText, NothingChangesWhereNothingDiffers) {
  for (const char* name : {"online_200mm", "cable_235mm"}) {
    const std::string text = shipped_text(name);
    EXPECT_EQ(arm::update_arm_text(text, name, arm::parse_arm(text, name)), text);
  }
}

TEST(ArmWriterText, AddsKeysToFlowAndBlockMapsAndToMapsThatAreMissing) {
  for (const std::string& text :
       {kSmallArm, edited("estimator: {method: full_points}\n", ""),
        edited("estimator: {method: full_points}\n", "estimator: {}\n"),
        edited("estimator: {method: full_points}\n", "estimator:\n  method: full_points  # see the manual\n"),
        edited("estimator: {method: full_points}", "estimator: {prior: {enabled: false}}")}) {
    SCOPED_TRACE(text);
    const arm::Arm arm = changed(arm::parse_arm(text, "arm.yaml"));
    expect_same(arm::parse_arm(arm::update_arm_text(text, "arm.yaml", arm), "written.yaml"), arm);
  }
}

TEST(ArmWriterText, AddsALagThatTheFileDidNotState) {
  arm::Arm arm = arm::parse_arm(kSmallArm, "arm.yaml");
  arm.segments[0].wall.lag_s = arm::Wall::kUsualLag_s;
  EXPECT_EQ(arm::update_arm_text(kSmallArm, "arm.yaml", arm), kSmallArm) << "as it is without";
  arm.segments[0].wall.lag_s = 0.06;
  const std::string written = arm::update_arm_text(kSmallArm, "arm.yaml", arm);
  EXPECT_EQ(arm::parse_arm(written, "written.yaml").segments[0].wall.lag_s, 0.06) << written;
}

TEST(ArmWriterText, KeepsItsPlaceBehindOtherAlphabetsAndLineEnds) {
  std::string text = "# Arm für Übungen – φ = 0°\n" + kSmallArm;
  const arm::Arm arm = changed(arm::parse_arm(text, "arm.yaml"));
  const std::string written = arm::update_arm_text(text, "arm.yaml", arm);
  expect_same(arm::parse_arm(written, "written.yaml"), arm);
  EXPECT_EQ(written.rfind("# Arm für Übungen – φ = 0°\n", 0), 0u);
  std::string dos;
  for (const char c : text) dos += c == '\n' ? std::string("\r\n") : std::string(1, c);
  expect_same(arm::parse_arm(arm::update_arm_text(dos, "arm.yaml", arm), "written.yaml"), arm);
}

TEST(ArmWriterText, TheHeaderIsReplacedNotRepeated) {
  const arm::Arm arm = arm::parse_arm(kSmallArm, "arm.yaml");
  const std::string once = arm::update_arm_text(kSmallArm, "arm.yaml", arm, {"from a.bag", "error 1 mm"});
  EXPECT_EQ(once, "# softarm identify: from a.bag\n# softarm identify: error 1 mm\n" + kSmallArm);
  EXPECT_EQ(arm::update_arm_text(once, "arm.yaml", arm, {"from b.bag"}),
            "# softarm identify: from b.bag\n" + kSmallArm);
}

TEST(ArmWriterText, TheVerdictStandsWithTheEffectsThatItIsOf) {
  const arm::Arm arm = arm::parse_arm(kSmallArm, "arm.yaml");
  const std::vector<arm::EffectEntry> effects{{"base_compliance", {{"compliance_rad_per_nm", 0.2}}}};
  const auto verdict_of = [](const std::string& text) {
    return arm::parse_effects_verdict(text, "arm.yaml");
  };
  EXPECT_FALSE(verdict_of(kSmallArm).has_value());
  const std::string unknown =
      arm::update_arm_text(kSmallArm, "arm.yaml", arm, effects, {}, "diagnose", "unknown");
  EXPECT_EQ(verdict_of(unknown), "unknown");
  EXPECT_EQ(verdict_of(arm::update_arm_text(unknown, "arm.yaml", arm)), "unknown") << "identify keeps it";
  const std::string explained =
      arm::update_arm_text(unknown, "arm.yaml", arm, effects, {}, "diagnose", "explained");
  EXPECT_EQ(verdict_of(explained), "explained");
  EXPECT_EQ(explained.find("unknown"), std::string::npos) << explained;
  EXPECT_EQ(arm::parse_effect_entries(explained, "arm.yaml").size(), 1u);
  const std::string none = arm::update_arm_text(unknown, "arm.yaml", arm, {}, {}, "diagnose", "consistent");
  EXPECT_FALSE(verdict_of(none).has_value()) << none;
  EXPECT_THROW(arm::parse_arm(kSmallArm + "effects_verdict: perhaps\n", "arm.yaml"), arm::ArmError);
}

TEST(ArmWriterText, RefusesAliasesQuotesAndOtherArms) {
  const auto refused = [](const std::string& text, const arm::Arm& arm) {
    try {
      arm::update_arm_text(text, "arm.yaml", arm);
    } catch (const arm::ArmError& error) {
      const std::string message = error.what();
      EXPECT_EQ(message.rfind("arm.yaml:", 0), 0u) << message;
      return true;
    }
    return false;
  };
  arm::Arm arm = arm::parse_arm(kSmallArm, "arm.yaml");
  arm.segments[0].bending_stiffness.base_nm2 = 0.05;
  // The same number twice: the stiffness would change the other with it.
  const std::string alias = edited(edited("diameter_m: 0.04", "diameter_m: &d 0.04"),
                                   "mass_per_length_kg_m: 1.0", "mass_per_length_kg_m: *d");
  arm::Arm heavier =
      arm::parse_arm(edited("mass_per_length_kg_m: 1.0", "mass_per_length_kg_m: 0.04"), "arm.yaml");
  heavier.segments[0].mass_per_length_kg_m = 0.05;
  EXPECT_FALSE(refused(kSmallArm, arm));
  EXPECT_TRUE(refused(edited("base_nm2: 0.03", "base_nm2: \"0.03\""), arm));
  arm::Arm two = arm;
  two.segments.push_back(two.segments[0]);
  EXPECT_TRUE(refused(kSmallArm, two));
  EXPECT_TRUE(refused(alias, heavier));
}

}  // namespace
}  // namespace softarm
