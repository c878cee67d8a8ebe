// Scenarios with every kind of actuation, several segments and what is hidden in them, through the whole rig.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "rig/simulator.h"
#include "rig/truth_csv.h"

namespace softarm::rig {
namespace {

using ::testing::HasSubstr;

/// A scenario without gravity, noise or damping of the air.
std::string scenario_text(const std::string& arm, const std::string& rest) {
  return "format: 1\nname: case\nduration_s: 10\ngravity_m_s2: 0\narm:\n" + arm +
         "mount: {attitude: horizontal}\n"
         "mocap:\n  rate_hz: 40\n  ring_fractions: [0.5, 1.0]\n  position_sd_m: 0\n  orientation_sd_rad: 0\n"
         "  base: {position_sd_m: 0, orientation_sd_rad: 0}\n"
         "numerics: {max_step_s: 0.0021}\n" +
         rest;
}

std::vector<Sample> run(const std::string& text) {
  Simulator simulator(parse_scenario(text, "case.yaml"));
  std::vector<Sample> samples;
  while (std::optional<Sample> sample = simulator.next()) samples.push_back(*sample);
  return samples;
}

constexpr char kTendonArm[] = R"(  length_m: 0.085
  mass_kg: 0.0096
  diameter_m: 0.012
  bending_stiffness: {base_nm2: 6.5e-4}
  torsional_stiffness_nm2: 4.3e-4
  tendons:
    - {input: tendon_1, azimuth_deg: 0, offset_m: 0.004}
    - {input: tendon_2, azimuth_deg: 120, offset_m: 0.004}
    - {input: tendon_3, azimuth_deg: -120, offset_m: 0.004}
)";

TEST(Actuation, ATendonBendsToACircleTowardsItsAzimuth) {
  for (int tendon = 0; tendon < 3; ++tendon) {
    const std::string setpoints[] = {"[3, 0, 0]", "[0, 3, 0]", "[0, 0, 3]"};
    const std::vector<Sample> samples = run(scenario_text(
        kTendonArm, "tensions: {schedule: [{t_s: 0, tensions_n: " + setpoints[tendon] + "}]}\n"));
    const Sample& middle = samples[samples.size() / 2];
    const double curvature = 3.0 * 0.004 / 6.5e-4, angle = curvature * 0.085;
    const double azimuth = tendon * 2.0 * M_PI / 3.0;
    EXPECT_NEAR(middle.truth.tip_angle_rad, angle, 1e-5);
    const double radius = (1.0 - std::cos(angle)) / curvature;
    const Eigen::Vector3d expected(radius * std::cos(azimuth), radius * std::sin(azimuth),
                                   std::sin(angle) / curvature);
    EXPECT_LT((middle.truth.tip_base.p - expected).norm(), 1e-6);
  }
}

TEST(Actuation, TensionsAreMessagesAndTruth) {
  const std::vector<Sample> samples = run(scenario_text(
      kTendonArm,
      "tensions: {rate_hz: 20, random: {min_n: [0, 1, 0], max_n: [1, 2, 3], highest_hz: 0.5}}\n"));
  std::size_t messages = 0;
  double last = -1.0, most[3] = {0.0, 0.0, 0.0};
  for (const Sample& sample : samples) {
    for (const InputSample& input : sample.inputs) {
      EXPECT_EQ(input.kind, InputKind::kTendon);
      EXPECT_GE(input.stamp_s, last);
      EXPECT_LE(input.stamp_s, sample.stamp_s);
      if (input.stamp_s == sample.stamp_s) {
        EXPECT_EQ(input.value, sample.truth.tensions_n.at(static_cast<std::size_t>(input.number)));
      }
      most[input.number] = std::max(most[input.number], input.value);
      last = input.stamp_s;
      ++messages;
    }
  }
  EXPECT_EQ(messages, 3u * 201u);
  for (int i = 0; i < 3; ++i) {
    EXPECT_LE(most[i], i + 1.0);
    EXPECT_GT(most[i], 0.6 * (i + 1.0));
  }
  EXPECT_EQ(topic_of(InputKind::kTendon, 2), "/tendon/3/tension");
  EXPECT_EQ(topic_of(InputKind::kServo, 0), "/servo/1/angle");
  EXPECT_EQ(topic_of(InputKind::kChamber, 0), "/pressure/chamber_1");
  EXPECT_EQ(topic_of(InputKind::kVacuum, 0), "/pressure/vacuum");
}

TEST(Actuation, AServoTurnsTheTipBySpoolOverLever) {
  const std::vector<Sample> samples = run(
      scenario_text("  length_m: 0.235\n  mass_kg: 0.03\n  bending_stiffness: {base_nm2: 0.007}\n"
                    "  cables: [{input: servo_1, azimuth_deg: 90, lever_m: 0.01, spool_radius_m: 0.02}]\n",
                    "angles: {schedule: [{t_s: 0, angles_rad: [0.6]}]}\n"));
  const Truth& middle = samples[samples.size() / 2].truth;
  EXPECT_NEAR(middle.tip_angle_rad, 1.2, 1e-5);
  EXPECT_NEAR(std::atan2(middle.tip_base.p.y(), middle.tip_base.p.x()), M_PI / 2.0, 1e-6);
  EXPECT_NEAR(middle.segments[0].moment_nm.y(), 0.007 * 1.2 / 0.235, 1e-9);
  EXPECT_DOUBLE_EQ(middle.angles_rad.at(0), 0.6);
}

constexpr char kTwoSegments[] = R"(  segments:
    - length_m: 0.12
      mass_kg: 0.12
      bending_stiffness: {base_nm2: 0.027}
      chambers:
        - {input: chamber_1, bending_direction_deg: 0, moment_gain_nm_per_pa: 6.1e-6, near_elongation_m_per_pa: 2.0e-7}
        - {input: chamber_2, bending_direction_deg: 90, moment_gain_nm_per_pa: 6.1e-6}
    - length_m: 0.08
      mass_kg: 0.05
      diameter_m: 0.03
      bending_stiffness: {base_nm2: 0.012}
      tendons: [{input: tendon_1, azimuth_deg: 180, offset_m: 0.012}]
)";

