#include "trial/csv_layout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <tuple>

#include "csv_text.h"
#include "trial/csv_recording.h"

namespace softarm {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const char* const kMinimal = R"(
time: {column: 1, unit: ms, start_stamp_s: 1000}
mocap:
  unit: mm
  up: z
  bodies:
    - {name: base, position: [2, 3, 4], orientation: [5, 6, 7, 8], orientation_order: xyzw}
pressures:
  unit: psi
  reference: gauge
  ambient_pa: 100000
  inputs:
    - {topic: /pressure/chamber_1, column: 9}
)";

std::string error_of(const std::string& text) {
  try {
    trial::parse_csv_layout(text, "lab.yaml");
  } catch (const trial::CsvError& e) {
    EXPECT_THAT(e.what(), Not(HasSubstr("\n")));
    return e.what();
  }
  return "no error";
}

/// A file of the test that is removed with it.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& text)
      : path_(std::filesystem::path(::testing::TempDir()) /
              (std::string("softarm_") + ::testing::UnitTest::GetInstance()->current_test_info()->name() +
               ".csv")) {
    std::ofstream(path_) << text;
  }
  ~TemporaryFile() { std::filesystem::remove(path_); }
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

struct Read {
  std::vector<trial::CsvRow> rows;
  trial::CsvReport report;
};

Read read(const std::string& layout, const std::string& csv) {
  const TemporaryFile file(csv);
  Read result;
  result.report = trial::read_csv_recording(trial::parse_csv_layout(layout, "lab.yaml"), file.path(),
                                            [&](const trial::CsvRow& row) { result.rows.push_back(row); });
  return result;
}

std::string read_error(const std::string& layout, const std::string& csv) {
  try {
    read(layout, csv);
  } catch (const trial::CsvError& e) {
    return e.what();
  }
  return "no error";
}

TEST(CsvLayout, ConvertsEveryUnitToSi) {
  const Read r = read(kMinimal, "500, 100, 200, 300, 0, 0, 0, 1, 2\n");
  ASSERT_EQ(r.rows.size(), 1u);
  EXPECT_DOUBLE_EQ(r.rows[0].time_s, 0.5);
  EXPECT_DOUBLE_EQ(r.rows[0].stamp.s, 1000.5);
  ASSERT_TRUE(r.rows[0].bodies[0]);
  EXPECT_TRUE(r.rows[0].bodies[0]->p_mocap.isApprox(Eigen::Vector3d(0.1, 0.2, 0.3)));
  EXPECT_NEAR(*r.rows[0].pressures_pa[0], 100000 + 2 * 6894.757293168, 1e-6);
}

TEST(CsvLayout, AbsolutePressureHasNoAmbientAdded) {
  const std::string absolute =
      replaced(replaced(kMinimal, "reference: gauge", "reference: absolute"), "unit: psi", "unit: kPa");
  EXPECT_NEAR(*read(absolute, "0,0,0,0,0,0,0,1,110\n").rows[0].pressures_pa[0], 110e3, 1e-9);
}

TEST(CsvLayout, QuaternionOrderIsThatOfTheLayout) {
  const std::string row = "0,0,0,0, 0.5,0.5,-0.5,0.5, 0\n";
  const Read xyzw = read(kMinimal, row);
  EXPECT_DOUBLE_EQ(xyzw.rows[0].bodies[0]->q_mocap->z(), -0.5);
  const Read wxyz = read(replaced(kMinimal, "order: xyzw", "order: wxyz"), row);
  EXPECT_DOUBLE_EQ(wxyz.rows[0].bodies[0]->q_mocap->y(), -0.5);
  EXPECT_DOUBLE_EQ(wxyz.rows[0].bodies[0]->q_mocap->w(), 0.5);
}

TEST(CsvLayout, TheZeroOfASensorIsSubtracted) {
  const std::string layout = replaced(kMinimal, "column: 9}", "column: 9, zero: -0.5}");
  const Read r = read(layout, "0, 0, 0, 0, 0, 0, 0, 1, 2\n");
  EXPECT_NEAR(*r.rows[0].pressures_pa[0], 100000 + 2.5 * 6894.757293168, 1e-6);
  EXPECT_THAT(error_of(replaced(kMinimal, "column: 9}", "column: 9, zero: none}")), HasSubstr("zero"));
}

