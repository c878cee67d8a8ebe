// What stands in front of arm_extended.yaml, and the verdict in it.
#include "diagnose/arm_file_header.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "arm/arm_writer.h"
#include "softarm/arm/arm_file.h"

namespace softarm::diagnose {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

NamedEffect yielding_base() {
  NamedEffect effect;
  effect.id = "base_compliance";
  effect.description = "the base turns under the load";
  effect.probability = 0.968;
  return effect;
}

Diagnosis diagnosis_that_ended(Verdict verdict) {
  Diagnosis d;
  d.verdict = verdict;
  d.baseline.held_out_mean_m = 1.2e-3;
  d.extended.held_out_mean_m = 0.31e-3;
  d.effects = {yielding_base()};
  return d;
}

TEST(ArmFileHeader, HasTrialsVerdictErrorsAndEffects) {
  const Diagnosis d = diagnosis_that_ended(Verdict::kPartlyExplained);
  EXPECT_THAT(arm_file_header(d, {{"slow", {}}, {"fast", {}}}),
              ElementsAre("constants and effects fitted together to the trials slow, fast",
                          "verdict: partly_explained; mean error on unseen trials 0.31 mm, before 1.2 mm",
                          "base_compliance (97 %): the base turns under the load"));
}

TEST(ArmFileHeader, HasTheLawThatWasLearnt) {
  Diagnosis d = diagnosis_that_ended(Verdict::kUnknown);
  d.discovered_law = DiscoveredLaw{};
  d.discovered_law->sentence = "What is left goes with chamber_2.";
  const std::vector<std::string> lines = arm_file_header(d, {{"slow", {}}});
  EXPECT_THAT(lines.at(1), StartsWith("verdict: unknown; "));
  EXPECT_EQ(lines.back(), "learned_moment: What is left goes with chamber_2.");
}

// A line that went on behind a name of a file would be read as YAML.
TEST(ArmFileHeader, StaysAComment) {
  const Diagnosis d = diagnosis_that_ended(Verdict::kExplained);
  for (const std::string& line : arm_file_header(d, {{"a\nformat: 2\r\x7f", {}}}))
    EXPECT_EQ(line.find_first_of("\n\r\x7f"), std::string::npos) << line;
}

TEST(ArmFileHeader, EveryVerdictStandsInTheHeaderAndIsRead) {
  const arm::ArmText file = arm::read_arm_text(SOFTARM_SOURCE_DIR "/config/arms/online_200mm.yaml");
  const arm::Arm arm = arm::parse_arm(file.text, file.source);
  for (const Verdict verdict : {Verdict::kConsistent, Verdict::kExplained, Verdict::kPartlyExplained,
                                Verdict::kUnknown, Verdict::kCannotTell}) {
    const std::string word = to_string(verdict);
    SCOPED_TRACE(word);
    const std::string text = arm::update_arm_text(
        file.text, file.source, arm, {{"base_compliance", {{"compliance_rad_per_nm", 0.2}}}},
        arm_file_header(diagnosis_that_ended(verdict), {{"slow", {}}}), "diagnose", word);
    EXPECT_THAT(text, StartsWith("# softarm diagnose: constants and effects fitted together"));
    EXPECT_THAT(text, HasSubstr("\n# softarm diagnose: verdict: " + word + "; mean error on unseen trials "));
    EXPECT_EQ(arm::parse_effects_verdict(text, "arm_extended.yaml"), word);
    EXPECT_EQ(arm::parse_effect_entries(text, "arm_extended.yaml").size(), 1U);
  }
}

}  // namespace
}  // namespace softarm::diagnose