TEST(Actuation, SegmentsBendByThemselves) {
  const std::vector<Sample> samples =
      run(scenario_text(kTwoSegments,
                        "pressures: {schedule: [{t_s: 0, pressures_pa: [30e3, 0]}]}\n"
                        "tensions: {schedule: [{t_s: 0, tensions_n: [6]}]}\n"));
  const Truth& truth = samples[samples.size() / 2].truth;
  ASSERT_EQ(truth.segments.size(), 2u);
  EXPECT_NEAR(truth.segments[0].length_m, 0.126, 1e-12);
  EXPECT_NEAR(truth.segments[1].length_m, 0.08, 1e-12);
  EXPECT_NEAR(truth.segments[1].moment_nm.x(), -0.072, 1e-12);
  const double first = 6.1e-6 * 30e3 / 0.027 * 0.126, second = -0.072 / 0.012 * 0.08;
  EXPECT_NEAR(truth.tip_angle_rad, first + second, 1e-5);
  // Rings sit where they sat at rest; the backbone's points are at equal arclengths.
  const double at_ring = 6.1e-6 * 30e3 / 0.027 * 0.1 * 1.05;
  EXPECT_NEAR(2.0 * std::atan2(truth.rings_base[0].q.y(), truth.rings_base[0].q.w()), at_ring, 1e-5);
  for (std::size_t i = 1; i < truth.backbone_base.size(); ++i)
    EXPECT_NEAR((truth.backbone_base[i] - truth.backbone_base[i - 1]).norm(), 0.206 / 20.0, 2e-5);
}

TEST(Actuation, TruthOfSeveralSegmentsIsInTheCsv) {
  const Scenario scenario = parse_scenario(
      scenario_text(kTwoSegments, "tensions: {schedule: [{t_s: 0, tensions_n: [6]}]}\n"), "case.yaml");
  Simulator simulator(scenario);
  std::optional<Sample> sample;
  for (int i = 0; i < 200; ++i) sample = simulator.next();
  std::ostringstream out;
  write_truth_header(out, scenario);
  write_truth_row(out, sample->truth);
  const std::string text = out.str();
  const std::size_t end = text.find('\n');
  const std::string header = text.substr(0, end), row = text.substr(end + 1);
  EXPECT_THAT(header, HasSubstr(",T_1,M0_2,phi_2,EI_2,L_2,Mx_2,My_2"));
  EXPECT_EQ(std::count(header.begin(), header.end(), ','), std::count(row.begin(), row.end(), ','));
  EXPECT_THAT(row, HasSubstr(",6,0.0720"));
}

