// The section `effects` of an arm file: read, written, refused.
#include <gtest/gtest.h>

#include <string>

#include "arm/arm_writer.h"
#include "arm_text.h"
#include "softarm/arm/arm_file.h"

namespace softarm {
namespace {

std::string shipped() {
  return arm::read_arm_text(std::string(SOFTARM_SOURCE_DIR) + "/config/arms/online_200mm.yaml").text;
}

std::vector<arm::EffectEntry> two_effects() {
  return {{"base_compliance", {{"compliance_rad_per_nm", 0.161890123, 0.0003}}},
          {"marker_slip", {{"x_m", 1e-3}, {"y_m", -2.5e-4}, {"z_m", 0.0}, {"body", 2.0}}}};
}

/// The message for the shipped arm with this section.
std::string refusal(const std::string& section) {
  try {
    arm::parse_effect_entries(shipped() + section, "arm.yaml");
  } catch (const arm::ArmError& error) {
    return error.what();
  }
  return "";
}

TEST(EffectEntries, AnArmWithoutHasNone) {
  EXPECT_TRUE(arm::parse_effect_entries(shipped(), "arm.yaml").empty());
}

TEST(EffectEntries, WhatIsWrittenIsRead) {
  const std::string text = shipped();
  const arm::Arm arm = arm::parse_arm(text, "arm.yaml");
  const std::string written =
      arm::update_arm_text(text, "arm.yaml", arm, two_effects(), {"found"}, "diagnose");
  EXPECT_EQ(written.rfind("# softarm diagnose: found\n", 0), 0u);
  const std::vector<arm::EffectEntry> read = arm::parse_effect_entries(written, "arm.yaml");
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[0].id, "base_compliance");
  ASSERT_EQ(read[0].numbers.size(), 1u);
  EXPECT_EQ(read[0].numbers[0].name, "compliance_rad_per_nm");
  EXPECT_DOUBLE_EQ(read[0].numbers[0].value, 0.161890123);
  ASSERT_TRUE(read[0].numbers[0].sd);
  EXPECT_DOUBLE_EQ(*read[0].numbers[0].sd, 0.0003);
  ASSERT_EQ(read[1].numbers.size(), 4u);
  EXPECT_DOUBLE_EQ(read[1].numbers[3].value, 2.0);
  EXPECT_FALSE(read[1].numbers[3].sd);
}

TEST(EffectEntries, RoundTripIsIdentical) {
  const arm::Arm arm = arm::parse_arm(shipped(), "arm.yaml");
  const std::string once =
      arm::update_arm_text(shipped(), "arm.yaml", arm, two_effects(), {"found"}, "diagnose");
  const std::string twice =
      arm::update_arm_text(once, "arm.yaml", arm::parse_arm(once, "arm.yaml"),
                           arm::parse_effect_entries(once, "arm.yaml"), {"found"}, "diagnose");
  EXPECT_EQ(once, twice);
  // Written anew over another section, it comes out the same too.
  std::vector<arm::EffectEntry> others = two_effects();
  others.pop_back();
  const std::string shorter = arm::update_arm_text(once, "arm.yaml", arm, others, {"found"}, "diagnose");
  EXPECT_EQ(arm::parse_effect_entries(shorter, "arm.yaml").size(), 1u);
  EXPECT_EQ(arm::update_arm_text(shorter, "arm.yaml", arm, two_effects(), {"found"}, "diagnose"), once);
  // And none leaves the file as it was, but for its header.
  EXPECT_EQ(arm::update_arm_text(once, "arm.yaml", arm, {}, {}, "diagnose"), shipped());
}

TEST(EffectEntries, AnIdentificationKeepsThem) {
  arm::Arm arm = arm::parse_arm(shipped(), "arm.yaml");
  const std::string extended =
      arm::update_arm_text(shipped(), "arm.yaml", arm, two_effects(), {}, "diagnose");
  arm.segments[0].bending_stiffness.base_nm2 = 0.0301;
  const std::string identified = arm::update_arm_text(extended, "arm.yaml", arm, {"constants"});
  EXPECT_EQ(arm::parse_effect_entries(identified, "arm.yaml").size(), 2u);
  EXPECT_DOUBLE_EQ(arm::parse_arm(identified, "arm.yaml").segments[0].bending_stiffness.base_nm2, 0.0301);
}

TEST(EffectEntries, ASectionThatCannotBeReadIsOneLine) {
  const struct {
    std::string section, says;
  } cases[] = {
      {"effects: 3\n", "key 'effects': value 3 is not a list"},
      {"effects:\n  - {parameters: {share: 0.1}}\n", "key 'effects[0].id': is missing"},
      {"effects:\n  - {id: creep}\n", "key 'effects[0].parameters': is missing"},
      {"effects:\n  - {id: creep, parameters: 4}\n", "key 'effects[0].parameters': value 4 is not a section"},
      {"effects:\n  - {id: creep, parameters: {share: soft}}\n",
       "key 'effects[0].parameters.share': value soft is not a finite number"},
      {"effects:\n  - {id: creep, parameters: {share: .nan}}\n", "value .nan is not a finite number"},
      {"effects:\n  - {id: creep, parameters: {share: 0.1, share: 0.2}}\n", "is given twice"},
      {"effects:\n  - {id: creep, values: {share: 0.1}}\n", "unknown key"},
      {"effects:\n  - {id: creep, parameters: {share: 0.1}, sd: {time_s: 1}}\n",
       "key 'effects[0].sd': time_s is none of the parameters"},
      {"effects:\n  - {id: creep, parameters: {share: 0.1}, sd: {share: -1}}\n", "value -1 is below 0"},
  };
  for (const auto& c : cases) {
    const std::string message = refusal(c.section);
    EXPECT_NE(message.find(c.says), std::string::npos) << c.section << "\n" << message;
    EXPECT_EQ(message.rfind("arm.yaml:", 0), 0u) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    // Programs that do not ask for effects refuse the file too.
    EXPECT_THROW(arm::parse_arm(shipped() + c.section, "arm.yaml"), arm::ArmError) << c.section;
  }
}

}  // namespace
}  // namespace softarm
