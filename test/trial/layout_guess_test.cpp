// Layouts guessed from files made for it: the draft loads, or says in one line what is to be filled in.
#include "trial/layout_guess.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "trial/csv_recording.h"

namespace softarm {
namespace {

using ::testing::HasSubstr;

struct Style {
  char separator = ',';
  bool decimal_comma = false, header = false, w_first = false, tilted = false, from_tip = false;
  double time_scale = 1.0, time_from = 0.0, length_scale = 1.0;
  int junk_lines = 0;
  bool end_separator = false, quoted = false;
  std::vector<std::string> inputs{"pressure_1", "pressure_2"};  ///< their names
  std::vector<std::string> others;                              ///< names of columns with other things
  std::string before, mark;     ///< lines in front; what the header begins with
  bool units = false;           ///< a row of units below the header
  bool constant_mount = false;  ///< to the last digit
  std::vector<int> order;       ///< of the bodies in the file, in place of base to tip
};

/// Base and two rings of a hanging arm that bends about y, and two chambers in kPa above ambient.
std::string recording(const Style& style) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 1e-5);
  std::string text;
  for (int k = 0; k < style.junk_lines; ++k) text += "exported by some program\n";
  text += style.before;
  const std::vector<int> order = !style.order.empty() ? style.order
                                 : style.from_tip     ? std::vector<int>{2, 1, 0}
                                                      : std::vector<int>{0, 1, 2};
  std::vector<std::string> names{"time"}, units{"s"};
  for (const int b : order) {
    for (const char* part : {"_x", "_y", "_z", "_qx", "_qy", "_qz", "_qw"}) {
      names.push_back(std::vector<std::string>{"mount", "mid", "end"}.at(b) + part);
      units.push_back(part[1] == 'q' ? "" : "cm");
    }
  }
  names.insert(names.end(), style.inputs.begin(), style.inputs.end());
  units.insert(units.end(), style.inputs.size(), "[kPa]");
  names.insert(names.end(), style.others.begin(), style.others.end());
  names[0] = style.mark + names[0];
  units[0] = style.mark + units[0];
  const auto row = [&](const std::vector<std::string>& cells) {
    for (std::size_t i = 0; i < cells.size(); ++i)
      text += (i ? std::string(1, style.separator) : "") + cells[i];
    text += (style.end_separator ? std::string(1, style.separator) : "") + "\n";
  };
  if (style.header) row(names);
  if (style.units) row(units);
  const Eigen::Quaterniond mounted(style.tilted
                                       ? Eigen::AngleAxisd(1.9, Eigen::Vector3d(1, 2, 3).normalized())
                                       : Eigen::AngleAxisd::Identity());
  for (int k = 0; k < 400; ++k) {
    const double t = 0.01 * k, p1 = 60.0 * (1.0 - std::cos(2.0 * t)), p2 = 45.0 * (1.0 - std::cos(3.1 * t));
    std::vector<double> numbers{style.time_from + style.time_scale * t};
    for (const int b : order) {
      const double of_noise = style.constant_mount && b == 0 ? 0.0 : 1.0;
      const double s = 0.15 * b, angle = 0.004 * (p1 - p2) * b;
      const Eigen::Vector3d p(0.3 - 0.5 * s * std::sin(angle), 0.1, 1.0 - s * std::cos(0.5 * angle));
      const Eigen::Quaterniond q = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()) * mounted;
      for (int i = 0; i < 3; ++i) numbers.push_back(style.length_scale * (p(i) + of_noise * noise(random)));
      if (style.w_first) numbers.push_back(q.w());
      for (const double x : {q.x(), q.y(), q.z()}) numbers.push_back(x + of_noise * noise(random));
      if (!style.w_first) numbers.push_back(q.w());
    }
    numbers.insert(numbers.end(), {p1, p2});
    for (std::size_t i = 0; i < style.others.size(); ++i)
      numbers.push_back(0.1 + 0.01 * std::sin(t + 1.0 * i));
    std::vector<std::string> cells;
    for (const double x : numbers) {
      cells.push_back(fmt::format("{:.6f}", x));
      if (style.decimal_comma) std::replace(cells.back().begin(), cells.back().end(), '.', ',');
      if (style.quoted) cells.back() = '"' + cells.back() + '"';
    }
    row(cells);
  }
  return text;
}

