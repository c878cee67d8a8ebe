// `softarm new-arm`: whatever is asked for, the loaders, the estimator and `softarm check` take what it
// writes.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "csv_rows.h"
#include "program.h"
#include "softarm/arm/arm_file.h"
#include "softarm/estimate/estimator.h"
#include "trial/csv_layout.h"

namespace softarm {
namespace {

using ::testing::HasSubstr;

constexpr char kSizes[] = " --segments 1 --length 0.2 --mass 0.15 --diameter 0.04 --bodies 3 --out ";

/// Chambers, tendons, cables and a central chamber in every combination.
std::vector<std::string> all_kinds() {
  std::vector<std::string> kinds;
  for (int bits = 1; bits < 16; ++bits) {
    std::string kind;
    int bit = 1;
    for (const char* one : {"chambers", "tendons", "cables", "central"}) {
      if (bits & bit) kind += (kind.empty() ? "" : "+") + std::string(one);
      bit *= 2;
    }
    kinds.push_back(kind);
  }
  return kinds;
}

/// The arm hangs straight and its inputs go up and down, in the columns of its layout.
std::string recording(const arm::Arm& arm, const trial::CsvLayout& layout) {
  std::mt19937 random(4);
  std::normal_distribution<double> noise(0.0, 2e-4);
  std::string text;
  for (int k = 0; k < 600; ++k) {
    const double t = 0.02 * k, drive = t < 2.0 || t > 10.0 ? 0.0 : 1.0 - std::cos(M_PI * (t - 2.0) / 4.0);
    text += fmt::format("{:.2f}", t);
    const auto pose = [&](double s) {
      // z down along the arm: half a turn about x.
      text += fmt::format(",{:.6f},{:.6f},{:.6f},1,0,0,0", noise(random), noise(random), -s + noise(random));
    };
    if (layout.bodies.size() > arm.bodies.size()) pose(0.0);
    for (const arm::MeasuredBody& body : arm.bodies) pose(body.arclength_m);
    for (std::size_t i = 0; i < layout.pressures.size(); ++i) text += fmt::format(",{:.5f}", 10.0 * drive);
    for (std::size_t i = 0; i < layout.scalars.size(); ++i) text += fmt::format(",{:.5f}", 0.2 * drive);
    text += "\n";
  }
  return text;
}

struct Written {
  arm::Arm arm;
  trial::CsvLayout layout;
};

Written written(const TestFolder& dir) {
  return {arm::load_arm_file(dir / "a.yaml"),
          trial::parse_csv_layout(text_of(dir / "a_layout.yaml"), "layout")};
}

TEST(NewArm, EveryCombinationOfKindsLoadsIsCheckedAndEstimated) {
  for (const std::string& kind : all_kinds()) {
    SCOPED_TRACE(kind);
    const TestFolder dir;
    const Outcome o = softarm_program("new-arm --kind " + kind + kSizes + dir / "a.yaml" +
                                      (kind == "central" ? "" : " --actuators 2 --angles 0,90"));
    ASSERT_EQ(o.status, 0) << o.err;
    EXPECT_THAT(o.out, HasSubstr("1 segment, 0.2 m, 3 bodies"));
    const Written w = written(dir);
    const arm::Segment& s = w.arm.segments.at(0);
    const bool chambers = kind.find("chambers") != std::string::npos,
               tendons = kind.find("tendons") != std::string::npos,
               cables = kind.find("cables") != std::string::npos,
               central = kind.find("central") != std::string::npos;
    EXPECT_EQ(s.chambers.size(), chambers ? 2u : 0u);
    EXPECT_EQ(s.tendons.size(), tendons ? 2u : 0u);
    EXPECT_EQ(s.cables.size(), cables ? 2u : 0u);
    EXPECT_EQ(s.central_chamber.has_value(), central);
    EXPECT_NEAR(s.mass_per_length_kg_m * s.length_m, 0.15, 1e-4);
    EXPECT_EQ(w.layout.pressures.size(), (chambers ? 2u : 0u) + (central ? 1u : 0u));
    EXPECT_EQ(w.layout.scalars.size(), (tendons ? 2u : 0u) + (cables ? 2u : 0u));
    EXPECT_NO_THROW(estimate::Estimator{w.arm});

    dir.write("trial.csv", recording(w.arm, w.layout));
    const Outcome imported = softarm_program("import " + dir / "a_layout.yaml" + " " + dir / "trial.csv" +
                                             " --out " + dir / "trial.bag");
    ASSERT_EQ(imported.status, 0) << imported.err;
    const Outcome checked = softarm_program("check --arm " + dir / "a.yaml" + " " + dir / "trial.bag");
    EXPECT_EQ(checked.status, 0) << checked.out << checked.err;
    const Outcome estimated = softarm_program("estimate --arm " + dir / "a.yaml" + " " + dir / "trial.bag" +
                                              " --out " + dir / "out");
    ASSERT_EQ(estimated.status, 0) << estimated.err;
    const std::vector<Row> rows = csv_rows(dir / "out/trial/estimates.csv");
    ASSERT_GT(rows.size(), 500u);
    EXPECT_GT(std::count_if(rows.begin(), rows.end(), [](const Row& r) { return r.at("status") == "ok"; }),
              500);
  }
}

/// Short, slow trials of arms with many inputs: as `softarm simulate ARM.yaml` records them, with nothing
/// hidden.
TEST(NewArm, CleanTrialsOfItHaveNothingWrong) {
  const std::string one = " --segments 1 --length 0.2 --mass 0.2 --diameter 0.04 --bodies 4 ",
                    two =
                        " --segments 2 --length 0.15,0.12 --mass 0.12,0.08 --diameter 0.04,0.035"
                        " --bodies mid:0.075,end:0.15,mid2:0.21,tip:0.27 ";
  struct Clean {
    std::string arm;
    int seed;
  };
  for (const Clean& trial : std::vector<Clean>{
           {"--kind chambers --actuators 3" + one, 2},
           {"--kind tendons --actuators 3" + one, 1},
           {"--kind cables --actuators 2 --base standing" + one, 1},
           {"--kind chambers+central --actuators 3 --base hanging" + one, 2},
           {"--kind chambers --actuators 3" + two, 1},
           {"--kind cables --actuators 4" + two, 2},
           {"--kind chambers,tendons+central --actuators 3,2 --angles 0,120,240/0,90 --base hanging" + two,
            1}}) {
    SCOPED_TRACE(trial.arm);
    const TestFolder dir;
    ASSERT_EQ(softarm_program("new-arm " + trial.arm + "--out " + dir / "a.yaml").status, 0);
    ASSERT_EQ(softarm_program("simulate " + dir / "a.yaml" + " --seconds 30 --seed " +
                              std::to_string(trial.seed) + " --out " + dir / "a.bag")
                  .status,
              0);
    const Outcome checked = softarm_program("check --quiet --arm " + dir / "a.yaml" + " " + dir / "a.bag");
    EXPECT_THAT(checked.out, HasSubstr("nothing wrong was found"));
  }
}

/// What moves there quickly is the payload that is hung on, not the servo.
TEST(NewArm, NorHasATrialOfASlowCableUnderPayloads) {
  const TestFolder dir;
  ASSERT_EQ(softarm_program("simulate cable_235mm --seconds 30 --seed 1 --out " + dir / "a.bag").status, 0);
  const Outcome checked = softarm_program("check --quiet --arm cable_235mm " + dir / "a.bag");
  EXPECT_THAT(checked.out, HasSubstr("nothing wrong was found"));
}

TEST(NewArm, SegmentsOfTheirOwnKindsSizesAndAngles) {
  const TestFolder dir;
  const Outcome o = softarm_program(
      "new-arm --kind chambers,tendons+central,cables --segments 3 --length 0.12,0.1,0.08 --mass 0.1"
      " --diameter 0.04,0.03,0.02 --actuators 3,2,1 --angles 0,120,-120/0,90/45 --stiffness 0.03"
      " --bodies mid:0.12,end:0.22,top:tip --base hanging --layout " +
      dir / "columns.yaml" + " --out " + dir / "a.yaml");
  ASSERT_EQ(o.status, 0) << o.err;
  const arm::Arm arm = arm::load_arm_file(dir / "a.yaml");
  EXPECT_NO_THROW(estimate::Estimator{arm});
  EXPECT_FALSE(arm.base.body);
  EXPECT_LT(arm.base.fixed_pose.linear()(2, 2), -0.999) << "it hangs";
  ASSERT_EQ(arm.segments.size(), 3u);
  EXPECT_NEAR(arm.segments[0].chambers.at(2).bending_direction_rad, -2.0 * M_PI / 3.0, 1e-9);
  EXPECT_NEAR(arm.segments[1].tendons.at(1).bending_direction_rad, M_PI / 2.0, 1e-9);
  EXPECT_EQ(arm.segments[2].cables.size(), 1u);
  EXPECT_DOUBLE_EQ(arm.segments[2].bending_stiffness.base_nm2, 0.03);
  EXPECT_EQ(arm.bodies.at(1).name, "end");
  EXPECT_NEAR(arm.bodies.at(2).arclength_m, 0.3, 1e-12);
  const trial::CsvLayout layout = trial::parse_csv_layout(text_of(dir / "columns.yaml"), "columns");
  EXPECT_EQ(layout.bodies.size(), 3u);
  EXPECT_EQ(layout.pressures.size(), 4u);
  EXPECT_EQ(layout.scalars.size(), 3u);
}

TEST(NewArm, EveryKeyItWritesIsExplainedOnceAndGuessesAreCalledSo) {
  const TestFolder dir;
  ASSERT_EQ(
      softarm_program(std::string("new-arm --kind chambers --actuators 3") + kSizes + dir / "a.yaml").status,
      0);
  const std::string text = text_of(dir / "a.yaml");
  for (const char* comment : {"backbone length at zero input; [0.005, 10] m",
                              "A GUESS, to be identified: c: bending moment per gauge pressure",
                              "A GUESS, to be identified: b1: EI at zero input",
                              "azimuth towards which the arm bends when the chamber is inflated"}) {
    const std::size_t first = text.find(comment);
    ASSERT_NE(first, std::string::npos) << comment << "\n" << text;
    EXPECT_EQ(text.find(comment, first + 1), std::string::npos) << comment;
  }
}

TEST(NewArm, WhatIsMissingOrImpossibleIsOneLineAndNoFile) {
  const TestFolder dir;
  const std::string out = dir / "a.yaml",
                    rest = " --length 0.2 --mass 0.15 --diameter 0.04 --bodies 3 --out " + out;
  for (const auto& [arguments, why] : std::vector<std::pair<std::string, std::string>>{
           {"", "--kind is missing"},
           {"--kind chambers", "--segments is missing"},
           {"--kind chambers --segments 1" + rest, "--actuators is missing"},
           {"--kind central --segments 1 --length 0.2 --mass 0.1 --diameter 0.04 --out " + out,
            "--bodies is missing"},
           {"--kind pistons --segments 1 --actuators 3" + rest,
            "--kind pistons: must be chambers, tendons, cables or central"},
           {"--kind chambers,tendons --segments 3 --actuators 3" + rest, "must be one value, or 3"},
           {"--kind chambers --segments 1 --actuators 3 --angles 0,90" + rest, "must be 3, one for each"},
           {"--kind chambers --segments 1.5 --actuators 3" + rest, "must be a whole number"},
           {"--kind chambers --segments 1 --actuators 3 --length 200 --mass 1 --diameter 0.04 --bodies 3 "
            "--out " +
                out,
            "--length 200: must be a number from 0.005 to 10"},
           {"--kind chambers --segments 1 --actuators 3 --length 0.2 --mass 0.1 --diameter 0.04 --bodies "
            "a:0.1,b:0.05 --out " +
                out,
            "list bodies from base to tip"},
           {"--kind chambers --segments 1 --actuators 3 --length 0.2 --mass 0.1 --diameter 0.04 --bodies 'a "
            "b:0.1' --out " +
                out,
            "name"}}) {
    const Outcome o = softarm_program("new-arm " + arguments);
    EXPECT_NE(o.status, 0) << arguments;
    EXPECT_THAT(o.err, HasSubstr(why)) << arguments;
    EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
  }
  EXPECT_EQ(dir.entries(), 0u);
}

/// What a terminal shows where these lines are typed; then the input ends.
std::string on_a_terminal(const TestFolder& dir, const std::string& arguments, const std::string& answers,
                          int* status) {
  dir.write("answers", answers);
  const std::string command = "/usr/bin/script -qec '" SOFTARM_PROGRAM_DIR "/softarm " + arguments +
                              "' /dev/null <" + dir / "answers" + " >" + dir / "screen" + " 2>&1";
  *status = std::system(command.c_str());
  return text_of(dir / "screen");
}

TEST(NewArm, AnAnswerThatCannotBeIsRefusedAtOnceAndAskedForAgain) {
  if (!std::filesystem::exists("/usr/bin/script"))
    GTEST_SKIP() << "script(1), which makes a terminal, is absent";
  const TestFolder dir;
  struct Answer {
    std::string wrong, why, right;
  };
  const std::vector<Answer> answers{
      {"pistons", "kind pistons: must be chambers, tendons, cables or central", "chambers,central"},
      {"3", "kind chambers,central: must be one value, or 3", "2"},
      {"200", "length 200: must be a number from 0.005 to 10 m", "0.2"},
      {"30", "mass 30: must be a number from 0 to 10 kg", "0.15"},
      {"4 cm", "diameter 4 cm: must be a number from 0.0005 to 1 m", "0.04"},
      {"1.5", "actuators 1.5: must be a whole number", "3"},
      {"a:0.2,b:0.1", "bodies b:0.1: list bodies from base to tip", "a:0.2,b:tip"},
      {"0,90", "angles 0,90: must be 3, one for each of --actuators", "0,90,180"},
      {"a", "base a: is a body on the arm already", ""},
      {"0", "stiffness 0: must be a number from 1e-06 to 500 N m^2", ""},
      {dir / "none/a.yaml", "does not exist", dir / "a.yaml"},
      {dir / "a.yaml", "is already the arm file", ""}};
  std::string typed;
  for (const Answer& a : answers) typed += a.wrong + "\n" + a.right + "\n";
  int status = -1;
  const std::string screen = on_a_terminal(dir, "new-arm", typed, &status);
  EXPECT_EQ(status, 0) << screen;
  for (const Answer& a : answers) EXPECT_THAT(screen, HasSubstr(a.why));
  const Written w = written(dir);
  EXPECT_EQ(w.arm.segments.size(), 2u);
  EXPECT_EQ(w.arm.segments[0].chambers.size(), 3u);
}

TEST(NewArm, WhereTheAnswersEndOneLineSaysWhatIsMissing) {
  if (!std::filesystem::exists("/usr/bin/script"))
    GTEST_SKIP() << "script(1), which makes a terminal, is absent";
  const TestFolder dir;
  int status = -1;
  const std::string screen = on_a_terminal(dir, "new-arm --kind chambers", "2\nmany\n", &status);
  EXPECT_NE(status, 0);
  EXPECT_THAT(screen, HasSubstr("\nsoftarm: --length is missing: length of each segment"));
  EXPECT_EQ(dir.entries(), 2u) << "what was typed, and the screen";
}

TEST(NewArm, WhatIsWithinTheRangesThatItSaysLoads) {
  const TestFolder dir;
  for (const char* sizes :
       {"--length 0.005 --mass 0 --diameter 0.0005", "--length 10 --mass 500 --diameter 1",
        "--length 0.01 --mass 0.5 --diameter 1", "--length 1 --mass 1 --diameter 0.1 --stiffness 500",
        "--length 1 --mass 1 --diameter 0.1 --stiffness 1e-6"}) {
    for (const std::string& kind : all_kinds()) {
      const Outcome o =
          softarm_program("new-arm --force --kind " + kind + " --segments 1 --bodies 3 " + sizes + " --out " +
                          dir / "a.yaml" + (kind == "central" ? "" : " --actuators 32"));
      EXPECT_EQ(o.status, 0) << kind << " " << sizes << "\n" << o.err;
    }
  }
}

TEST(NewArm, AsksOnATerminalForWhatNoFlagSays) {
  if (!std::filesystem::exists("/usr/bin/script"))
    GTEST_SKIP() << "script(1), which makes a terminal, is absent";
  const TestFolder dir;
  // Segments by a flag; directions, base, stiffness and layout as proposed.
  dir.write("answers", "chambers\n0.2\n0.15\n0.04\n3\n4\n\n\n\n" + dir / "a.yaml" + "\n\n");
  const std::string command = "/usr/bin/script -qec '" SOFTARM_PROGRAM_DIR
                              "/softarm new-arm --segments 1' /dev/null <" +
                              dir / "answers" + " >" + dir / "screen" + " 2>&1";
  ASSERT_EQ(std::system(command.c_str()), 0) << text_of(dir / "screen");
  const std::string screen = text_of(dir / "screen");
  EXPECT_THAT(screen, HasSubstr("what drives each segment"));
  EXPECT_THAT(screen, HasSubstr("[evenly spaced]"));
  EXPECT_EQ(screen.find("how many segments"), std::string::npos);
  const Written w = written(dir);
  EXPECT_EQ(w.arm.segments.at(0).chambers.size(), 3u);
  EXPECT_EQ(w.arm.bodies.size(), 4u);
}

}  // namespace
}  // namespace softarm
