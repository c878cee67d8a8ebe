// Recordings joined with a file of inputs, several trials in a file, rows without a clock, positions alone.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "csv_text.h"
#include "trial/csv_layout.h"
#include "trial/csv_recording.h"

namespace softarm {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const char* const kLayout = R"(
header: true
time: {column: ID, period_s: 0.01, start_stamp_s: 1000}
join: {id: ID, inputs_id: number, separator: semicolon, header: true}
mocap:
  unit: m
  up: y
  bodies:
    - {name: disc_1, position: [x, y, z]}
angles:
  unit: deg
  inputs:
    - {topic: /servo/1/angle, column: phi, zero: 90}
    - {topic: /servo/1/command, column: u, from: inputs}
tensions:
  unit: gf
  inputs: [{topic: /tendon/1/tension, column: t, from: inputs}]
payload: {column: m, from: inputs, unit: g}
)";

class CsvJoinTest : public ::testing::Test {
 protected:
  ~CsvJoinTest() override {
    for (const std::string& path : files_) std::filesystem::remove(path);
  }

  std::string file(const std::string& name, const std::string& text) {
    files_.push_back((std::filesystem::path(::testing::TempDir()) /
                      (std::string("softarm_") +
                       ::testing::UnitTest::GetInstance()->current_test_info()->name() + "_" + name))
                         .string());
    std::ofstream(files_.back()) << text;
    return files_.back();
  }

  void read(const std::string& layout, const std::string& recording, const std::string& inputs = "") {
    rows_.clear();
    trial::CsvSources sources;
    if (!inputs.empty()) sources.inputs_path = file("inputs.csv", inputs);
    sources.on_bytes = [&](std::uint64_t bytes) { bytes_ += bytes; };
    bytes_ = 0;
    report_ = trial::read_csv_recording(
        trial::parse_csv_layout(layout, "lab.yaml"), file("recording.csv", recording),
        [&](const trial::CsvRow& row) { rows_.push_back(row); }, sources);
    EXPECT_EQ(bytes_, recording.size());
  }

  std::string error(const std::string& layout, const std::string& recording, const std::string& inputs = "") {
    try {
      read(layout, recording, inputs);
    } catch (const trial::CsvError& e) {
      EXPECT_THAT(e.what(), Not(HasSubstr("\n")));
      return e.what();
    }
    return "no error";
  }

  std::vector<trial::CsvRow> rows_;
  trial::CsvReport report_;
  std::uint64_t bytes_ = 0;

 private:
  std::vector<std::string> files_;
};

TEST_F(CsvJoinTest, InputsAreFoundByIdInAnyOrderAndBecomeSi) {
  read(kLayout, "ID,x,y,z,phi\n7,1,2,3,180\n8,1,2,3,0\n", "number;u;t;m\n8;90;1000;250\n7.0;-180;500;100\n");
  ASSERT_EQ(rows_.size(), 2u);
  EXPECT_DOUBLE_EQ(rows_[0].stamp.s, 1000.07);
  EXPECT_TRUE(rows_[0].bodies[0]->p_mocap.isApprox(Eigen::Vector3d(1, -3, 2)));
  EXPECT_FALSE(rows_[0].bodies[0]->q_mocap);
  EXPECT_NEAR(*rows_[0].scalars[0], M_PI / 2, 1e-12);
  EXPECT_NEAR(*rows_[1].scalars[0], -M_PI / 2, 1e-12);
  EXPECT_NEAR(*rows_[0].scalars[1], -M_PI, 1e-12);
  EXPECT_NEAR(*rows_[1].scalars[1], M_PI / 2, 1e-12);
  EXPECT_NEAR(*rows_[0].scalars[2], 4.903325, 1e-12);
  EXPECT_DOUBLE_EQ(*rows_[0].payload_kg, 0.1);
  EXPECT_DOUBLE_EQ(*rows_[1].payload_kg, 0.25);
  EXPECT_EQ(report_.join->unmatched, 0u);
  EXPECT_EQ(report_.join->unused_ids, 0u);
  EXPECT_TRUE(report_.examples.empty());
}