TEST(Actuation, NumericalErrorOfTwoMovingSegmentsIsFarBelowTheNoise) {
  Scenario s = parse_scenario(
      scenario_text(kTwoSegments,
                    "pressures: {random: {min_pa: 0, max_pa: 40e3, highest_hz: 0.2}}\n"
                    "tensions: {random: {max_n: 8, highest_hz: 0.2}}\n"
                    "payload: {fraction: 0.8, schedule: [{t_s: 0, kg: 0}, {t_s: 3, kg: 0.05}]}\n"),
      "case.yaml");
  s.gravity_m_s2 = 9.81;
  s.duration_s = 6.0;
  s.numerics.elements = 5;
  s.numerics.max_step_s = NumericsSpec{}.max_step_s;
  Simulator coarse(s);
  s.numerics.elements = 8;
  s.numerics.max_step_s /= 3.0;
  Simulator fine(s);
  double worst = 0.0;
  while (const std::optional<Sample> one = coarse.next()) {
    const std::optional<Sample> other = fine.next();
    ASSERT_TRUE(other);
    worst = std::max(worst, (one->truth.tip_base.p - other->truth.tip_base.p).norm());
  }
  EXPECT_GT(worst, 0.0);  // they differ
  EXPECT_LT(worst, 0.02e-3);
  RecordProperty("worst_mm", std::to_string(1e3 * worst));
}

TEST(Hidden, HysteresisLoopIsAsWideAsThePlayAtEverySpeed) {
  const std::string arm =
      "  length_m: 0.2\n  mass_kg: 0.2\n  bending_stiffness: {base_nm2: 0.03}\n"
      "  chambers: [{bending_direction_deg: 0, moment_gain_nm_per_pa: 6.0e-6}]\n";
  for (const char* ramp : {"2", "1"}) {
    const std::vector<Sample> samples = run(
        scenario_text(arm, std::string("pressures: {settle_s: 0.1, ramp_s: ") + ramp +
                               ", schedule: [{t_s: 0, pressures_pa: [0]}, {t_s: 3, pressures_pa: [40e3]}, "
                               "{t_s: 5.5, pressures_pa: [0]}]}\n"
                               "hidden: [{effect: hysteresis, loop_pa: 2500}]\n"));
    const auto acting = [](const Sample& s) { return s.truth.segments[0].moment_nm.x() / 6e-6; };
    double up = 0.0, down = 0.0, last = 0.0;
    for (const Sample& s : samples) {
      const double p = s.truth.pressures_pa[0];
      // Interpolated where the command passes 20 kPa, either way.
      const auto lag = acting(s) - p;
      if (last < 20e3 && p >= 20e3) up = lag;
      if (last >= 20e3 && p < 20e3) down = lag;
      last = p;
    }
    EXPECT_NEAR(down - up, 2500.0, 1.0) << ramp;
    EXPECT_NEAR(acting(samples.back()), 1250.0, 1.0);  // left over at zero pressure
    EXPECT_DOUBLE_EQ(acting(samples.front()), 0.0);
  }
}

TEST(Hidden, HysteresisOfTensionsAndAngles) {
  const std::vector<Sample> samples = run(scenario_text(
      kTendonArm,
      "tensions: {schedule: [{t_s: 0, tensions_n: [0, 0, 0]}, {t_s: 3, tensions_n: [2, 0, 0]}]}\n"
      "hidden: [{effect: hysteresis, loop_n: 0.2}]\n"));
  EXPECT_NEAR(samples[240].truth.segments[0].moment_nm.x(), 0.004 * (2.0 - 0.1), 1e-9);
  EXPECT_NEAR(samples[240].truth.tensions_n[0], 2.0, 1e-12);
}

