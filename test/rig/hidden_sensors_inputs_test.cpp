// Sensors of the inputs: published is what is commanded, through their errors; the arm does not notice.
#include <gtest/gtest.h>

#include <cmath>

#include "rig/hidden_sensors.h"

namespace softarm::rig {
namespace {

constexpr double kAmbientPa = 101325.0;

/// Published values of chamber i (from 0) with and without the faults; the arm moves the same.
struct Both {
  std::vector<InputSample> with, without;
};
Both chamber(const Scenario& faulty, int number) {
  Scenario ideal = faulty;
  ideal.sensors = {};
  const std::vector<Sample> one = samples_of(faulty), other = samples_of(ideal);
  EXPECT_EQ(one.back().truth.tip_base.p, other.back().truth.tip_base.p);
  return {inputs_of(one, InputKind::kChamber, number), inputs_of(other, InputKind::kChamber, number)};
}

TEST(HiddenSensorsInputs, OffsetAndGainActOnGaugePressure) {
  Scenario s = quiet(5.0);
  hide("pressure_offset", {{"number", 2}, {"offset_pa", -1500.0}}, s, "pressure");
  hide("sensor_gain", {{"number", 2}, {"share", 0.04}}, s, "pressure");
  const Both second = chamber(s, 1), third = chamber(s, 2);
  ASSERT_EQ(second.with.size(), second.without.size());
  for (std::size_t k = 0; k < second.with.size(); ++k)
    EXPECT_NEAR(second.with[k].value - kAmbientPa, 1.04 * (second.without[k].value - kAmbientPa) - 1500.0,
                1e-6);
  EXPECT_NEAR(second.with[0].value, kAmbientPa - 1500.0, 1e-6);  // at rest
  EXPECT_EQ(values_of(third.with), values_of(third.without));
}

TEST(HiddenSensorsInputs, VacuumAndTensionsHaveSensorsToo) {
  Scenario s = quiet(3.0);
  s.vacuum.schedule = {{0.0, {40e3}}};
  s.arm.segments[0].tendons = {{0, 0.0, 0.005}, {1, 2.0, 0.005}};
  s.arm.tendons = 2;
  s.tensions.schedule = {{0.0, {1.0, 0.5}}};
  s.tensions.settle_s = s.tensions.ramp_s = 0.2;
  hide("pressure_offset", {{"offset_pa", 700.0}}, s, "vacuum");
  hide("tension_offset", {{"number", 1}, {"offset_n", 0.05}}, s);
  hide("sensor_gain", {{"number", 2}, {"share", -0.5}}, s, "tension");
  const std::vector<Sample> samples = samples_of(s);
  const Truth& middle = samples[samples.size() / 2].truth;
  EXPECT_NEAR(inputs_of(samples, InputKind::kVacuum, 0).back().value, kAmbientPa - 40e3 + 700.0, 1e-6);
  EXPECT_NEAR(inputs_of(samples, InputKind::kTendon, 0)[75].value, middle.tensions_n[0] + 0.05, 1e-12);
  EXPECT_NEAR(inputs_of(samples, InputKind::kTendon, 1)[75].value, 0.5 * middle.tensions_n[1], 1e-12);
  EXPECT_GT(middle.tensions_n[1], 0.4);
}

TEST(HiddenSensorsInputs, QuantisedValuesAreMultiplesOfTheStep) {
  Scenario s = quiet(6.0);
  hide("sensor_quantisation", {{"number", 1}, {"step_pa", 250.0}}, s, "pressure");
  const Both first = chamber(s, 0);
  double largest = 0.0;
  for (std::size_t k = 0; k < first.with.size(); ++k) {
    const double steps = (first.with[k].value - kAmbientPa) / 250.0;
    EXPECT_NEAR(steps, std::round(steps), 1e-9);
    largest = std::max(largest, std::abs(first.with[k].value - first.without[k].value));
  }
  EXPECT_LE(largest, 125.0 + 1e-9);
  EXPECT_GT(largest, 100.0);
}

TEST(HiddenSensorsInputs, NoiseIsWhiteAndHasItsSize) {
  Scenario s = resting(60.0);
  s.pressures.rate_hz = 100.0;
  hide("sensor_noise", {{"sd_pa", 200.0}}, s, "pressure");
  const Both one = chamber(s, 0), other = chamber(s, 1);
  double square = 0.0, lagged = 0.0, across = 0.0, last = 0.0;
  for (std::size_t k = 0; k < one.with.size(); ++k) {
    const double e = one.with[k].value - one.without[k].value;
    square += e * e;
    lagged += e * last;
    across += e * (other.with[k].value - other.without[k].value);
    last = e;
  }
  const double n = static_cast<double>(one.with.size());
  ASSERT_GT(n, 5900.0);
  EXPECT_NEAR(std::sqrt(square / n), 200.0, 8.0);
  EXPECT_NEAR(lagged / square, 0.0, 0.06);
  EXPECT_NEAR(across / square, 0.0, 0.06);
}

TEST(HiddenSensorsInputs, AStuckSensorRepeatsItselfAndADeadOneIsSilent) {
  Scenario s = quiet(6.0);
  hide("sensor_stuck", {{"number", 1}, {"from_s", 3.0}, {"for_s", 1.0}}, s, "pressure");
  hide("sensor_dead", {{"number", 2}, {"from_s", 4.0}}, s, "pressure");
  const Both stuck = chamber(s, 0), dead = chamber(s, 1);
  ASSERT_EQ(stuck.with.size(), 301u);
  for (std::size_t k = 1; k < stuck.with.size(); ++k) {
    const double t = stuck.with[k].stamp_s;
    if (t >= 3.0 && t < 4.0)
      EXPECT_EQ(stuck.with[k].value, stuck.with[k - 1].value);
    else
      EXPECT_EQ(stuck.with[k].value, stuck.without[k].value);
  }
  EXPECT_NE(stuck.with[160].value, stuck.without[160].value);
  ASSERT_EQ(dead.with.size(), 200u);  // up to 3.98 s
  EXPECT_LT(dead.with.back().stamp_s, 4.0);
}

TEST(HiddenSensorsInputs, ErrorsAddUp) {
  // Gain, then offset, then the step.
  Scenario s = quiet(4.0);
  hide("sensor_quantisation", {{"step_pa", 100.0}}, s, "pressure");
  hide("pressure_offset", {{"offset_pa", 130.0}}, s, "pressure");
  hide("pressure_offset", {{"number", 1}, {"offset_pa", 20.0}}, s, "pressure");
  hide("sensor_gain", {{"share", 0.1}}, s, "pressure");
  const Both first = chamber(s, 0);
  for (std::size_t k = 0; k < first.with.size(); ++k) {
    const double expected = 100.0 * std::round((1.1 * (first.without[k].value - kAmbientPa) + 150.0) / 100.0);
    EXPECT_NEAR(first.with[k].value - kAmbientPa, expected, 1e-6);
  }
}

}  // namespace
}  // namespace softarm::rig
