// `softarm import --guess`: the draft of a layout, from the command line and from recordings of real arms.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "program.h"
#include "trial/csv_layout.h"

namespace softarm {
namespace {

using ::testing::HasSubstr;

std::string labels(const trial::CsvBody& body) {
  std::string text;
  for (const trial::CsvColumn& c : body.position) text += c.label + " ";
  if (body.orientation) {
    for (const trial::CsvColumn& c : *body.orientation) text += c.label + " ";
  }
  return text;
}

/// Columns of all inputs, in their order.
std::string inputs(const trial::CsvLayout& layout) {
  std::string text;
  for (const trial::CsvPressure& p : layout.pressures) text += p.topic + " " + p.column.label + "\n";
  for (const trial::CsvScalar& s : layout.scalars) {
    if (!s.column.in_inputs) text += s.topic + " " + s.column.label + "\n";
  }
  return text;
}

trial::CsvLayout shipped(const std::string& name) {
  const std::string path = SOFTARM_SOURCE_DIR "/config/layouts/" + name + ".yaml";
  return trial::parse_csv_layout(text_of(path), path);
}

/// The draft of a recording, with what it leaves open.
trial::CsvLayout drafted(const TestFolder& dir, const std::string& recording,
                         const std::vector<std::pair<std::string, std::string>>& fill) {
  const Outcome o = softarm_program("import --guess " + recording + " --out " + dir / "layout.yaml");
  EXPECT_EQ(o.status, 0) << o.err;
  EXPECT_THAT(o.out, HasSubstr(fill.empty()       ? "nothing is left to fill in"
                               : fill.size() == 1 ? "1 value to fill in"
                                                  : std::to_string(fill.size()) + " values to fill in"));
  std::string text = text_of(dir / "layout.yaml");
  for (const auto& [blank, value] : fill) {
    const std::size_t at = text.find(blank + "\n");
    EXPECT_NE(at, std::string::npos) << blank << " is not open in\n" << text;
    if (at != std::string::npos) text.insert(at + blank.size(), " " + value);
  }
  return trial::parse_csv_layout(text, "draft");
}

TEST(ImportGuess, OfThePouchArmAreTheColumnsOfItsLayouts) {
  if (recordings().empty()) GTEST_SKIP() << "the recordings of the pouch arm are absent (SOFTARM_DATA)";
  struct Guess {
    std::string file, layout;
    bool open;               ///< the unit of the pressures
    std::size_t first_body;  ///< of the draft, that is the layout's first: the locked segment has a body more
  };
  for (const Guess& c :
       std::vector<Guess>{{"two_segment/no_load/data_collect_1", "pouch_arm", true, 0},
                          {"one_segment/no_load/data_collect_1", "pouch_arm_one_segment", false, 1},
                          {"one_segment/load_400g/data_collect_1", "pouch_arm_one_segment", false, 1},
                          {"steps/set_2/data_collect_1", "pouch_arm_steps", true, 0}}) {
    SCOPED_TRACE(c.file);
    const Outcome o = softarm_program("import --guess " + recordings() + "/pouch_arm/" + c.file + ".txt");
    ASSERT_EQ(o.status, 0) << o.err;
    std::string text = o.out;
    if (c.open) {
      // 0 to 11 are psi or kPa: that the file does not tell.
      const std::size_t pressures = text.find("\npressures:\n"), open = text.find("  unit:\n", pressures);
      ASSERT_NE(open, std::string::npos) << text;
      text.insert(open + 7, " psi");
    }
    const trial::CsvLayout draft = trial::parse_csv_layout(text, "draft"), known = shipped(c.layout);
    EXPECT_EQ(inputs(draft), inputs(known)) << text;
    EXPECT_EQ(draft.pressures.at(0).unit, "psi");
    EXPECT_TRUE(draft.pressures.at(0).gauge);
    EXPECT_EQ(draft.up, known.up);
    EXPECT_EQ(draft.position_scale_to_m, known.position_scale_to_m);
    EXPECT_EQ(draft.time_scale_to_s, known.time_scale_to_s);
    ASSERT_EQ(draft.bodies.size(), known.bodies.size() + c.first_body) << text;
    for (std::size_t b = 0; b < known.bodies.size(); ++b) {
      const trial::CsvBody& body = draft.bodies[b + c.first_body];
      if (known.bodies[b].fixed_orientation_xyzw) continue;  // that a tracker mistakes it a guess cannot know
      EXPECT_EQ(labels(body), labels(known.bodies[b])) << b;
    }
  }
}

TEST(ImportGuess, OfVentedSensorsItDoesNotSayAngles) {
  if (recordings().empty()) GTEST_SKIP() << "the recordings of the pouch arm are absent (SOFTARM_DATA)";
  // Six sensors of pressure that show 0 to within 0.3 psi, some of it below.
  const Outcome o =
      softarm_program("import --guess " + recordings() + "/pouch_arm/steps/set_1/data_collect_1.txt");
  ASSERT_EQ(o.status, 0) << o.err;
  EXPECT_THAT(o.out, HasSubstr("\nFILL_IN:\n"));
  EXPECT_THAT(o.out, ::testing::Not(HasSubstr("\nangles:")));
}

TEST(ImportGuess, OfTheTrunkAreTheColumnsOfItsLayouts) {
  if (recordings().empty() || !std::filesystem::exists(recordings() + "/tendon_trunk"))
    GTEST_SKIP() << "the recordings of the tendon trunk are absent (SOFTARM_DATA)";
  const std::string trunk = recordings() + "/tendon_trunk/observations_";
  struct Guess {
    std::string file, layout;
    std::vector<std::pair<std::string, std::string>> fill;
  };
  for (const Guess& c :
       std::vector<Guess>{{"controlled_1_100g", "tendon_trunk_controlled", {{"period_s:", "0.01"}}},
                          {"zeros_0g", "tendon_trunk_zeros", {{"period_s:", "0.01"}, {"\n  unit:", "deg"}}},
                          {"manual_decay_200g", "tendon_trunk_decay", {{"period_s:", "0.01"}}}}) {
    SCOPED_TRACE(c.file);
    const TestFolder dir;
    const trial::CsvLayout draft = drafted(dir, trunk + c.file + ".csv", c.fill), known = shipped(c.layout);
    EXPECT_EQ(inputs(draft), inputs(known));
    EXPECT_EQ(draft.up, trial::UpAxis::kY);
    EXPECT_EQ(draft.time_scale_to_s, known.time_scale_to_s);
    EXPECT_EQ(draft.trial_column.has_value(), known.trial_column.has_value());
    ASSERT_EQ(draft.bodies.size(), 3u);
    for (std::size_t b = 0; b < 3; ++b) EXPECT_EQ(labels(draft.bodies[b]), labels(known.bodies[b]));
  }
}

TEST(ImportGuess, BadUsageIsOneLineAndNoFile) {
  const TestFolder dir;
  const std::string text = dir.write("words.txt", "nothing but words\n");
  for (const auto& [arguments, why] : std::vector<std::pair<std::string, std::string>>{
           {"--guess " + dir / "absent.csv", "no such file"},
           {"--guess " + text + " --out " + dir / "layout.yaml", "no rows of numbers"},
           {"--guess " + text + " layout.yaml", "takes one recording, and no layout"},
           {"", "LAYOUT is missing; softarm import --guess FILE drafts one"},
           {"pouch_arm", "FILE is missing"},
           {"pouch_arm " + text, "--out is missing"}}) {
    const Outcome o = softarm_program("import " + arguments);
    EXPECT_NE(o.status, 0) << arguments;
    EXPECT_THAT(o.err, HasSubstr(why));
  }
  EXPECT_FALSE(std::filesystem::exists(dir / "layout.yaml"));
}

}  // namespace
}  // namespace softarm
