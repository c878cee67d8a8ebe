#include "estimate/estimates_csv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/algorithm/string.hpp>
#include <fstream>
#include <iterator>
#include <limits>
#include <sstream>

#include "estimate/estimate_summary.h"

namespace softarm {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> result;
  boost::split(result, line, [](char c) { return c == ','; });
  return result;
}

std::vector<std::string> rows(const estimate::Estimate& e, std::size_t segments) {
  std::ostringstream out;
  estimate::write_estimate_rows(out, e, segments);
  std::vector<std::string> result;
  const std::string text = out.str();
  boost::split(result, text, [](char c) { return c == '\n'; });
  result.pop_back();
  return result;
}

/// A quarter circle in the x-z plane, bent by M0.
estimate::Estimate quarter_circle() {
  estimate::Estimate e;
  e.stamp_s = 1600000000.1234567;
  e.status = estimate::Status::kOk;
  estimate::SegmentEstimate s;
  s.moment_nm = 0.25;
  s.direction_rad = -1.5;
  s.bending_stiffness_nm2 = 0.0312345678912;
  s.length_m = 0.2;
  s.sd_moment_nm = 0.01;
  s.identifiable_stiffness = true;
  e.segments = {s};
  e.payload_kg = 0.15;
  estimate::BackbonePoint base, tip;
  tip.arclength_m = 0.2;
  tip.p_base = Eigen::Vector3d(0.127, 0.0, 0.127);
  tip.q_base = Eigen::AngleAxisd(std::acos(0.0), Eigen::Vector3d::UnitY());
  e.backbone = {base, tip};
  e.residuals.resize(1);
  e.rms_residual_m = 4e-4;
  return e;
}

TEST(EstimatesCsv, HeaderIsThatOfTheContract) {
  EXPECT_EQ(estimate::estimates_csv_header(),
            "stamp,segment,status,M0,phi,EI,L,payload,sd_M0,sd_phi,sd_EI,sd_L,sd_payload,identifiable_EI,"
            "identifiable_payload,"
            "theta_tip,tip_x,tip_y,tip_z,rms_residual,settling");
}

/// The table of the columns as the page has it.
std::string table_of_columns() {
  std::string table = "| column | unit | meaning |\n|---|---|---|\n";
  for (const estimate::EstimateColumn& column : estimate::estimate_columns()) {
    table += std::string("| `") + column.name + "` | " + column.unit + (*column.unit ? " | " : "| ") +
             column.meaning + " |\n";
  }
  return table;
}

TEST(EstimatesCsv, ThePageHasTheTableOfTheColumns) {
  std::ifstream file(SOFTARM_SOURCE_DIR "/doc/estimates_csv.md");
  const std::string page((std::istreambuf_iterator<char>(file)), {});
  EXPECT_THAT(page, HasSubstr(table_of_columns())) << "put this table into doc/estimates_csv.md";
}

TEST(EstimatesCsv, CellsStandUnderTheirNames) {
  const auto names = cells(estimate::estimates_csv_header());
  const auto all = rows(quarter_circle(), 1);
  ASSERT_EQ(all.size(), 1u);
  const auto row = cells(all[0]);
  ASSERT_EQ(row.size(), names.size());
  const auto cell = [&](const std::string& name) {
    return row.at(static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin()));
  };
  EXPECT_NEAR(std::stod(cell("stamp")) - 1600000000.0, 0.1234567, 2.5e-7);
  EXPECT_EQ(cell("segment"), "1");
  EXPECT_EQ(cell("status"), "ok");
  EXPECT_EQ(cell("M0"), "0.25");
  EXPECT_EQ(cell("phi"), "-1.5");
  EXPECT_EQ(cell("EI"), "0.0312345679");
  EXPECT_EQ(cell("L"), "0.2");
  EXPECT_EQ(cell("payload"), "0.15");
  EXPECT_EQ(cell("sd_M0"), "0.01");
  EXPECT_EQ(cell("sd_EI"), "");
  EXPECT_EQ(cell("sd_payload"), "");
  EXPECT_EQ(cell("identifiable_EI"), "1");
  EXPECT_EQ(cell("identifiable_payload"), "0");
  EXPECT_NEAR(std::stod(cell("theta_tip")), std::acos(0.0), 1e-8);
  EXPECT_EQ(cell("tip_x"), "0.127");
  EXPECT_EQ(cell("tip_y"), "0");
  EXPECT_EQ(cell("rms_residual"), "0.0004");
  EXPECT_EQ(cell("settling"), "0");
}