class LayoutGuess : public ::testing::Test {
 protected:
  LayoutGuess()
      : path_((std::filesystem::path(::testing::TempDir()) /
               (std::string("guess_") + ::testing::UnitTest::GetInstance()->current_test_info()->name() +
                ".csv"))
                  .string()) {}
  ~LayoutGuess() override { std::filesystem::remove(path_); }
  trial::LayoutGuess guess(const std::string& text) {
    std::ofstream(path_) << text;
    return trial::guess_layout(path_);
  }
  /// Reads the file by its own draft.
  std::vector<trial::CsvRow> read(const trial::LayoutGuess& g) const {
    std::vector<trial::CsvRow> rows;
    trial::read_csv_recording(trial::parse_csv_layout(to_yaml(g, "a.csv"), "draft"), path_,
                              [&](const trial::CsvRow& row) { rows.push_back(row); });
    return rows;
  }
  /// Every row, with the arm where it was and its pressures in Pa.
  void expect_right(const trial::LayoutGuess& g) const {
    EXPECT_EQ(blanks(g), 0u) << to_yaml(g, "a.csv");
    const std::vector<trial::CsvRow> rows = read(g);
    ASSERT_EQ(rows.size(), 400u);
    EXPECT_NEAR(rows[100].time_s - rows[0].time_s, 1.0, 1e-4);
    ASSERT_EQ(rows[100].bodies.size(), 3u);
    EXPECT_NEAR(rows[100].bodies[0]->p_mocap.z(), 1.0, 1e-3);
    EXPECT_NEAR(rows[0].bodies[2]->p_mocap.z(), 0.7, 1e-3);
    EXPECT_NEAR(rows[0].bodies[2]->q_mocap->angularDistance(*rows[0].bodies[0]->q_mocap), 0.0, 1e-3);
    EXPECT_NEAR(rows[100].bodies[1]->q_mocap->angularDistance(*rows[100].bodies[0]->q_mocap),
                0.5 * rows[100].bodies[2]->q_mocap->angularDistance(*rows[100].bodies[0]->q_mocap), 1e-3);
    ASSERT_EQ(rows[100].pressures_pa.size(), 2u);
    EXPECT_NEAR(*rows[100].pressures_pa[0], 101325.0 + 60e3 * (1.0 - std::cos(2.0)), 1.0);
  }

  std::string path_;
};

TEST_F(LayoutGuess, WithoutAHeader) {
  const trial::LayoutGuess g = guess(recording({}));
  expect_right(g);
  EXPECT_EQ(g.bodies[0].name, "base");
  EXPECT_EQ(g.bodies[1].name, "ring_1");
  EXPECT_EQ(g.bodies[2].name, "tip");
  EXPECT_EQ(g.up.text, "z");
  EXPECT_EQ(g.inputs.at(0).unit.text, "kPa");
}

TEST_F(LayoutGuess, SemicolonsDecimalCommasAndASeparatorAtTheEnd) {
  Style style;
  style.separator = ';';
  style.decimal_comma = style.end_separator = true;
  const trial::LayoutGuess g = guess(recording(style));
  expect_right(g);
  EXPECT_THAT(to_yaml(g, "a.csv"), HasSubstr("separator: semicolon\ndecimal: comma\n"));
}

TEST_F(LayoutGuess, OtherSeparatorsAndLinesBeforeTheHeader) {
  // All but the underscore of the names, and what is part of a number or quotes.
  for (const char separator : std::string("\t !#$%&'()*,/:;<=>?@[\\]^`{|}~")) {
    SCOPED_TRACE(separator);
    Style style;
    style.separator = separator;
    style.header = true;
    style.junk_lines = 2;
    const trial::LayoutGuess g = guess(recording(style));
    expect_right(g);
    EXPECT_EQ(g.shape.format.skip_lines, 2);
    EXPECT_THAT(to_yaml(g, "a.csv"), HasSubstr("position: [mount_x, mount_y, mount_z]"));
  }
}