TEST(Hidden, TheBaseTurnsButItsBodyDoesNot) {
  const std::string arm =
      "  length_m: 0.2\n  mass_kg: 0.2\n  bending_stiffness: {base_nm2: 0.1}\n"
      "  chambers: [{bending_direction_deg: 0, moment_gain_nm_per_pa: 6.0e-6}]\n";
  std::string text = scenario_text(arm, "");
  text.replace(text.find("gravity_m_s2: 0"), 15, "gravity_m_s2: 9.81");
  const Sample rigid = run(text).back();
  const Sample yielding = run(text + "hidden: [{effect: base_compliance, stiffness_nm_per_rad: 5}]\n").back();
  ASSERT_TRUE(rigid.bodies[0] && yielding.bodies[0]);
  EXPECT_LT(rigid.bodies[0]->q.angularDistance(yielding.bodies[0]->q), 1e-9);
  // 0.2 kg at 0.1 m, a little less for the sag.
  const double turned = yielding.truth.tip_angle_rad - rigid.truth.tip_angle_rad;
  EXPECT_NEAR(turned, 0.2 * 9.81 * 0.1 / 5.0, 0.03 * turned);
  EXPECT_LT(yielding.bodies[2]->p.z(), rigid.bodies[2]->p.z() - 0.006);
  EXPECT_DOUBLE_EQ(rigid.truth.segments[0].bending_stiffness_nm2,
                   yielding.truth.segments[0].bending_stiffness_nm2);
}

TEST(Hidden, APayloadWithinTheArmLeavesTheRestFree) {
  // At 40 % of a weightless horizontal arm: beyond the load it is straight.
  std::string text = scenario_text(
      "  length_m: 0.2\n  mass_kg: 0.0001\n  bending_stiffness: {base_nm2: 0.03}\n  air_damping_n_s_m2: 2\n",
      "payload: {fraction: 0.4, schedule: [{t_s: 0, kg: 0.05}]}\n");
  text.replace(text.find("gravity_m_s2: 0"), 15, "gravity_m_s2: 9.81");
  text.replace(text.find("[0.5, 1.0]"), 10, "[0.4, 0.6, 1.0]");
  const Sample sample = run(text).back();
  const double slope = 0.05 * 9.81 * 0.08 * 0.08 / 2.0 / 0.03;
  EXPECT_NEAR(sample.truth.tip_angle_rad, slope, 0.01 * slope);
  EXPECT_LT(sample.truth.rings_base[1].q.angularDistance(sample.truth.rings_base[2].q), 5e-4);
  EXPECT_GT(sample.truth.rings_base[0].q.angularDistance(Eigen::Quaterniond::Identity()), 0.9 * slope);
}

TEST(Actuation, MaterialWithoutAStableStretchIsOneLine) {
  const std::string arm =
      std::string(kTendonArm) + "  axial_stiffness_n: 30\n  material: {c10_pa: 18800, c01_pa: -14000}\n";
  try {
    run(scenario_text(arm, "tensions: {schedule: [{t_s: 0, tensions_n: [3, 3, 3]}]}\n"));
    FAIL() << "simulated";
  } catch (const SimulationError& error) {
    const std::string what = error.what();
    EXPECT_THAT(what, HasSubstr("scenario case: at t = "));
    EXPECT_THAT(what, HasSubstr("segment 1"));
    EXPECT_THAT(what, HasSubstr("no stable stretch"));
    EXPECT_EQ(what.find('\n'), std::string::npos);
  }
}