TEST_F(CsvJoinTest, IdsThatAreMissingTwiceOrUnmatchedAreCountedAndTheirInputsLeftOut) {
  read(
      kLayout,
      "ID,x,y,z,phi\n1,0,0,1,0\n2,0,0,1,0\n,0,0,1,0\n3,0,0,1,0\n3,0,0,1,0\n4,0,0,1,0\n5,0,0,1,0\n6,0,0,1,0\n",
      "number;u;t;m\n1;10;0;0\n3;30;0;0\n4;40;0;0\n4;41;0;0\n5;50;0;-1\n6;;0;0\n;70;0;0\n9;90;0;0\n");
  // Without a clock of its own, an id that comes again is also a time that goes back.
  EXPECT_EQ(report_.bad_rows.at("no time"), 1u);
  EXPECT_EQ(report_.bad_rows.at("time goes back"), 1u);
  ASSERT_EQ(rows_.size(), 6u);
  EXPECT_TRUE(rows_[0].scalars[1]);
  EXPECT_FALSE(rows_[1].scalars[1]) << "2 has no inputs";
  EXPECT_TRUE(rows_[1].scalars[0]) << "its own columns are kept";
  EXPECT_TRUE(rows_[2].scalars[1]);
  EXPECT_FALSE(rows_[3].scalars[1]) << "4 has two";
  EXPECT_TRUE(rows_[4].scalars[1]);
  EXPECT_FALSE(rows_[4].payload_kg) << "negative";
  EXPECT_FALSE(rows_[5].scalars[1]) << "an empty cell";
  EXPECT_EQ(report_.join->rows, 8u);
  EXPECT_EQ(report_.join->unmatched, 2u);
  EXPECT_EQ(report_.join->unused_ids, 1u);
  EXPECT_EQ(report_.join->bad_rows.at("id given twice"), 1u);
  EXPECT_EQ(report_.join->bad_rows.at("no id"), 1u);
  EXPECT_THAT(report_.join->examples.at(0), AllOf(HasSubstr("inputs.csv:5:"), HasSubstr("'4'")));
  EXPECT_EQ(report_.lost.at("/servo/1/command: not a number"), 1u);
  EXPECT_EQ(report_.lost.at("/payload: not from 0 to 100 kg"), 1u);
}

TEST_F(CsvJoinTest, WithAClockARepeatedOrMissingIdIsSkippedByName) {
  const std::string layout = replaced(kLayout, "column: ID, period_s: 0.01", "column: t_s, unit: s");
  read(layout, "ID,x,y,z,phi,t_s\n a,0,0,1,0,1\nb,0,0,1,0,2\nb,0,0,1,0,3\n,0,0,1,0,4\nc,0,0,1,0,5\n",
       "number;u;t;m\na;1;1;1\nb;2;2;2\nc;3;3;3\n");
  EXPECT_EQ(rows_.size(), 3u);
  EXPECT_EQ(report_.bad_rows.at("id given twice"), 1u);
  EXPECT_EQ(report_.bad_rows.at("no id"), 1u);
  EXPECT_DOUBLE_EQ(*rows_[2].payload_kg, 0.003);
}