TEST_F(LayoutGuess, AHeaderThatIsAComment) {
  for (const char separator : {' ', '\t', ','}) {
    for (const char* mark : {"# ", "#"}) {
      Style style;
      style.separator = separator;
      style.header = true;
      style.before = "# made by a program\n";
      style.mark = mark;
      const trial::LayoutGuess g = guess(recording(style));
      expect_right(g);
      EXPECT_THAT(to_yaml(g, "a.csv"), HasSubstr("column: time\n"));
      EXPECT_THAT(to_yaml(g, "a.csv"), HasSubstr("position: [mount_x, mount_y, mount_z]"));
    }
  }
}

TEST_F(LayoutGuess, ARowOfUnitsIsNoDataAndSaysTheUnits) {
  for (const char* mark : {"", "# "}) {
    Style style;
    style.header = style.units = true;
    style.mark = mark;
    style.length_scale = 100.0;
    style.inputs = {"left", "right"};
    const trial::LayoutGuess g = guess(recording(style));
    const std::string draft = to_yaml(g, "a.csv");
    expect_right(g);
    EXPECT_THAT(draft, HasSubstr("units_row: true\n"));
    EXPECT_THAT(draft, HasSubstr("position: [mount_x, mount_y, mount_z]"));
    EXPECT_EQ(g.length_unit.text, "cm");
    EXPECT_EQ(g.inputs.at(0).section, "pressures");
    EXPECT_EQ(g.inputs.at(0).unit.why, "as the header says");
  }
}

TEST_F(LayoutGuess, UnitsInBracketsBehindTheNames) {
  std::string text = "t [ms],x [mm],y [mm],z [mm],left [kgf],right [V]\n";
  for (int k = 0; k < 300; ++k)
    text += fmt::format("{},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f}\n", 10 * k, 3.0 * std::sin(0.1 * k), 2.0,
                        5.0 * std::cos(0.1 * k), 2.0 + std::sin(0.1 * k), std::cos(0.1 * k));
  const trial::LayoutGuess g = guess(text);
  EXPECT_EQ(g.time_unit.text, "ms");
  EXPECT_EQ(g.length_unit.text, "mm");
  ASSERT_EQ(g.inputs.size(), 1u) << to_yaml(g, "a");
  EXPECT_EQ(g.inputs[0].section, "tensions");
  EXPECT_EQ(g.inputs[0].unit.text, "kgf");
}

TEST_F(LayoutGuess, AMountThatIsNotMeasuredIsTheBaseAndNoRing) {
  for (const bool header : {true, false}) {
    for (const bool at_end : {false, true}) {
      SCOPED_TRACE(fmt::format("header {}, at the end {}", header, at_end));
      Style style;
      style.header = header;
      style.constant_mount = true;
      style.order = at_end ? std::vector<int>{1, 2, 0} : std::vector<int>{0, 1, 2};
      const trial::LayoutGuess g = guess(recording(style));
      expect_right(g);
      ASSERT_EQ(g.bodies.size(), 3u);
      EXPECT_EQ(g.bodies[0].name, "base");
      EXPECT_EQ(g.bodies[0].orientation.size(), 4u);
    }
  }
}

TEST_F(LayoutGuess, AMountInTheMiddleIsTheBaseAndAFixedPoseBesideItIsNoRing) {
  Style style;
  style.header = true;
  style.order = {1, 0, 2};
  expect_right(guess(recording(style)));
  std::string text = recording(style), with_origin;
  std::istringstream lines(text);
  bool first = true;
  for (std::string line; std::getline(lines, line); first = false)
    with_origin += line + (first ? ",origin_x,origin_y,origin_z" : ",0.1,0.2,0") + "\n";
  const trial::LayoutGuess g = guess(with_origin);
  expect_right(g);
  EXPECT_THAT(to_yaml(g, "a.csv"), HasSubstr("origin_x: stands still beside the base, no ring"));
}

