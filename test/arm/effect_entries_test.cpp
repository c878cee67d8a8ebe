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

/// Three numbers with a standard deviation, two of them of effects with one name.
std::vector<arm::EffectEntry> correlated() {
  return {{"tether", {{"mass_kg", 0.1, 0.02, {{1, "x_m", -0.83}, {2, "x_m", 0.995}}}}},
          {"marker_slip", {{"x_m", 1e-3, 2e-4, {{2, "x_m", -0.8}}}, {"body", 2.0}}},
          {"marker_slip", {{"x_m", 2e-3, 3e-4}, {"body", 3.0}}}};
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

TEST(EffectEntries, ACommentSaysWhatWasNotFitted) {
  const arm::Arm arm = arm::parse_arm(shipped(), "arm.yaml");
  std::vector<arm::EffectEntry> effects{{"contact", {{"place_m", 0.1, 0.01}, {"extent_m", 0.08}}}};
  effects[0].numbers[1].fitted = false;
  const std::string written = arm::update_arm_text(shipped(), "arm.yaml", arm, effects, {}, "diagnose");
  EXPECT_NE(written.find("    parameters: {place_m: 0.1, extent_m: 0.08}  # not fitted: extent_m\n"
                         "    sd: {place_m: 0.01}\n"),
            std::string::npos)
      << written.substr(written.rfind("effects:"));
  // Who reads and writes it again leaves the comment.
  EXPECT_EQ(arm::update_arm_text(written, "arm.yaml", arm, arm::parse_effect_entries(written, "arm.yaml"), {},
                                 "diagnose"),
            written);
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

void expect_same_correlations(const std::vector<arm::EffectEntry>& a,
                              const std::vector<arm::EffectEntry>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t e = 0; e < a.size(); ++e) {
    ASSERT_EQ(a[e].numbers.size(), b[e].numbers.size());
    for (std::size_t n = 0; n < a[e].numbers.size(); ++n) {
      const auto &x = a[e].numbers[n].correlations, &y = b[e].numbers[n].correlations;
      ASSERT_EQ(x.size(), y.size()) << a[e].id << "." << a[e].numbers[n].name;
      for (std::size_t k = 0; k < x.size(); ++k) {
        EXPECT_EQ(x[k].entry, y[k].entry);
        EXPECT_EQ(x[k].number, y[k].number);
        EXPECT_DOUBLE_EQ(x[k].value, y[k].value);
      }
    }
  }
}

TEST(EffectEntries, CorrelationsAreWrittenAndRead) {
  const arm::Arm arm = arm::parse_arm(shipped(), "arm.yaml");
  const std::string once =
      arm::update_arm_text(shipped(), "arm.yaml", arm, correlated(), {"found"}, "diagnose");
  EXPECT_NE(once.find("\neffects_correlations:  # of the errors of parameters with an sd\n"
                      "  - {of: tether.mass_kg, with: {marker_slip.1.x_m: -0.83, marker_slip.2.x_m: 0.995}}\n"
                      "  - {of: marker_slip.1.x_m, with: {marker_slip.2.x_m: -0.8}}\n"),
            std::string::npos)
      << once;
  expect_same_correlations(arm::parse_effect_entries(once, "arm.yaml"), correlated());
  // The whole file again, by a diagnosis and by an identification.
  EXPECT_EQ(arm::update_arm_text(once, "arm.yaml", arm, arm::parse_effect_entries(once, "arm.yaml"),
                                 {"found"}, "diagnose"),
            once);
  const std::string identified = arm::update_arm_text(once, "arm.yaml", arm);
  expect_same_correlations(arm::parse_effect_entries(identified, "arm.yaml"), correlated());
  // Other ones take their place, and none leaves nothing.
  std::vector<arm::EffectEntry> others = correlated();
  others[0].numbers[0].correlations[0].value = -0.82;
  const std::string changed = arm::update_arm_text(once, "arm.yaml", arm, others, {"found"}, "diagnose");
  expect_same_correlations(arm::parse_effect_entries(changed, "arm.yaml"), others);
  EXPECT_EQ(arm::update_arm_text(changed, "arm.yaml", arm, correlated(), {"found"}, "diagnose"), once);
  EXPECT_EQ(arm::update_arm_text(once, "arm.yaml", arm, {}, {}, "diagnose"), shipped());
  EXPECT_EQ(arm::update_arm_text(once, "arm.yaml", arm, two_effects(), {}, "diagnose")
                .find("\neffects_correlations"),
            std::string::npos);
}

TEST(EffectEntries, APersonMayWriteThemBeforeTheEffectsAndEachRowOnce) {
  const std::vector<arm::EffectEntry> read = arm::parse_effect_entries(
      shipped() +
          "effects_correlations:\n"
          "  - of: creep.time_s\n"
          "    with:\n"
          "      creep.share: 1\n"
          "effects:\n"
          "  - {id: creep, parameters: {share: 0.1, time_s: 3}, sd: {share: 0.01, time_s: 1}}\n",
      "arm.yaml");
  ASSERT_EQ(read.size(), 1u);
  EXPECT_TRUE(read[0].numbers[0].correlations.empty());
  ASSERT_EQ(read[0].numbers[1].correlations.size(), 1u);
  EXPECT_EQ(read[0].numbers[1].correlations[0].number, "share");
  EXPECT_EQ(read[0].numbers[1].correlations[0].value, 1.0);
}

TEST(EffectEntries, CorrelationsThatCannotBeAreOneLine) {
  const std::string effects =
      "effects:\n"
      "  - {id: creep, parameters: {share: 0.1, time_s: 3, decades: 1}, sd: {share: 0.01, time_s: 1}}\n"
      "  - {id: tip_mass, parameters: {mass_kg: 0.1}, sd: {mass_kg: 0.01}}\n"
      "  - {id: base_tilt, parameters: {towards_x_rad: 0.1, towards_y_rad: 0}, sd: {towards_x_rad: 0.01, "
      "towards_y_rad: 0}}\n"
      "effects_correlations:\n";
  const struct {
    std::string rows, says;
  } cases[] = {
      {"  - {of: creep.share, with: {creep.time_s: 1.2}}\n",
       "key 'effects_correlations': creep.share with creep.time_s: value 1.2 is outside the allowed range "
       "[-1, "
       "1]"},
      {"  - {of: creep.share, with: {creep.time_s: .nan}}\n",
       "key 'effects_correlations[0].with.creep.time_s': value .nan is not a finite number"},
      {"  - {of: crep.share, with: {creep.time_s: 0.2}}\n",
       "key 'effects_correlations[0].of': crep.share is no parameter with a standard deviation (sd) of these "
       "effects; did you mean 'creep.share'?"},
      {"  - {of: creep.share, with: {creep.decades: 0.2}}\n",
       "key 'effects_correlations[0].with': creep.decades is no parameter with a standard deviation"},
      {"  - {of: creep.share, with: {base_tilt.towards_y_rad: 0.2}}\n",
       "key 'effects_correlations[0].with': base_tilt.towards_y_rad is no parameter with a standard "
       "deviation"},
      {"  - {of: creep.share, with: {creep.2.time_s: 0.2}}\n", "did you mean 'creep.time_s'?"},
      {"  - {of: creep.share, with: {creep.share: 0.2}}\n",
       "key 'effects_correlations': creep.share is correlated with itself"},
      {"  - {of: creep.share, with: {creep.time_s: 0.2}}\n  - {of: creep.time_s, with: {creep.share: 0.2}}\n",
       "key 'effects_correlations': creep.share with creep.time_s is given twice"},
      {"  - {of: creep.share, with: {creep.time_s: 0.2, creep.time_s: 0.3}}\n", "is given twice"},
      {"  - {of: creep.share}\n", "key 'effects_correlations[0].with': is missing"},
      {"  - {of: creep.share, with: 0.2}\n", "value 0.2 is not a section of names"},
      {"  - {between: creep.share, with: {creep.time_s: 0.2}}\n", "unknown key"},
      {"  - {of: creep.share, with: {creep.time_s: 0.9, tip_mass.mass_kg: 0.9}}\n",
       "key 'effects_correlations': creep.share, creep.time_s, tip_mass.mass_kg cannot be correlated so all "
       "at "
       "once"},
  };
  for (const auto& c : cases) {
    const std::string message = refusal(effects + c.rows);
    EXPECT_NE(message.find(c.says), std::string::npos) << c.rows << "\n" << message;
    EXPECT_EQ(message.rfind("arm.yaml:", 0), 0u) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_THROW(arm::parse_arm(shipped() + effects + c.rows, "arm.yaml"), arm::ArmError) << c.rows;
  }
  EXPECT_EQ(refusal(effects + "  - {of: creep.share, with: {creep.time_s: 0.9, tip_mass.mass_kg: 0.9}}\n"
                              "  - {of: creep.time_s, with: {tip_mass.mass_kg: 0.7}}\n"),
            "");
}

TEST(EffectEntries, CorrelationsOfAProgramAreCheckedBeforeTheyAreWritten) {
  const arm::Arm arm = arm::parse_arm(shipped(), "arm.yaml");
  const auto refused = [&](const arm::EffectCorrelation& wrong) {
    std::vector<arm::EffectEntry> entries = correlated();
    entries[0].numbers[0].correlations = {wrong};
    EXPECT_THROW(arm::update_arm_text(shipped(), "arm.yaml", arm, entries, {}, "diagnose"), arm::ArmError)
        << wrong.number;
  };
  refused({7, "x_m", 0.1});
  refused({1, "y_m", 0.1});
  refused({1, "body", 0.1});
  refused({1, "x_m", 1.1});
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
