// Actuation that falls behind its input, and EI that grows with it: by hand, bounded, monotone, odd where the
// input is signed, and not there at all where the arm file does not speak of it.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "softarm/arm/arm_file.h"
#include "softarm/arm/constants.h"
#include "softarm/arm/laws.h"

namespace softarm {
namespace {

/// @param chamber,tendon,cable further keys of the first of each; of the segment, of its stiffness
std::string text(const std::string& chamber = "", const std::string& tendon = "",
                 const std::string& cable = "", const std::string& segment = "",
                 const std::string& stiffness = "") {
  return R"(format: 1
name: saturating
base: {body: base}
segments:
  - name: segment_1
    length_m: 0.2
    mass_per_length_kg_m: 1.0
    diameter_m: 0.04
    bending_stiffness: {base_nm2: 0.03)" +
         stiffness + "}\n" + segment + R"(
    chambers:
      - {input: p1, bending_direction_deg: 0, moment_gain_nm_per_pa: 6.0e-6)" +
         chamber + R"(}
      - {input: p2, bending_direction_deg: 90, moment_gain_nm_per_pa: 7.0e-6}
    tendons:
      - {input: t1, bending_direction_deg: 20, offset_m: 0.01)" +
         tendon + R"(}
      - {input: t2, bending_direction_deg: 110, offset_m: 0.012}
    cables:
      - {input: a1, bending_direction_deg: 0, curvature_gain_per_m_rad: 5)" +
         cable + R"(}
      - {input: a2, bending_direction_deg: 90, curvature_gain_per_m_rad: 4}
bodies:
  - {name: ring_1, arclength_m: tip}
inputs:
  pressures: [{name: p1, topic: /p1}, {name: p2, topic: /p2}]
  tensions: [{name: t1, topic: /t1}, {name: t2, topic: /t2}]
  angles: [{name: a1, topic: /a1}, {name: a2, topic: /a2}]
)";
}

arm::Arm parsed(const std::string& yaml) {
  return arm::parse_arm(yaml, "arm.yaml");
}

arm::SegmentPrediction at(const arm::Arm& arm, double p1, double p2, double t1, double t2, double a1,
                          double a2) {
  const auto p = arm::predict_segment(arm, arm.segments[0], {p1, p2, t1, t2, a1, a2});
  if (!p) throw std::runtime_error("no prediction");
  return *p;
}

const std::string kBoth =
    "    chambers_saturation_per_pa: 5.0e-6\n    tendons_saturation_per_n: 0.2\n"
    "    cables_saturation_per_rad: 0.5\n";

TEST(Saturation, ByHand) {
  const arm::Arm arm = parsed(
      text(", saturation_per_pa: 2.0e-5", ", saturation_per_n: 0.1", ", saturation_per_rad: 1.5", kBoth));
  const arm::SegmentPrediction chambers = at(arm, 20e3, 40e3, 0, 0, 0, 0);
  EXPECT_DOUBLE_EQ(chambers.moment_nm.x(), 0.12 / (1.0 + 0.4 + 0.3));
  EXPECT_DOUBLE_EQ(chambers.moment_nm.y(), 0.28 / (1.0 + 0.3));
  const arm::SegmentPrediction tendons = at(arm, 0, 0, 5.0, 2.0, 0, 0);
  const Eigen::Vector2d first(std::cos(M_PI / 9.0), std::sin(M_PI / 9.0)), second(-first.y(), first.x());
  EXPECT_LT((tendons.moment_nm - 0.05 / (1.0 + 0.5 + 1.4) * first - 0.024 / (1.0 + 1.4) * second).norm(),
            1e-15);
  EXPECT_DOUBLE_EQ(tendons.tendon_shear_stiffness_n, 7.0) << "a tension is what it is";
  const arm::SegmentPrediction cables = at(arm, 0, 0, 0, 0, -0.4, 0.2);
  EXPECT_DOUBLE_EQ(cables.curvature_per_m.x(), -2.0 / (1.0 + 0.6 + 0.3));
  EXPECT_DOUBLE_EQ(cables.curvature_per_m.y(), 0.8 / (1.0 + 0.3));
}

TEST(Saturation, GrowsWithItsOwnInputEverywhereAndKeepsItsSign) {
  std::mt19937_64 random(3);
  const auto draw = [&](double low, double high) {
    return std::exp(std::uniform_real_distribution<double>(std::log(low), std::log(high))(random));
  };
  arm::Arm arm = parsed(text());
  arm::Segment& segment = arm.segments[0];
  for (int k = 0; k < 2000; ++k) {
    segment.chambers[0].saturation_per_pa = draw(1e-8, 1e-2);
    segment.saturation.chambers_per_pa = draw(1e-8, 1e-2);
    segment.tendons[0].saturation_per_n = draw(1e-4, 100.0);
    segment.saturation.tendons_per_n = draw(1e-4, 100.0);
    segment.cables[0].saturation_per_rad = draw(1e-4, 100.0);
    segment.saturation.cables_per_rad = draw(1e-4, 100.0);
    const double p = draw(1.0, 1e6), t = draw(1e-3, 1e3), a = draw(1e-3, 1e2);
    const double p2 = draw(1.0, 1e6), t2 = 0.0, a2 = draw(1e-3, 1e2), more = 1.01;
    const arm::SegmentPrediction here = at(arm, p, p2, t, t2, a, a2);
    EXPECT_GT(here.moment_nm.x(), 0.0);
    EXPECT_GT(here.curvature_per_m.x(), 0.0);
    EXPECT_GT(at(arm, more * p, p2, 0, 0, 0, 0).moment_nm.x(), at(arm, p, p2, 0, 0, 0, 0).moment_nm.x());
    EXPECT_GT(at(arm, 0, 0, more * t, t2, 0, 0).moment_nm.x(), at(arm, 0, 0, t, t2, 0, 0).moment_nm.x());
    EXPECT_GT(at(arm, 0, 0, 0, 0, more * a, a2).curvature_per_m.x(), here.curvature_per_m.x());
    EXPECT_EQ(at(arm, 0, 0, 0, 0, -a, -a2).curvature_per_m, -here.curvature_per_m) << "odd";
  }
}

TEST(Saturation, OfInputsBelowZeroIsNone) {
  const arm::Arm arm =
      parsed(text(", saturation_per_pa: 2.0e-5, stiffness_gain_nm2_per_pa: 1.0e-7", "", "", kBoth,
                  ", per_mean_pressure_nm2_per_pa: 2.0e-7, per_tension_nm2_per_n: 0.01"));
  const arm::SegmentPrediction below = at(arm, -2e3, -1e3, -1.0, -2.0, 0, 0);
  EXPECT_DOUBLE_EQ(below.moment_nm.x(), -0.012) << "a sensor's zero, in proportion as without the law";
  EXPECT_DOUBLE_EQ(below.bending_stiffness_nm2, 0.03);
}

TEST(Saturation, StiffnessGrowthByHand) {
  const arm::Arm arm = parsed(text(
      ", stiffness_gain_nm2_per_pa: 1.0e-7", "", "", "",
      ", per_mean_pressure_nm2_per_pa: 2.0e-7, per_tension_nm2_per_n: 0.01, per_angle_nm2_per_rad: 0.02"));
  EXPECT_DOUBLE_EQ(at(arm, 20e3, 40e3, 0, 0, 0, 0).bending_stiffness_nm2, 0.03 + 0.002 + 0.006);
  EXPECT_DOUBLE_EQ(at(arm, 0, 0, 2.0, 1.0, 0, 0).bending_stiffness_nm2, 0.03 + 0.03);
  EXPECT_DOUBLE_EQ(at(arm, 0, 0, 0, 0, -0.5, 0.25).bending_stiffness_nm2, 0.03 + 0.015);
  EXPECT_TRUE(arm::stiffness_depends_on_inputs(arm.segments[0]));
  EXPECT_FALSE(arm::stiffness_depends_on_inputs(parsed(text()).segments[0]));
}

TEST(Saturation, StiffnessGrowsWithTheLowestAndWithEachByHand) {
  const arm::Arm arm =
      parsed(text("", ", stiffness_gain_nm2_per_n: 0.003", ", stiffness_gain_nm2_per_rad: 0.004", "",
                  ", per_min_tension_nm2_per_n: 0.01, per_min_angle_nm2_per_rad: 0.02"));
  EXPECT_DOUBLE_EQ(at(arm, 0, 0, 2.0, 1.5, 0, 0).bending_stiffness_nm2, 0.03 + 0.006 + 0.015);
  EXPECT_DOUBLE_EQ(at(arm, 0, 0, 2.0, -1.0, 0, 0).bending_stiffness_nm2, 0.03 + 0.006) << "slack: none";
  EXPECT_DOUBLE_EQ(at(arm, 0, 0, 0, 0, -0.5, 0.25).bending_stiffness_nm2, 0.03 + 0.002 + 0.005);
  EXPECT_TRUE(arm::stiffness_depends_on_inputs(arm.segments[0]));
}

/// Absent and 0 are the same law, to the last bit: the one without these keys.
TEST(Saturation, AbsentOrZeroIsTheLawWithout) {
  const arm::Arm without = parsed(text());
  const arm::Arm zero = parsed(text(", saturation_per_pa: 0, stiffness_gain_nm2_per_pa: 0",
                                    ", saturation_per_n: 0", ", saturation_per_rad: 0",
                                    "    chambers_saturation_per_pa: 0\n    tendons_saturation_per_n: 0\n"
                                    "    cables_saturation_per_rad: 0\n    joint_compliance_rad_per_nm: 0\n",
                                    ", per_mean_pressure_nm2_per_pa: 0, per_tension_nm2_per_n: 0, "
                                    "per_angle_nm2_per_rad: 0"));
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-1.0, 3.0);
  for (int k = 0; k < 200; ++k) {
    const double p1 = 1e4 * uniform(random), p2 = 1e4 * uniform(random), t1 = uniform(random),
                 a1 = uniform(random);
    const arm::SegmentPrediction x = at(without, p1, p2, t1, 0.3, a1, -0.2),
                                 y = at(zero, p1, p2, t1, 0.3, a1, -0.2);
    Eigen::Vector2d moment = 6.0e-6 * p1 * Eigen::Vector2d(1.0, 0.0);
    moment += 7.0e-6 * p2 * Eigen::Vector2d(std::cos(0.5 * M_PI), std::sin(0.5 * M_PI));
    const double slack = std::max(0.0, t1);
    moment +=
        slack * 0.01 * Eigen::Vector2d(std::cos(20.0 * (M_PI / 180.0)), std::sin(20.0 * (M_PI / 180.0)));
    moment +=
        0.3 * 0.012 * Eigen::Vector2d(std::cos(110.0 * (M_PI / 180.0)), std::sin(110.0 * (M_PI / 180.0)));
    EXPECT_LT((x.moment_nm - moment).norm(), 1e-15);
    EXPECT_EQ(x.moment_nm, y.moment_nm);
    EXPECT_EQ(x.curvature_per_m, y.curvature_per_m);
    EXPECT_EQ(x.bending_stiffness_nm2, y.bending_stiffness_nm2);
    EXPECT_EQ(x.length_m, y.length_m);
  }
}