TEST_F(LayoutGuess, AQuaternionIsNoPlace) {
  // Lost throughout: no unit quaternion, and yet names that differ in x, y and z.
  std::string text = "t,tip_x,tip_y,tip_z,tip_qx,tip_qy,tip_qz,tip_qw\n";
  for (int k = 0; k < 300; ++k)
    text += fmt::format("{:.2f},{:.4f},{:.4f},{:.4f},0,0,0,0\n", 0.01 * k, 0.1 * std::sin(0.1 * k), 0.2,
                        0.5 + 0.1 * std::cos(0.1 * k));
  EXPECT_EQ(guess(text).bodies.size(), 1u);
}

TEST_F(LayoutGuess, InputsThatGoBothWaysWithoutANameAreOfAKindThatIsToBeFilledIn) {
  std::string text;
  for (int k = 0; k < 300; ++k)
    text += fmt::format("{:.2f},{:.6f},{:.6f},{:.6f},{:.3f},{:.3f}\n", 0.01 * k, 0.1 * std::sin(0.1 * k),
                        0.2 + 0.01 * std::sin(0.07 * k), 0.9 + 0.01 * std::cos(0.1 * k),
                        0.2 * std::sin(0.3 * k), 0.25 * std::cos(0.2 * k));
  const trial::LayoutGuess g = guess(text);
  std::string draft = to_yaml(g, "a.csv");
  EXPECT_EQ(g.inputs.at(0).section, trial::kUnknownKind) << draft;
  EXPECT_EQ(blanks(g), 3u) << draft;  // their kind, their unit, and the axis that points up
  try {
    trial::parse_csv_layout(draft, "draft.yaml");
    ADD_FAILURE() << draft;
  } catch (const trial::CsvError& e) {
    EXPECT_THAT(e.what(), HasSubstr("key 'FILL_IN': unknown; allowed: angles"));
  }
  draft.replace(draft.find("\nFILL_IN:"), 9, "\nangles:");
  draft.insert(draft.rfind("  unit:\n") + 7, " rad");
  draft.insert(draft.find("  up:\n") + 5, " z");
  EXPECT_EQ(trial::parse_csv_layout(draft, "draft.yaml").scalars.size(), 2u) << draft;
}

TEST_F(LayoutGuess, DecimalCommasInQuotesBetweenCommas) {
  Style style;
  style.decimal_comma = style.quoted = true;
  const trial::LayoutGuess g = guess(recording(style));
  expect_right(g);
  EXPECT_THAT(to_yaml(g, "a.csv"), HasSubstr("separator: comma\ndecimal: comma\n"));
}

TEST_F(LayoutGuess, InputsWhoseNamesSayNothingAreGuessedByTheirRanges) {
  for (const auto& names : std::vector<std::vector<std::string>>{
           {"c11", "c12"}, {"left", "right"}, {"sensor1", "sensor2"}, {"A", "B"}}) {
    SCOPED_TRACE(names[0]);
    Style style;
    style.header = true;
    style.inputs = names;
    style.others = {"marker_error", "whatever"};
    const trial::LayoutGuess g = guess(recording(style));
    const std::string draft = to_yaml(g, "a.csv");
    expect_right(g);
    EXPECT_THAT(draft, HasSubstr("column: " + names[0] + "\n"));
    EXPECT_THAT(draft, HasSubstr("CHECK: neither time nor pose"));
    // What varies by far less, or is named for what it is, is there to be uncommented.
    for (const std::string& other : style.others) EXPECT_THAT(draft, HasSubstr("#       column: " + other));
  }
}

