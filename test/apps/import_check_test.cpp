// What an import says of itself in its bag, and `softarm check` of it.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "program.h"

namespace softarm {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr char kBenchArm[] = R"(
format: 1
name: bench
base: {fixed: {attitude: hanging}}
segments:
  - name: only
    length_m: 0.2
    mass_per_length_kg_m: 0.1
    diameter_m: 0.04
    bending_stiffness: {base_nm2: 0.03}
    chambers:
      - {input: chamber_1, bending_direction_deg: 0, moment_gain_nm_per_pa: 8.0e-6}
payload: {default_kg: 0}
noise: {position_sd_m: 0.0005}
bodies: [{name: tip, arclength_m: tip}]
inputs: {pressures: [{name: chamber_1, topic: /pressure/chamber_1}]}
)";

/// An arm that answers a pressure in psi, off its zero by 0.4, at once; its poses are stamped by another
/// clock.
std::string recording(double seconds, double ahead_s) {
  std::string text;
  const auto psi = [](double t) {
    return t < 3.0 ? 0.0
                   : 1.5 + 1.4 * std::sin(0.9 * t + 3.0 * std::sin(0.113 * t)) * std::sin(0.031 * t + 1.0);
  };
  for (int k = 0; k < static_cast<int>(seconds * 50.0); ++k) {
    const double t = k / 50.0, bend = 0.3 * psi(t - ahead_s);
    const double off = 2e-4 * std::sin(1e3 * t * t);  // some noise
    text += fmt::format("{:.3f},{:.6f},{:.6f},{:.6f},{:.4f}\n", t, 0.1 * bend + off, off,
                        -0.2 * (1.0 - bend * bend / 6.0) - off, psi(t) + 0.4 + 0.004 * std::sin(1e4 * t * t));
  }
  return text;
}

std::string layout(const std::string& more_of_mocap = "", const std::string& more_of_input = "") {
  return "time: {column: 1, unit: s}\nmocap:\n  unit: m\n  up: z\n" + more_of_mocap +
         "  bodies: [{name: tip, position: [2, 3, 4]}]\n"
         "pressures:\n  unit: psi\n  reference: gauge\n  inputs: [{topic: /pressure/chamber_1, column: 5" +
         more_of_input + "}]\n";
}

Outcome check(const TestFolder& dir, const std::string& layout_text, const std::string& options = "") {
  const Outcome imported = softarm_program("import " + dir.write("layout.yaml", layout_text) + " " +
                                           dir / "a.csv" + " --out " + dir / "a.bag " + options);
  EXPECT_EQ(imported.status, 0) << imported.err;
  return softarm_program("check --arm " + dir.write("arm.yaml", kBenchArm) + " " + dir / "a.bag");
}

TEST(ImportAndCheck, AZeroIsSaidInTheUnitOfTheLayoutAndTakesItAwayThere) {
  const TestFolder dir;
  dir.write("a.csv", recording(40.0, 0.0));
  const std::string setting = "pressures.inputs[/pressure/chamber_1].zero: ", out = check(dir, layout()).out;
  const std::size_t at = out.find(setting);
  ASSERT_NE(at, std::string::npos) << out;
  EXPECT_NEAR(std::stod(out.substr(at + setting.size())), 0.4, 0.005);
  EXPECT_THAT(check(dir, layout("", ", zero: 0.4")).out, Not(HasSubstr("zero is off")));
}

TEST(ImportAndCheck, AWrongUnitOfThePositionsIsTheLayoutsToRepair) {
  const TestFolder dir;
  dir.write("a.csv", recording(40.0, 0.0));
  std::string text = layout();
  text.replace(text.find("unit: m\n"), 7, "unit: mm");
  const Outcome wrong = check(dir, text);
  EXPECT_EQ(wrong.status, 1);
  EXPECT_THAT(wrong.out, HasSubstr("mocap.unit: m (of the layout)"));
  EXPECT_THAT(check(dir, layout()).out, Not(HasSubstr("times as far apart")));
}

TEST(ImportAndCheck, WhatWasLeftOutIsNoGap) {
  const TestFolder dir;
  dir.write("a.csv", recording(40.0, 0.0));
  const std::string out = check(dir, layout(), "--leave-out 12:20").out;
  EXPECT_THAT(out, HasSubstr("the import left out 8.0 s"));
  EXPECT_THAT(out, Not(HasSubstr("nothing for up to")));
}

TEST(ImportAndCheck, ClocksThatAreFarApartAreRepairedByTheLayout) {
  for (const double ahead_s : {26.0, -26.0}) {
    SCOPED_TRACE(ahead_s);
    const TestFolder dir;
    dir.write("a.csv", recording(150.0, ahead_s));
    const Outcome o = check(dir, layout());
    EXPECT_EQ(o.status, 1);
    const std::string key = "mocap.ahead_s: ";
    const std::size_t at = o.out.find(key);
    ASSERT_NE(at, std::string::npos) << o.out;
    const double said_s = std::stod(o.out.substr(at + key.size()));
    EXPECT_NEAR(said_s, ahead_s, 0.05);
    const Outcome repaired = check(dir, layout("  ahead_s: " + std::to_string(said_s) + "\n"));
    EXPECT_EQ(repaired.status, 0) << repaired.out;
    EXPECT_THAT(repaired.out, Not(HasSubstr("different times")));
    EXPECT_THAT(repaired.out, Not(HasSubstr("nothing for up to")));
  }
}

}  // namespace
}  // namespace softarm