TEST(Saturation, WhatIsStatedIsFreeByDefaultBeItZero) {
  const auto names = [](const arm::Arm& arm, const std::vector<arm::ConstantRef>& list) {
    std::string all;
    for (const arm::ConstantRef& one : list) all += arm::name_of(arm, one) + " ";
    return all;
  };
  const arm::Arm without = parsed(text());
  const std::string all = names(without, arm::constants_of(without)),
                    free = names(without, arm::default_free(without));
  for (const char* name :
       {"chamber_1.saturation", "chambers.saturation", "tendon_2.saturation", "tendons.saturation",
        "cable_1.saturation", "cables.saturation", "bending_stiffness.per_mean_pressure",
        "bending_stiffness.per_chamber_2", "bending_stiffness.per_tension", "bending_stiffness.per_angle",
        "bending_stiffness.per_min_tension", "bending_stiffness.per_tendon_2",
        "bending_stiffness.per_min_angle", "bending_stiffness.per_cable_1", "segment_1.joint_compliance"}) {
    EXPECT_NE(all.find(name), std::string::npos) << name;
    EXPECT_EQ(free.find(name), std::string::npos) << name;
  }
  const arm::Arm stated = parsed(text(", saturation_per_pa: 0", "", "", "    tendons_saturation_per_n: 0.1\n",
                                      ", per_angle_nm2_per_rad: 0"));
  const std::string now = names(stated, arm::default_free(stated));
  for (const char* name : {"chamber_1.saturation", "tendons.saturation", "bending_stiffness.per_angle"})
    EXPECT_NE(now.find(name), std::string::npos) << name;
  EXPECT_EQ(now.find("chamber_2.saturation"), std::string::npos);
}