TEST_F(LayoutGuess, BesideInputsKnownByNameOthersAreListedAsComments) {
  Style style;
  style.header = true;
  style.inputs = {"pressure_1", "left"};
  const trial::LayoutGuess g = guess(recording(style));
  std::string draft = to_yaml(g, "a.csv");
  ASSERT_EQ(g.inputs.size(), 1u);
  EXPECT_EQ(g.inputs[0].inputs.size(), 1u);
  const std::string entry = "#     - topic: /pressure/chamber_2\n#       column: left";
  ASSERT_THAT(draft, HasSubstr(entry));
  // Uncommented it is the second input.
  draft.replace(draft.find(entry), entry.size(), "    - topic: /pressure/chamber_2\n      column: left");
  const trial::CsvLayout layout = trial::parse_csv_layout(draft, "draft");
  ASSERT_EQ(layout.pressures.size(), 2u);
  EXPECT_EQ(layout.pressures[1].column.label, "left");
}

TEST_F(LayoutGuess, ColumnsWithoutANumberAreLeftOutAndSaid) {
  for (const std::string cell : {"nan", "NaN", "", "lost"}) {
    SCOPED_TRACE("'" + cell + "'");
    Style style;
    style.header = true;
    std::istringstream lines(recording(style));
    std::string text, line;
    // A third chamber and a third ring of which nothing came.
    for (bool first = true; std::getline(lines, line); first = false)
      text +=
          line +
          (first ? ",pressure_3,last_x,last_y,last_z" : "," + cell + "," + cell + "," + cell + "," + cell) +
          "\n";
    const trial::LayoutGuess g = guess(text);
    expect_right(g);
    EXPECT_THAT(to_yaml(g, "a.csv"), HasSubstr("#   pressure_3 to last_z: not one number in 400 rows\n"));
  }
}

TEST_F(LayoutGuess, WithoutPosesNamedColumnsAreListedAsComments) {
  std::string text = "t,left,right\n";
  for (int k = 0; k < 300; ++k)
    text +=
        fmt::format("{:.2f},{:.4f},{:.4f}\n", 0.01 * k, 20.0 + std::sin(0.1 * k), 20.0 + std::cos(0.1 * k));
  const std::string draft = to_yaml(guess(text), "a.csv");
  EXPECT_THAT(draft, HasSubstr("# pressures:\n#   unit:\n"));
  EXPECT_THAT(draft, HasSubstr("#       column: left"));
  EXPECT_THAT(draft, HasSubstr("#       column: right"));
}

TEST_F(LayoutGuess, UnitsOfTimeByTheSteps) {
  for (const auto& [scale, unit] :
       std::vector<std::pair<double, std::string>>{{1.0, "s"}, {1e3, "ms"}, {1e6, "us"}, {1e9, "ns"}}) {
    Style style;
    style.time_scale = scale;
    const trial::LayoutGuess g = guess(recording(style));
    EXPECT_EQ(g.time_unit.text, unit);
    expect_right(g);
  }
  Style style;
  style.time_from = 1.7e9;
  const trial::LayoutGuess g = guess(recording(style));
  EXPECT_TRUE(g.from_epoch);
  expect_right(g);
  EXPECT_NEAR(read(g).front().stamp.s, 1.7e9, 1e-3);
}

TEST_F(LayoutGuess, MillimetresAndTheFileThatCountsFromTheTip) {
  Style style;
  style.length_scale = 1e3;
  style.from_tip = true;
  const trial::LayoutGuess g = guess(recording(style));
  EXPECT_EQ(g.length_unit.text, "mm");
  expect_right(g);
}

TEST_F(LayoutGuess, OrderOfTheQuaternionByWhichIsLargeOrByTheArm) {
  for (const bool w_first : {false, true}) {
    for (const bool tilted : {false, true}) {
      Style style;
      style.w_first = w_first;
      style.tilted = tilted;
      const trial::LayoutGuess g = guess(recording(style));
      // A mount that does not turn tells nothing of its order, where it is tilted: that is left blank.
      EXPECT_EQ(g.bodies[0].order.text.empty(), tilted);
      for (std::size_t b = 1; b < 3; ++b)
        EXPECT_EQ(g.bodies[b].order.text, w_first ? "wxyz" : "xyzw") << tilted;
    }
  }
}