TEST_F(CsvJoinTest, FilesThatDoNotBelongTogetherAreRefusedWithOneLine) {
  const std::string recording = "ID,x,y,z,phi\n1,0,0,1,0\n2,0,0,1,0\n3,0,0,1,0\n";
  EXPECT_THAT(error(kLayout, recording, "number;u;t;m\n1;1;1;1\n12;1;1;1\n13;1;1;1\n"),
              AllOf(HasSubstr("inputs.csv"), HasSubstr("2 of 3"), HasSubstr("'2' in line 3")));
  EXPECT_THAT(error(kLayout, recording, "id;u;t;m\n1;1;1;1\n"),
              AllOf(HasSubstr("no column 'number'"), HasSubstr("join.inputs_id"), HasSubstr("id, u, t, m")));
  EXPECT_THAT(error(kLayout, recording, "number;u;t;m\n"), HasSubstr("no rows"));
  EXPECT_THAT(error(kLayout, recording, "number;u;t;m\n1;x;1;1\n2;y;1;1\n"),
              AllOf(HasSubstr("2 of 2 rows"), HasSubstr("holds 'x'")));
  EXPECT_THAT(error(kLayout, recording), AllOf(HasSubstr("recording.csv"), HasSubstr("none is given")));
  const std::string alone = R"(
time: {period_s: 0.01}
mocap: {unit: m, up: z, bodies: [{name: base, position: [1, 2, 3]}]}
)";
  EXPECT_THAT(error(alone, "1,2,3\n", "1;2\n"), AllOf(HasSubstr("inputs.csv"), HasSubstr("'join'")));
}

TEST_F(CsvJoinTest, TrialsOfOneFileAreNumberedAnewAndMustBeTogether) {
  const std::string layout = R"(
time: {period_s: 0.5, start_stamp_s: 10}
trial: {column: 1}
mocap: {unit: m, up: z, bodies: [{name: base, position: [2, 3, 4]}]}
)";
  read(layout, "4,0,0,1\n4,0,0,1\n4,0,0,bad\n4,0,0,1\n5,0,0,2\n,0,0,2\n5,0,0,2\n");
  ASSERT_EQ(rows_.size(), 5u);
  EXPECT_EQ(rows_[2].trial, "4");
  EXPECT_DOUBLE_EQ(rows_[2].stamp.s, 11.5) << "the bad row took its 0.5 s";
  EXPECT_EQ(rows_[3].trial, "5");
  EXPECT_DOUBLE_EQ(rows_[3].stamp.s, 10.0);
  EXPECT_EQ(report_.bad_rows.at("no trial"), 1u);
  EXPECT_THAT(error(layout, "4,0,0,1\n5,0,0,1\n4,0,0,1\n"),
              AllOf(HasSubstr("recording.csv:3"), HasSubstr("'4'"), HasSubstr("trial.column")));
}

TEST_F(CsvJoinTest, KeysThatContradictAreRefused) {
  const auto refused = [](const std::string& from, const std::string& to) -> std::string {
    try {
      trial::parse_csv_layout(replaced(kLayout, from, to), "lab.yaml");
    } catch (const trial::CsvError& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_EQ(refused("unit: deg", "unit: rad"), "no error");
  EXPECT_THAT(refused("period_s: 0.01", "period_s: 0.01, unit: s"), HasSubstr("time.period_s"));
  EXPECT_THAT(refused("period_s: 0.01", "period_s: 0"), HasSubstr("time.period_s"));
  EXPECT_THAT(refused("unit: deg", "unit: turns"), AllOf(HasSubstr("angles.unit"), HasSubstr("deg")));
  EXPECT_THAT(refused("/tendon/1/tension", "/servo/1/angle"), HasSubstr("no other input"));
  EXPECT_THAT(refused("from: inputs, unit: g", "from: elsewhere, unit: g"), HasSubstr("payload.from"));
  EXPECT_THAT(refused("join: {id: ID, inputs_id: number, separator: semicolon, header: true}", ""),
              AllOf(HasSubstr("angles.inputs[1].from"), HasSubstr("join")));
  EXPECT_THAT(refused("inputs_id: number, ", ""), AllOf(HasSubstr("join.inputs_id"), HasSubstr("missing")));
  EXPECT_THAT(refused("position: [x, y, z]", "position: [x, y, z], orientation_order: xyzw"),
              HasSubstr("orientation_order"));
}

}  // namespace
}  // namespace softarm