TEST(CsvLayout, AMountThatDoesNotTurnNeedsNoColumnsForIt) {
  const std::string columns = "orientation: [5, 6, 7, 8], orientation_order: xyzw}";
  const std::string mount = R"(fixed_orientation: [0, 0.6, 0, 0.8]}
    - {name: tip, position: [5, 6, 7], )";
  const std::string tip = R"(orientation: [8, 9, 10, 11], orientation_order: xyzw})";
  const Read r = read(replaced(kMinimal, columns, mount + tip), "0, 10,20,30, 40,50,60, 0,0,1,0\n");
  ASSERT_EQ(r.rows.size(), 1u);
  EXPECT_TRUE(r.rows[0].bodies[0]->p_mocap.isApprox(Eigen::Vector3d(0.01, 0.02, 0.03)));
  EXPECT_DOUBLE_EQ(r.rows[0].bodies[0]->q_mocap->y(), 0.6);
  EXPECT_TRUE(r.rows[0].bodies[1]->p_mocap.isApprox(Eigen::Vector3d(0.04, 0.05, 0.06)));
  EXPECT_DOUBLE_EQ(r.rows[0].bodies[1]->q_mocap->z(), 1.0);
  EXPECT_THAT(error_of(replaced(kMinimal, "orientation_order: xyzw", "fixed_orientation: [0, 0, 0, 1]")),
              HasSubstr("the one or the other"));
  EXPECT_THAT(error_of(replaced(kMinimal, columns, "fixed_orientation: [0, 0, 0, 2]}")),
              HasSubstr("unit quaternion"));
}

TEST(CsvLayout, YUpBecomesZUpForPositionsAndOrientationsAlike) {
  const double h = std::sqrt(0.5);
  // A body whose own z axis points along the recording's y (up) must point along z (up) afterwards.
  const std::string row = "0, 10,20,30, " + std::to_string(-h) + ",0,0," + std::to_string(h) + ", 0\n";
  const Read r = read(replaced(kMinimal, "up: z", "up: y"), row);
  EXPECT_TRUE(r.rows[0].bodies[0]->p_mocap.isApprox(Eigen::Vector3d(0.01, -0.03, 0.02), 1e-9));
  const Eigen::Vector3d axis = *r.rows[0].bodies[0]->q_mocap * Eigen::Vector3d::UnitZ();
  EXPECT_TRUE(axis.isApprox(Eigen::Vector3d::UnitZ(), 1e-6)) << axis.transpose();
}

TEST(CsvLayout, ColumnsByNameOfTheHeader) {
  std::string named = replaced(kMinimal, "column: 9", "column: p1");
  named = "header: true\nseparator: semicolon\n" + named;
  const Read r = read(named, "t;x;y;z;a;b;c;d;\"p1\"\n0;1;2;3;0;0;0;1;1\n");
  ASSERT_EQ(r.rows.size(), 1u);
  EXPECT_NEAR(*r.rows[0].pressures_pa[0], 100000 + 6894.757, 1e-2);
  EXPECT_THAT(read_error(named, "t;x;y;z;a;b;c;d;q1\n0;1;2;3;0;0;0;1;1\n"),
              AllOf(HasSubstr("p1"), HasSubstr("pressures.inputs[0].column"), HasSubstr("q1")));
}

/// One recording, written as different programs write it.
TEST(CsvRecording, ARowOfUnitsIsPassedOverAndAHeaderMayBeAComment) {
  for (const auto& [text, keys, bad] : std::vector<std::tuple<std::string, std::string, std::size_t>>{
           {"t,x,y,z\ns,m,m,m\n0,1,2,3\n0.1,1,2,3\n", "header: true\nunits_row: true\n", 0},
           {"t,x,y,z\ns,m,m,m\n0,1,2,3\n0.1,1,2,3\n", "header: true\n", 1},
           {"# t,x,y,z\n# s,m,m,m\n0,1,2,3\n0.1,1,2,3\n", "header: true\nunits_row: true\n", 0},
           {"# t,x,y,z\n0,1,2,3\n# a remark\n0.1,1,2,3\n", "header: true\n", 0}}) {
    SCOPED_TRACE(text + keys);
    const TemporaryFile file(text);
    for (const char* time : {"t", "'# t'"}) {
      if (text.front() != '#' && time[0] != 't') continue;
      const trial::CsvLayout layout =
          trial::parse_csv_layout(keys + "time: {column: " + time + ", unit: s}\n" +
                                      "mocap: {unit: m, up: z, bodies: [{name: tip, position: [x, y, z]}]}\n",
                                  "layout");
      std::size_t rows = 0;
      const trial::CsvReport report =
          trial::read_csv_recording(layout, file.path(), [&](const trial::CsvRow&) { ++rows; });
      EXPECT_EQ(rows, 2u);
      EXPECT_EQ(report.bad_rows.size(), bad);
    }
  }
}