TEST_F(LayoutGuess, AbsolutePressuresByTheirLeast) {
  for (const auto& [unit, pa] : std::vector<std::pair<std::string, double>>{
           {"Pa", 1.0}, {"kPa", 1e3}, {"bar", 1e5}, {"psi", 6894.757}}) {
    std::string text;
    for (int k = 0; k < 300; ++k)
      text += fmt::format("{:.2f},{:.6f},{:.6f},{:.6f},{:.6f}\n", 0.01 * k, 0.1 * std::sin(0.1 * k),
                          0.2 + 0.01 * std::sin(0.07 * k), 0.9 + 0.01 * std::cos(0.1 * k),
                          (101325.0 + 3e4 * (1.0 - std::cos(0.05 * k))) / pa);
    const trial::LayoutGuess g = guess(text);
    ASSERT_EQ(g.inputs.size(), 1u) << to_yaml(g, "a");
    EXPECT_EQ(g.inputs[0].unit.text, unit);
    EXPECT_EQ(g.inputs[0].reference.text, "absolute");
  }
}

TEST_F(LayoutGuess, WhatTheFileDoesNotTellIsLeftBlankAndRefusedInOneLine) {
  std::string text = "ID,x1,y1,z1,tension_1,phi1,p1\n";
  for (int k = 0; k < 300; ++k)
    text += fmt::format("{},{:.6f},{:.6f},{:.6f},{:.4f},{:.4f},{:.4f}\n", k, 0.1 * std::sin(0.1 * k),
                        0.2 + 0.1 * std::cos(0.1 * k), 0.9, 2.0 + std::sin(0.1 * k), std::cos(0.1 * k),
                        4.0 + 5.0 * std::sin(0.1 * k));
  trial::LayoutGuess g = guess(text);
  std::string draft = to_yaml(g, "a.csv");
  // Period, axis and units of tension, angle and pressure: each is asked for in its turn.
  EXPECT_EQ(blanks(g), 5u) << draft;
  const auto refused = [&] {
    try {
      trial::parse_csv_layout(draft, "draft.yaml");
    } catch (const trial::CsvError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  for (const auto& [key, value] : std::vector<std::pair<std::string, std::string>>{
           {"period_s:", "0.01"}, {"up:", "z"}, {"unit:", "?"}, {"unit:", "?"}, {"unit:", "?"}}) {
    const std::string why = refused();
    EXPECT_THAT(why, HasSubstr("draft.yaml:"));
    EXPECT_THAT(why, HasSubstr("is left blank; it gives"));
    EXPECT_EQ(why.find('\n'), std::string::npos);
    std::string fill = value;
    if (value == "?")
      fill = why.find("'pressures") != std::string::npos ? "kPa"
             : why.find("'angles") != std::string::npos  ? "rad"
                                                         : "N";
    // The blank of that section.
    const std::size_t quote = why.find('\'');
    const std::string path = why.substr(quote + 1, why.find('\'', quote + 1) - quote - 1),
                      section = path.substr(0, path.find('.'));
    const std::size_t from = draft.find("\n" + section + ":"), blank = draft.find("  " + key + "\n", from);
    ASSERT_NE(blank, std::string::npos) << why << draft;
    draft.insert(blank + 2 + key.size(), " " + fill);
  }
  EXPECT_EQ(refused(), "") << draft;
}

TEST_F(LayoutGuess, FilesWithoutNumbersAreRefusedInOneLine) {
  for (const char* text : {"", "nothing\nbut,words\n"}) {
    try {
      guess(text);
      FAIL();
    } catch (const trial::CsvError& e) {
      EXPECT_THAT(e.what(), HasSubstr("no rows of numbers"));
    }
  }
}

}  // namespace
}  // namespace softarm
