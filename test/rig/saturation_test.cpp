// The rig's own saturation of actuators and growth of EI, by hand, and what a scenario says of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "rig/laws.h"
#include "rig/truth_yaml.h"

namespace softarm::rig {
namespace {

using ::testing::HasSubstr;

std::string text(const std::string& chamber, const std::string& saturation, const std::string& growth) {
  return R"(format: 1
name: saturating
duration_s: 0
arm:
  length_m: 0.2
  mass_kg: 0.2
  bending_stiffness:
    base_nm2: 0.03
)" + growth +
         saturation +
         R"(  chambers:
    - {bending_direction_deg: 0, moment_gain_nm_per_pa: 6.0e-6)" +
         chamber + R"(}
    - {bending_direction_deg: 90, moment_gain_nm_per_pa: 7.0e-6}
  tendons: [{azimuth_deg: 0, offset_m: 0.01, saturation_n: 4}]
  cables: [{azimuth_deg: 0, lever_m: 0.02, spool_radius_m: 0.01, saturation_rad: 2}]
pressures: {schedule: [{t_s: 0, pressures_pa: [0, 0]}]}
tensions: {schedule: [{t_s: 0, tensions_n: [0]}]}
angles: {schedule: [{t_s: 0, angles_rad: [0]}]}
)";
}

const std::string kGrowth =
    "    growth: [{added_nm2: 0.01, at_pa: 20000, exponent: 0.5}, {added_nm2: 0.02, at_pa: "
    "10000, chamber: 2}, {added_nm2: 0.001, at_n: 1}, {added_nm2: 0.002, at_rad: 1}]\n";

Actuation acting(const Scenario& scenario, double p1, double p2, double tension, double angle) {
  Acting now;
  now.pressures_pa = {p1, p2};
  now.tensions_n = {tension};
  now.angles_rad = {angle};
  return apply_laws(scenario.arm.segments[0], now);
}

TEST(RigSaturation, ByHandInBothForms) {
  for (const bool exponential : {true, false}) {
    const std::string form = exponential ? "exponential" : "hyperbolic";
    const Scenario s = parse_scenario(
        text(", saturation_pa: 50000", "  saturation: {form: " + form + ", chambers_pa: 200000}\n", ""),
        "s.yaml");
    const auto share = [&](double z) { return exponential ? (1.0 - std::exp(-z)) / z : 1.0 / (1.0 + z); };
    const Actuation chambers = acting(s, 20e3, 60e3, 0.0, 0.0);
    EXPECT_NEAR(chambers.moment_nm.x(), 0.12 * share(0.4 + 0.4), 1e-15);
    EXPECT_NEAR(chambers.moment_nm.y(), 0.42 * share(0.4), 1e-15);
    EXPECT_NEAR(acting(s, 0, 0, 2.0, 0.0).moment_nm.x(), 0.02 * share(0.5), 1e-15);
    EXPECT_NEAR(acting(s, 0, 0, 0, -1.0).moment_nm.x(), -0.03 * 0.01 / (0.2 * 0.02) * share(0.5), 1e-15);
  }
}

TEST(RigSaturation, GrowthByHand) {
  const Scenario s = parse_scenario(text("", "", kGrowth), "s.yaml");
  EXPECT_NEAR(acting(s, 0, 0, 0, 0).bending_stiffness_nm2, 0.03, 1e-15);
  EXPECT_NEAR(acting(s, 10e3, 0, 0, 0).bending_stiffness_nm2, 0.03 + 0.01 * std::sqrt(0.25), 1e-15);
  EXPECT_NEAR(acting(s, 0, 10e3, 3.0, -2.0).bending_stiffness_nm2, 0.03 + 0.005 + 0.02 + 0.003 + 0.004,
              1e-15);
}

TEST(RigSaturation, GrowthWithTheLowestAndWithOneAlone) {
  const std::string growth =
      "    growth: [{added_nm2: 0.01, at_pa: 20000, exponent: 0.5, lowest: true}, {added_nm2: 0.02, at_n: 2, "
      "tendon: 1}, {added_nm2: 0.03, at_rad: 2, cable: 1}]\n";
  const Scenario s = parse_scenario(text("", "", growth), "s.yaml");
  EXPECT_NEAR(acting(s, 40e3, 5e3, 0, 0).bending_stiffness_nm2, 0.03 + 0.01 * 0.5, 1e-15);
  EXPECT_NEAR(acting(s, 40e3, 0, 1.0, -0.5).bending_stiffness_nm2, 0.03 + 0.01 + 0.0075, 1e-15);
  EXPECT_THAT(truth_yaml(s), HasSubstr("by: lowest_pressure"));
  EXPECT_THAT(truth_yaml(s), HasSubstr("by: tendon_1"));
  EXPECT_THAT(truth_yaml(s), HasSubstr("by: cable_1"));
}

TEST(RigSaturation, IsInTheTruthAndRefusedInOneLine) {
  const std::string truth = truth_yaml(parse_scenario(
      text(", saturation_pa: 51234", "  saturation: {chambers_pa: 212345}\n", kGrowth), "s.yaml"));
  for (const char* words :
       {"saturation_pa: 51234", "chambers_pa: 212345", "form: exponential", "by: chamber_2"})
    EXPECT_THAT(truth, HasSubstr(words));
  const auto refusal = [](const std::string& yaml) -> std::string {
    try {
      parse_scenario(yaml, "s.yaml");
    } catch (const ScenarioError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_THAT(refusal(text(", saturation_pa: -1", "", "")), HasSubstr("saturation_pa"));
  EXPECT_THAT(refusal(text("", "  saturation: {form: cubic}\n", "")),
              HasSubstr("allowed exponential, hyperbolic"));
  EXPECT_THAT(refusal(text("", "", "    growth: [{added_nm2: 0.01, at_pa: 1000, chamber: 3}]\n")),
              HasSubstr("chamber"));
}

}  // namespace
}  // namespace softarm::rig