TEST(CsvRecording, IsReadAsProgramsWriteIt) {
  const Read plain = read(kMinimal, "500, 100.5, 200, 300, 0, 0, 0, 1, -2.25\n");
  ASSERT_EQ(plain.rows.size(), 1u);
  const struct {
    const char *what, *keys, *csv;
  } written[] = {
      {"another character", "separator: '|'", "500|100.5|200|300|0|0|0|1|-2.25\n"},
      {"blanks", "separator: space", "  500 100.5\t200   300 0 0 0 1 -2.25 \n"},
      {"quotes", "", "\"500\",\"100.5\" , \"200\",300,0,0,0,1,\"-2.25\"\n"},
      {"a separator at the end", "", "500,100.5,200,300,0,0,0,1,-2.25,\n"},
      {"a carriage return", "", "500,100.5,200,300,0,0,0,1,-2.25\r\n"},
      {"a byte order mark", "",
       "\xEF\xBB\xBF"
       "500,100.5,200,300,0,0,0,1,-2.25\n"},
      {"signs and exponents", "", "+5e2,1.005e+02,200,300,0,0,0,1,-.225E1\n"},
      {"decimal commas", "separator: semicolon\ndecimal: comma", "500;100,5;200;300;0;0;0;1;-2,25\n"},
      {"decimal commas in quotes", "separator: tab\ndecimal: comma",
       "500\t\"100,5\"\t200\t300\t0\t0\t0\t1\t\"-2,25\"\n"},
      {"decimal commas in quotes between commas", "separator: comma\ndecimal: comma",
       "500,\"100,5\",200,300,0,0,0,1,\"-2,25\"\n"},
      {"carriage returns alone", "", "500,100.5,200,300,0,0,0,1,-2.25\r"},
  };
  for (const auto& [what, keys, csv] : written) {
    SCOPED_TRACE(what);
    const Read r = read(std::string(keys) + kMinimal, csv);
    ASSERT_EQ(r.rows.size(), 1u);
    EXPECT_EQ(r.rows[0].stamp.s, plain.rows[0].stamp.s);
    EXPECT_EQ(r.rows[0].bodies[0]->p_mocap, plain.rows[0].bodies[0]->p_mocap);
    EXPECT_EQ(*r.rows[0].pressures_pa[0], *plain.rows[0].pressures_pa[0]);
  }
}

TEST(CsvRecording, LinesThatEndInCarriageReturnsAloneAreLines) {
  const Read r = read("header: true" + std::string(kMinimal),
                      "t,x,y,z,a,b,c,d,p\r0,0,0,0,0,0,0,1,3\r10,0,0,0,0,0,0,1,3\r20,0,0,0,0,0,0,1,3");
  EXPECT_EQ(r.rows.size(), 3u);
}

std::string utf16(const std::string& text, bool little) {
  std::string wide;
  for (const char c : text) wide += little ? std::string{c, '\0'} : std::string{'\0', c};
  return wide;
}

TEST(CsvRecording, WhatIsNoUtf8TextIsSaidWithTheRemedy) {
  const std::string csv = "500,100.5,200,300,0,0,0,1,-2.25\n";
  const struct {
    std::string csv, what;
  } files[] = {
      {"\xFF\xFE" + utf16(csv, true),
       "is UTF-16 text, UTF-8 is needed: convert it by iconv -f UTF-16 -t UTF-8 "},
      {"\xFE\xFF" + utf16(csv, false), "iconv -f UTF-16 -t UTF-8 "},
      {utf16(csv, true), "iconv -f UTF-16LE -t UTF-8 "},
      {utf16(csv, false), "iconv -f UTF-16BE -t UTF-8 "},
      {"PK\x03\x04" + csv, "is a workbook or an archive, no text: save it as CSV first"},
      {csv + std::string(3, '\0') + csv, "holds zero bytes"},
  };
  for (const auto& file : files) {
    const std::string why = read_error(kMinimal, file.csv);
    EXPECT_THAT(why, HasSubstr(file.what));
    EXPECT_THAT(why, AllOf(HasSubstr(".csv: "), Not(HasSubstr("\n"))));
  }
}