TEST(Saturation, BadValuesGiveOneLine) {
  const auto refusal = [](const std::string& yaml) -> std::string {
    try {
      parsed(yaml);
    } catch (const arm::ArmError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(refusal(text(", saturation_per_pa: -1e-5")),
            "arm.yaml:12: key 'segments[0].chambers[0].saturation_per_pa': value -1e-5 is outside the "
            "allowed range "
            "[0, 0.01] 1/Pa");
  EXPECT_EQ(refusal(text("", ", saturation_per_n: many")),
            "arm.yaml:15: key 'segments[0].tendons[0].saturation_per_n': value 'many' is not a number in "
            "[0, 100] 1/N");
  for (const std::string& yaml :
       {text(", stiffness_gain_nm2_per_pa: -1"), text("", "", ", saturation_per_rad: 1000"),
        text("", "", "", "    chambers_saturation_per_pa: 1\n"),
        text("", "", "", "", ", per_tension_nm2_per_n: -0.1"),
        text("", "", "", "    joint_compliance_rad_per_nm: -0.1\n")}) {
    const std::string line = refusal(yaml);
    EXPECT_NE(line.find("is outside the allowed range"), std::string::npos) << line;
    EXPECT_EQ(line.find('\n'), std::string::npos);
  }
  // Of tendons where there are none.
  for (std::string yaml : {text("", "", "", "    tendons_saturation_per_n: 0\n"),
                           text("", "", "", "", ", per_tension_nm2_per_n: 0.1")}) {
    const std::size_t from = yaml.find("    tendons:\n");
    yaml.erase(from, yaml.find("    cables:\n") - from);
    EXPECT_NE(refusal(yaml).find("applies to segments with tendons only"), std::string::npos)
        << refusal(yaml);
  }
}

}  // namespace
}  // namespace softarm
