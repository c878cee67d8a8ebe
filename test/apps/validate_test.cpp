// softarm validate: the quick version of its tables.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "program.h"

namespace softarm {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

/// The one paper that was asked for.
json validated(const TestFolder& dir, const std::string& paper) {
  const Outcome o = softarm_program("validate --quick --only " + paper + " --out " + dir.path());
  EXPECT_EQ(o.status, 0) << o.err;
  EXPECT_THAT(o.out, HasSubstr("=== " + paper + ": "));
  const json document = json::parse(text_of(dir / "validation.json"));
  EXPECT_EQ(document.at("papers").size(), 1u);
  return document.at("papers").at(0);
}

const json& table(const json& paper, const std::string& id) {
  for (const json& t : paper.at("tables")) {
    if (t.at("id") == id) return t;
  }
  throw std::runtime_error("no table " + id);
}

const json& row(const json& table, const std::string& quantity) {
  for (const json& r : table.at("rows")) {
    if (r.at("quantity") == quantity) return r;
  }
  throw std::runtime_error("no row " + quantity);
}

double ours(const json& table, const std::string& quantity, const std::string& column) {
  return row(table, quantity).at("ours").at(column).at("value");
}

TEST(SoftarmValidate, SemiPhysicalConstantsOfTheIdealArmComeBack) {
  const TestFolder dir;
  const json paper = validated(dir, "semi_physical");
  const json& constants = table(paper, "semi_physical.table_1");
  EXPECT_EQ(constants.at("rows").size(), 9u);
  for (const json& r : constants.at("rows")) {
    const double printed = std::stod(r.at("published").get<std::string>());
    const double found = r.at("ours").at("ideal: identify").at("value");
    EXPECT_NEAR(found / printed, 1.0, 0.05) << r.at("quantity");
  }
  const json& errors = table(paper, "semi_physical.table_2");
  EXPECT_LT(ours(errors, "mean", "ideal: ours"), 1.5e-3);
  EXPECT_LT(ours(errors, "mean", "ideal: ours"), ours(errors, "mean", "real-like: ours"));
  EXPECT_LT(ours(errors, "mean", "real-like: ours"), ours(errors, "mean", "real-like: theirs"));
  EXPECT_NEAR(ours(table(paper, "semi_physical.arithmetic"), "length at 3 x 50 kPa (mm)", "ours"), 327.25,
              1e-6);
}

TEST(SoftarmValidate, OnlineMethodsStandInThePapersOrder) {
  const TestFolder dir;
  const json paper = validated(dir, "online");
  const json& errors = table(paper, "online.table_2");
  const std::string ideal = "ideal, standing";
  // 0.5 mm of noise, sum of 1 / i = 2.08 over 200 mm: errors of the exact model are of the noise.
  EXPECT_LT(ours(errors, "full points: mean", ideal), 1.2);
  EXPECT_LT(ours(errors, "full points: mean", ideal), ours(errors, "end orientation: mean", ideal));
  EXPECT_LT(ours(errors, "end orientation: mean", ideal), ours(errors, "CC all points: mean", ideal));
  EXPECT_LT(ours(errors, "CC all points: mean", ideal), ours(errors, "CC end point: mean", ideal));
  EXPECT_LT(std::abs(ours(table(paper, "online.table_3"), "full points: EI off the truth by", ideal)), 3.0);
  EXPECT_LT(ours(table(paper, "online.payload"), "least squares: mean error", ideal), 20.0);
  EXPECT_LT(ours(table(paper, "online.table_1"), "full points: mean", "ours"), 0.236);
}

TEST(SoftarmValidate, SingleChamberArithmetic) {
  const TestFolder dir;
  const json paper = validated(dir, "single_chamber");
  const json& arithmetic = table(paper, "single_chamber.arithmetic");
  const double inertia = M_PI / 64.0 * (std::pow(0.012, 4) - std::pow(0.0035, 4));
  EXPECT_NEAR(ours(arithmetic, "3 EI / L^3 (mN/mm)", "ours"), 3.0 * 408e3 * inertia / std::pow(0.085, 3),
              1e-6);
  // Beyond small deflections the arm is a little stiffer than 3 EI / L^3: less modulus is needed.
  const double by_beam = 0.051 / 0.015 * std::pow(0.085, 3) / (3.0 * inertia) / 1e3;
  const double needed = ours(arithmetic, "E for 3.4 mN/mm at 0 kPa (kPa)", "ours");
  EXPECT_LT(needed, by_beam);
  EXPECT_GT(needed, 0.95 * by_beam);
}

TEST(SoftarmValidate, HybridRigidityIsFoundFromTheTip) {
  const TestFolder dir;
  const json paper = validated(dir, "hybrid");
  for (const json& r : table(paper, "hybrid.rigidity").at("rows")) {
    if (!r.at("ours").contains("true") || !r.at("ours").at("true").contains("value")) continue;
    const double truth = r.at("ours").at("true").at("value"), found = r.at("ours").at("ideal").at("value");
    EXPECT_NEAR(found / truth, 1.0, 0.03) << r.at("quantity");
  }
  EXPECT_LT(ours(table(paper, "hybrid.table_3"), "mean", "ideal"), 1.5);
}

TEST(SoftarmValidate, CableStiffnessAndTheSameFilesWhateverTheJobs) {
  const TestFolder dir;
  const json paper = validated(dir, "cable");
  const json& ei = table(paper, "cable.ei");
  EXPECT_NEAR(ours(ei, "exact statics, weight included", "ideal"), 0.007, 7e-5);
  // Their model, without weight, is right for an arm without weight only.
  EXPECT_NEAR(ours(ei, "their model (7)-(9)", "ideal, weightless"), 0.007, 3e-4);
  EXPECT_LT(ours(ei, "their model (7)-(9)", "ideal"), 0.006);
  ASSERT_EQ(softarm_program("validate --quick --jobs 1 --only cable --out " + dir / "again").status, 0);
  for (const std::string name : {"validation.json", "cable_marks.csv", "cable_ei.csv"}) {
    EXPECT_FALSE(text_of(dir / name).empty());
    EXPECT_EQ(text_of(dir / name), text_of(dir / "again/" + name)) << name;
  }
  ASSERT_EQ(softarm_program("validate --quick --seed 2 --only cable --out " + dir / "other").status, 0);
  EXPECT_NE(text_of(dir / "cable_marks.csv"), text_of(dir / "other/cable_marks.csv"));
}

TEST(SoftarmValidate, WrongCallsSayWhatIsWrongAndLeaveNothing) {
  const TestFolder dir;
  const Outcome unknown = softarm_program("validate --only cabel");
  EXPECT_NE(unknown.status, 0);
  EXPECT_THAT(unknown.err, HasSubstr("cabel"));
  EXPECT_TRUE(unknown.out.empty());
  const std::string file = dir.write("file", "");
  const Outcome blocked = softarm_program("validate --quick --only single_chamber --out " + file);
  EXPECT_NE(blocked.status, 0);
  EXPECT_THAT(blocked.err, HasSubstr(file));
  EXPECT_EQ(dir.entries(), 1u);
}

}  // namespace
}  // namespace softarm