TEST(CsvRecording, ADecimalCommaThatTheLayoutDoesNotNameIsSaid) {
  const Read r = read("separator: semicolon" + std::string(kMinimal),
                      "0;0;0;0;0;0;0;1;0\n1;0;0;0;0;0;0;1;0\n2;0,5;0;0;0;0;0;1;0\n");
  ASSERT_EQ(r.report.examples.size(), 1u);
  EXPECT_THAT(r.report.examples[0], HasSubstr("column 2 holds '0,5' (with 'decimal: comma' in the layout"));
}

TEST(CsvRecording, ANameInQuotesMayHoldTheSeparator) {
  const std::string named =
      replaced("header: true" + std::string(kMinimal), "column: 9}", "column: 'p, \"left\"'}");
  const Read r = read(named, "t,x,y,z,a,b,c,d,\"p, \"\"left\"\"\"\n0,0,0,0,0,0,0,1,3\n");
  ASSERT_EQ(r.rows.size(), 1u);
  EXPECT_NEAR(*r.rows[0].pressures_pa[0], 100000 + 3 * 6894.757293168, 1e-6);
}

TEST(CsvRecording, BadRowsAreSkippedAndCountedWithTheirLine) {
  const Read r = read(kMinimal,
                      "0,0,0,0,0,0,0,1,0\n"
                      "10,0,0,0,0,0,0,1\n"       // short
                      "20,0,0,zero,0,0,0,1,0\n"  // text
                      "# a remark\n"
                      "5,0,0,0,0,0,0,1,0\n"
                      "4,0,0,0,0,0,0,1,0\n"     // back in time
                      "30,nan,0,0,0,0,0,1,0\n"  // lost body
                      "40,0,0,0,0,0,0,0,0\n"    // zero quaternion
                      "50,0,0,0,0,0,0,1,\n");   // no pressure
  EXPECT_EQ(r.report.rows, 8u);
  EXPECT_EQ(r.report.used, 5u);
  EXPECT_EQ(r.report.bad_rows.at("too short"), 1u);
  EXPECT_EQ(r.report.bad_rows.at("not a number"), 1u);
  EXPECT_EQ(r.report.bad_rows.at("time goes back"), 1u);
  EXPECT_EQ(r.report.lost.at("base: not a number"), 1u);
  EXPECT_EQ(r.report.lost.at("base: zero quaternion"), 1u);
  EXPECT_EQ(r.report.lost.at("/pressure/chamber_1: not a number"), 1u);
  ASSERT_GE(r.report.examples.size(), 3u);
  EXPECT_THAT(r.report.examples[0], AllOf(HasSubstr(".csv:2:"), HasSubstr("column 9")));
  EXPECT_THAT(r.report.examples[1], AllOf(HasSubstr(".csv:3:"), HasSubstr("zero")));
  EXPECT_THAT(r.report.examples[2], HasSubstr(".csv:6:"));
  EXPECT_FALSE(r.rows[2].bodies[0]);
  EXPECT_FALSE(r.rows[3].bodies[0]);
  EXPECT_TRUE(r.rows[4].bodies[0]);
  EXPECT_FALSE(r.rows[4].pressures_pa[0]);
}

TEST(CsvRecording, RepeatedPosesAreLeftOutOnlyWhereAsked) {
  const std::string csv = "0,1,0,0,0,0,0,1,5\n1,1,0,0,0,0,0,1,6\n2,2,0,0,0,0,0,1,6\n";
  EXPECT_TRUE(read(kMinimal, csv).rows[1].bodies[0]);
  const Read r = read(replaced(kMinimal, "up: z", "up: z\n  drop_repeated: true"), csv);
  ASSERT_EQ(r.rows.size(), 3u);
  EXPECT_TRUE(r.rows[0].bodies[0]);
  EXPECT_FALSE(r.rows[1].bodies[0]);
  EXPECT_TRUE(r.rows[1].pressures_pa[0]);
  EXPECT_TRUE(r.rows[2].bodies[0]);
  EXPECT_EQ(r.report.repeated, 1u);
}