TEST(EstimatesCsv, NoEstimateHasARowPerSegmentWithEmptyCells) {
  estimate::Estimate e;
  e.stamp_s = 12.5;
  e.status = estimate::Status::kNotEnoughBodies;
  const auto all = rows(e, 2);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[1], "12.5000000,2," + to_string(e.status) + ",,,,,,,,,,,0,0,,,,,,0");
  EXPECT_EQ(cells(all[1]).size(), cells(estimate::estimates_csv_header()).size());
}

TEST(EstimatesCsv, NotANumberIsAnEmptyCell) {
  estimate::Estimate e = quarter_circle();
  e.payload_kg = std::numeric_limits<double>::quiet_NaN();
  e.segments[0].sd_length_m = std::numeric_limits<double>::infinity();
  const std::string row = rows(e, 1)[0];
  EXPECT_EQ(row.find("nan"), std::string::npos);
  EXPECT_EQ(row.find("inf"), std::string::npos);
}

/// One segment, a ring in its middle and one at its tip.
arm::Arm arm_of(arm::Unknown unknown) {
  arm::Arm arm;
  arm.segments.resize(1);
  arm.bodies.resize(2);
  arm.bodies[0].name = "ring_1";
  arm.bodies[1].name = "ring_2";
  arm.estimator.method = arm::Method::kFullPoints;
  arm.estimator.unknown = unknown;
  return arm;
}

/// The line of a table that begins with a name and a colon, without its padding; "" if there is none.
std::string line_of(const std::string& table, const std::string& name) {
  std::istringstream in(table);
  for (std::string line; std::getline(in, line);) {
    if (line.rfind(name + ":", 0) == 0) return boost::trim_copy(line.substr(name.size() + 1));
  }
  return "";
}

TEST(EstimateSummary, NamesBodiesThatAreSetAside) {
  estimate::EstimateSummary summary(arm_of(arm::Unknown::kStiffness));
  for (int i = 0; i < 4; ++i) {
    estimate::Estimate e = quarter_circle();
    e.residuals.resize(2);
    e.residuals[1].body = 1;
    e.residuals[1].used = i == 0;
    summary.add(e);
  }
  const std::string text = summary.text({}, 8);
  EXPECT_THAT(line_of(text, "set aside"), StartsWith("ring_2 in 3 frames (75 %); is its arclength_m right"));
  EXPECT_THAT(text, Not(HasSubstr("ring_1")));
}

TEST(EstimateSummary, NamesBodiesThatAreTooFarAndHasThemInNoStatistics) {
  arm::Arm arm = arm_of(arm::Unknown::kStiffness);
  arm.segments[0].length_m = 0.2;
  estimate::EstimateSummary summary(arm), without(arm);
  for (int i = 0; i < 4; ++i) {
    estimate::Estimate e = quarter_circle();
    without.add(e);
    if (i > 0) e.too_far = {{1, 12.0 + i}};
    summary.add(e);
  }
  const std::string text = summary.text({}, 8), plain = without.text({}, 8);
  EXPECT_THAT(line_of(text, "too far"),
              StartsWith("ring_2 in 3 frames (75 %), at first 13 m from the base of an arm of 0.2 m; "));
  EXPECT_EQ(line_of(plain, "too far"), "");
  EXPECT_EQ(line_of(text, "set aside"), "");
  EXPECT_EQ(line_of(text, "rms residual, median"), line_of(plain, "rms residual, median"));
}