TEST(Actuation, MistakesAreOneLine) {
  struct Mistake {
    std::string from, to;
    std::vector<std::string> says;
  };
  const std::string good = scenario_text(
      kTwoSegments,
      "pressures: {schedule: [{t_s: 0, pressures_pa: [30e3, 0]}]}\n"
      "tensions: {schedule: [{t_s: 0, tensions_n: [6]}, {t_s: 4, tensions_n: [0]}]}\n"
      "payload: {fraction: 0.5}\n"
      "hidden: [{effect: base_compliance, stiffness_nm_per_rad: 5}, {effect: hysteresis, loop_pa: 100}]\n");
  ASSERT_NO_THROW(parse_scenario(good, "case.yaml"));
  const std::vector<Mistake> mistakes{
      {"input: chamber_2", "input: chamber_3", {"arm.segments", "chamber_2", "chamber_3"}},
      {"input: chamber_2",
       "input: tendon_2",
       {"arm.segments[0].chambers[1].input", "tendon_2", "chamber_1 ... chamber_16"}},
      {"input: chamber_2", "input: chamber_x", {"chambers[1].input", "chamber_x"}},
      {"input: chamber_2", "input: chamber_17", {"chambers[1].input", "17", "1 ... 16"}},
      {"input: tendon_1", "input: 5", {"arm.segments[1].tendons[0].input", "5", "tendon_1"}},
      {"offset_m: 0.012", "offset_m: -0.012", {"arm.segments[1].tendons[0].offset_m", "-0.012", "0 ... 1"}},
      {"diameter_m: 0.03",
       "material: {c10_pa: 1, c01_pa: 1}",
       {"arm.segments[1].material", "axial_stiffness_n"}},
      {"diameter_m: 0.03",
       "axial_stiffness_n: 3\n      material: {c10_pa: 1, c01_pa: -2}",
       {"material.c01_pa", "-2", "above -1"}},
      {"diameter_m: 0.03",
       "stiffness_by_pressure: [{pressure_pa: 0, bending_stiffness_nm2: 1}]",
       {"stiffness_by_pressure", "central_chamber"}},
      {"diameter_m: 0.03",
       "central_chamber: {input: chamber_3, area_m2: 0}",
       {"central_chamber.area_m2", "0"}},
      {"diameter_m: 0.03",
       "cables: [{input: servo_1, azimuth_deg: 0, lever_m: 0, spool_radius_m: 0.02}]",
       {"cables[0].lever_m", "0.0001"}},
      {"segments:", "segments: []\n  others:", {"arm.segments", "0 segments", "1 ... 8"}},
      {"tensions_n: [6]", "tensions_n: [6, 7]", {"tensions.schedule[0].tensions_n", "2 values", "1"}},
      {"tensions_n: [6]", "tensions_n: [-6]", {"tensions.schedule[0].tensions_n", "-6", "0 ... "}},
      {"tensions: {", "tensions: {repeat_s: 20, ", {"tensions.repeat_s", "end with the values"}},
      {"tensions: {", "tensions: {settle_s: 6, ", {"duration_s", "tensions.settle_s"}},
      {"payload: {", "angles: {random: {max_rad: 1}}\npayload: {", {"angles.random", "no segment"}},
      {"fraction: 0.5", "fraction: 1.5", {"payload.fraction", "1.5", "0.01 ... 1"}},
      {"rad: 5", "rad: 0", {"hidden[0].stiffness_nm_per_rad", "0"}},
      {"effect: hysteresis", "effect: hysteria", {"hidden[1].effect", "hysteria", "base_compliance"}},
      {"loop_pa: 100", "loop_pa: 100, form: guess", {"hidden[1].form", "guess", "play"}},
      {"loop_pa: 100", "loop_pa: 100, play: 100", {"hidden[1].play", "unknown", "loop_pa"}},
      {"loop_pa: 100", "loop_pa: 100, chamber: 3", {"hidden[1].effect", "chamber is 3", "0 ... 2"}},
      {"loop_pa: 100",
       "form: material, chamber: 1",
       {"hidden[1].chamber", "material", "allowed with form play, bouc_wen"}},
  };
  for (const Mistake& mistake : mistakes) {
    std::string text = good;
    const std::size_t at = text.find(mistake.from);
    ASSERT_NE(at, std::string::npos) << mistake.from;
    text.replace(at, mistake.from.size(), mistake.to);
    try {
      parse_scenario(text, "case.yaml");
      ADD_FAILURE() << "accepted: " << mistake.to;
    } catch (const ScenarioError& error) {
      const std::string what = error.what();
      EXPECT_THAT(what, HasSubstr("case.yaml: ")) << mistake.to;
      EXPECT_EQ(what.find('\n'), std::string::npos) << what;
      for (const std::string& part : mistake.says) EXPECT_THAT(what, HasSubstr(part)) << mistake.to;
    }
  }
}

}  // namespace
}  // namespace softarm::rig