TEST(CsvRecording, AFileThatTheLayoutDoesNotFitIsRefused) {
  EXPECT_THAT(read_error(kMinimal, "0,1\n1,2\n2,3\n"),
              AllOf(HasSubstr("3 of 3 rows"), HasSubstr("line 1"), HasSubstr("layout")));
  EXPECT_THAT(read_error(kMinimal, ""), HasSubstr("no rows"));
  const trial::CsvLayout layout = trial::parse_csv_layout(kMinimal, "lab.yaml");
  EXPECT_THROW(trial::read_csv_recording(layout, "/nonexistent/x.csv", [](const trial::CsvRow&) {}),
               trial::CsvError);
}

TEST(CsvLayout, ErrorsNameFileKeyValueAndWhatIsAllowed) {
  EXPECT_EQ(error_of(kMinimal), "no error");
  EXPECT_THAT(
      error_of(replaced(kMinimal, "unit: psi", "unit: PSI")),
      AllOf(HasSubstr("lab.yaml"), HasSubstr("pressures.unit"), HasSubstr("'PSI'"), HasSubstr("kPa")));
  EXPECT_THAT(error_of(replaced(kMinimal, "unit: mm", "unit: inch")), HasSubstr("one of m, cm, mm"));
  EXPECT_THAT(error_of(replaced(kMinimal, "unit: ms", "unit: min")), HasSubstr("time.unit"));
  EXPECT_THAT(error_of(replaced(kMinimal, "up: z", "up: x")), HasSubstr("mocap.up"));
  EXPECT_THAT(error_of(replaced(kMinimal, "position: [2, 3, 4]", "position: [2, 3]")),
              AllOf(HasSubstr("mocap.bodies[0].position"), HasSubstr("3 columns")));
  EXPECT_THAT(error_of(replaced(kMinimal, "column: 9", "column: 0")), HasSubstr("number from 1"));
  EXPECT_THAT(error_of(replaced(kMinimal, "column: 9", "column: p1")), HasSubstr("number from 1"));
  EXPECT_THAT(error_of(replaced(kMinimal, "ambient_pa: 100000", "ambient_pa: 100")),
              AllOf(HasSubstr("100"), HasSubstr("50000")));
  EXPECT_THAT(error_of(replaced(kMinimal, "ambient_pa: 100000", "ambient_pa: .nan")),
              HasSubstr("ambient_pa"));
  for (const char* separator : {"'||'", "'.'", "'5'", "pipe"})
    EXPECT_THAT(error_of("separator: " + std::string(separator) + kMinimal),
                AllOf(HasSubstr("'separator'"), HasSubstr("one character in quotes")));
  EXPECT_THAT(error_of("separator: |" + std::string(kMinimal)), HasSubstr("one character in quotes"));
  EXPECT_THAT(error_of("decimal: comma" + std::string(kMinimal)),
              AllOf(HasSubstr("'decimal'"), HasSubstr("name the separator")));
  EXPECT_THAT(error_of(std::string(kMinimal) + "colour: blue\n"),
              AllOf(HasSubstr("colour"), HasSubstr("lab.yaml:14"), HasSubstr("unknown")));
  // Found by scripts/fuzz: the mark of a tag takes the colon, and the list after it is the key.
  EXPECT_THAT(error_of("time: {column: 1, unit: s}\nmocap: {unit: m, up: y,!bodies: [{name: tip}]}\n"),
              AllOf(HasSubstr("lab.yaml:2"), HasSubstr("[{name: tip}]'"), HasSubstr("unknown")));
  EXPECT_THAT(error_of("time:\n  column: 1\n  ? - a\n    - b\n  : s\n"), HasSubstr("'time.- a - b'"));
  EXPECT_THAT(error_of("time: {column: 1, unit: s}\n"), AllOf(HasSubstr("mocap"), HasSubstr("missing")));
  EXPECT_THAT(error_of(std::string(kMinimal) + "payload: [{from_s: 5, kg: 0}, {from_s: 5, kg: 1}]\n"),
              HasSubstr("payload[1].from_s"));
  EXPECT_THAT(error_of(std::string(kMinimal) + "payload: 0.4\n"), HasSubstr("a list"));
  EXPECT_THAT(error_of("a: [1\nb"), HasSubstr("not YAML"));
  EXPECT_THAT(error_of(""), HasSubstr("mapping"));
}

TEST(CsvLayout, EveryShippedLayoutLoads) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(SOFTARM_SOURCE_DIR "/config/layouts")) {
    std::ostringstream text;
    text << std::ifstream(entry.path()).rdbuf();
    EXPECT_NO_THROW(trial::parse_csv_layout(text.str(), entry.path().string())) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 2);
}

}  // namespace
}  // namespace softarm