TEST(EstimateSummary, SaysWhatWasKnown) {
  estimate::EstimateSummary stiffness(arm_of(arm::Unknown::kStiffness)),
      payload(arm_of(arm::Unknown::kPayload));
  stiffness.add(quarter_circle());
  payload.add(quarter_circle());
  const std::string payload_known = stiffness.text({}, 1), stiffness_known = payload.text({}, 1);
  EXPECT_EQ(line_of(payload_known, "payload, median"), "0.15 kg (known)");
  EXPECT_EQ(line_of(payload_known, "EI, median"), "0.03123 N m^2");
  EXPECT_EQ(line_of(payload_known, "  identifiable in"), "1 frames (100.0 %)");
  EXPECT_EQ(payload_known.find("identifiable in"), payload_known.rfind("identifiable in")) << "of EI only";
  EXPECT_EQ(line_of(stiffness_known, "EI, median"), "0.03123 N m^2 (known)");
  EXPECT_EQ(line_of(stiffness_known, "payload, median"), "0.15 kg");
  EXPECT_EQ(line_of(stiffness_known, "  identifiable in"), "0 frames (0.0 %)");
}

TEST(EstimateSummary, WhatWouldTellTheStiffnessIsNotWhatIsDoneAlready) {
  const auto advice = [](arm::Unknown unknown) {
    arm::Arm arm = arm_of(unknown);
    arm.estimator.prior.enabled = unknown != arm::Unknown::kStiffness;
    estimate::EstimateSummary summary(arm);
    estimate::Estimate e = quarter_circle();
    e.segments[0].identifiable_stiffness = false;
    e.segments[0].stiffness_why_not = estimate::WhyNot::kNotDetermined;
    summary.add(e);
    return line_of(summary.text({}, 1), "  not in");
  };
  EXPECT_THAT(advice(arm::Unknown::kStiffness), HasSubstr("(--unknown payload)"));
  EXPECT_THAT(advice(arm::Unknown::kPayload),
              HasSubstr("(--unknown stiffness), or hold EI by the laws (--prior off)"));
  EXPECT_THAT(advice(arm::Unknown::kPayload), Not(HasSubstr("--unknown payload")));
  EXPECT_THAT(advice(arm::Unknown::kBoth), HasSubstr("(--unknown payload --prior off)"));
}

TEST(EstimateSummary, AnEiThatIsNotIdentifiableIsProposedToBeHeldInTheLaws) {
  for (const estimate::WhyNot why :
       {estimate::WhyNot::kByLawsAlone, estimate::WhyNot::kNearBuckling, estimate::WhyNot::kNotDetermined}) {
    arm::Arm arm = arm_of(arm::Unknown::kBoth);
    arm.segments[0].name = "segment_1";
    estimate::EstimateSummary summary(arm);
    estimate::Estimate e = quarter_circle();
    e.segments[0].identifiable_stiffness = false;
    e.segments[0].stiffness_why_not = why;
    summary.add(e);
    const std::string text = summary.text({}, 1);
    EXPECT_THAT(line_of(text, "  not in"), HasSubstr("weigh the payload and state it"));
    EXPECT_THAT(line_of(text, "  laws of an EI that is held"),
                HasSubstr("softarm identify ... --hold 'segment_1.bending_stiffness.*'"));
  }
}

TEST(EstimateSummary, CountsReasonsAndTakesMediansOverGoodFrames) {
  estimate::EstimateSummary summary(arm_of(arm::Unknown::kStiffness));
  for (int i = 0; i < 5; ++i) {
    estimate::Estimate e = quarter_circle();
    e.stamp_s = 10.0 + i;
    e.segments[0].bending_stiffness_nm2 = 0.02 + 0.01 * i;  // median 0.04
    e.segments[0].identifiable_stiffness = i >= 3;          // 0.05, 0.06
    summary.add(e);
  }
  estimate::Estimate lost;
  lost.stamp_s = 15.0;
  lost.status = estimate::Status::kNoBasePose;
  summary.add(lost);
  const std::string text = summary.text({{"frozen tip", 7}}, 42);
  EXPECT_EQ(summary.frames(), 6u);
  EXPECT_EQ(summary.ok(), 5u);
  EXPECT_DOUBLE_EQ(summary.duration_s(), 5.0);
  EXPECT_THAT(text, HasSubstr("0.04 N m^2"));
  EXPECT_THAT(text, HasSubstr("2 frames (40.0 %)"));
  EXPECT_THAT(text, HasSubstr("0.055 N m^2"));
  EXPECT_THAT(text, HasSubstr("not ok, " + to_string(estimate::Status::kNoBasePose)));
  EXPECT_THAT(text, HasSubstr("rejected, frozen tip"));
}

}  // namespace
}  // namespace softarm
