// Recordings as laboratories have them: clocks far apart, dead sensors, trials that begin driven, pieces left
// out.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "check_fixture.h"

namespace softarm {
namespace {

using namespace testing_check;
using ::testing::HasSubstr;

/// Chambers that go to a new pressure every few seconds, never the same again.
Course steps(double seconds, unsigned seed) {
  struct Steps {
    std::vector<double> at_s, level_pa[2];
  };
  const auto all = std::make_shared<Steps>();
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> wait(0.8, 4.0), level(0.0, 25e3);
  for (double t = -100.0; t < seconds + 100.0; t += wait(random)) {
    all->at_s.push_back(t);
    for (auto& pa : all->level_pa) pa.push_back(level(random));
  }
  return {seconds, [all](int chamber, double t_s) {
            const auto after = std::upper_bound(all->at_s.begin(), all->at_s.end(), t_s);
            const auto k = static_cast<std::size_t>(after - all->at_s.begin()) - 1;
            const auto& pa = all->level_pa[chamber];
            const double w = 0.5 - 0.5 * std::cos(M_PI * std::min(1.0, (t_s - all->at_s[k]) / 0.6));
            return pa[k - 1] + w * (pa[k] - pa[k - 1]);
          }};
}

/// The same again and again.
Course cycles(double seconds, double period_s) {
  const Course once = steps(period_s, 8);
  return {seconds, [=](int chamber, double t_s) {
            const double phase_s = t_s - period_s * std::floor(t_s / period_s);
            // Down to nothing at the seam.
            return once.pressure_pa(chamber, phase_s) *
                   std::min(1.0, 2.0 * std::min(phase_s, period_s - phase_s));
          }};
}

constexpr char kLayout[] = R"(
time: {column: 1, unit: s}
mocap:
  unit: m
  up: z
  bodies: [{name: base, position: [2, 3, 4], orientation: [5, 6, 7, 8], orientation_order: xyzw}]
pressures:
  unit: psi
  reference: gauge
  inputs: [{topic: /pressure/chamber_1, column: 9, zero: 0.5}, {topic: /pressure/chamber_2, column: 10}]
)";

class AsTheyCome : public ::testing::Test {
 protected:
  check::CheckReport report() const { return check::check_recording(recording, arm); }
  arm::Arm arm = hanging_arm();
  trial::CheckRecording recording = clean();
};

TEST_F(AsTheyCome, ClocksFarApartAreFoundWithTheirSettingWhicheverIsAhead) {
  for (const double ahead_s : {26.3, -41.7}) {
    SCOPED_TRACE(ahead_s);
    recording = clean(3, ahead_s, steps(150.0, 5));
    const check::CheckReport found = report();
    const check::CheckFinding* f = find(found, "clocks_apart");
    ASSERT_NE(f, nullptr) << to_text(found);
    EXPECT_EQ(f->severity, check::Severity::kSerious);
    EXPECT_NEAR(*f->figure, ahead_s, 0.05);
    EXPECT_LT(*f->figure_sd, 0.1);
    EXPECT_EQ(f->setting.empty(), ahead_s < 0.0) << "live frames do not wait: " << f->setting;
    recording.import_layout = kLayout;
    EXPECT_THAT(find(report(), "clocks_apart")->setting,
                HasSubstr(ahead_s > 0.0 ? "mocap.ahead_s: 26." : "mocap.ahead_s: -41."));
    recording.import_layout.clear();
    arm.inputs.body_latency_s = ahead_s;  // what it proposes repairs it
    EXPECT_EQ(find(report(), "clocks_apart"), nullptr);
    EXPECT_EQ(find(report(), "gap"), nullptr) << complaints(report());
    arm = hanging_arm();
  }
}

TEST_F(AsTheyCome, ClocksApartAreFoundInAMinute) {
  recording = clean(3, 10.0, steps(60.0, 5));
  const check::CheckReport found = report();
  const check::CheckFinding* f = find(found, "clocks_apart");
  ASSERT_NE(f, nullptr) << to_text(found);
  EXPECT_NEAR(*f->figure, 10.0, 0.05);
}

TEST_F(AsTheyCome, InputsThatRepeatThemselvesAreNoAlarmAndElseAmbiguous) {
  recording = clean(3, 0.0, cycles(120.0, 9.0));
  EXPECT_EQ(find(report(), "clocks_apart"), nullptr) << complaints(report());
  recording = clean(3, 22.5, cycles(120.0, 9.0));
  const check::CheckReport found = report();
  const check::CheckFinding* f = find(found, "clocks_apart");
  ASSERT_NE(f, nullptr) << to_text(found);
  EXPECT_EQ(f->severity, check::Severity::kWarning);
  EXPECT_THAT(f->what, HasSubstr("ambiguous"));
  EXPECT_EQ(f->setting, "");
}

TEST_F(AsTheyCome, MotionThatIsNotTheInputsIsNoOffsetOfClocks) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    recording = clean(seed, 0.0, steps(120.0, seed));
    recording.inputs = clean(seed, 0.0, steps(120.0, seed + 50)).inputs;
    EXPECT_EQ(find(report(), "clocks_apart"), nullptr) << seed << ": " << complaints(report());
  }
}

TEST_F(AsTheyCome, DeadInputsWhileTheArmMoves) {
  for (auto& input : recording.inputs) {
    for (auto& v : input) v.value = 101325.0;
  }
  const check::CheckReport all = report();
  ASSERT_NE(find(all, "dead_input", "chamber_1, chamber_2"), nullptr) << to_text(all);
  EXPECT_EQ(find(all, "dead_input")->severity, check::Severity::kWarning);
  EXPECT_EQ(find(all, "never_driven"), nullptr);

  // One of two: what moves the arm is not what the other shows.
  recording = clean();
  for (auto& v : recording.inputs[0]) v.value = 101325.0;
  const check::CheckReport one = report();
  const bool said = find(one, "dead_input", "chamber_1") || find(one, "never_driven", "chamber_1");
  EXPECT_TRUE(said) << to_text(one);

  // Sensors with noise, and one without.
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, 40.0);
  recording = clean();
  for (auto& v : recording.inputs[1]) v.value += noise(random);
  for (auto& v : recording.inputs[0]) v.value = 101325.0;
  EXPECT_NE(find(report(), "dead_input", "chamber_1"), nullptr) << to_text(report());
}

TEST_F(AsTheyCome, ASensorThatIsDeadAmongOthersIsAccusedByTheDirectionOfTheMotion) {
  // Two opposed chambers move the arm along x as ever; a third, whose sensor shows nothing, moves it across.
  const auto with_third = [&](double azimuth_deg, double moves_m) {
    arm = hanging_arm();
    recording = clean();
    arm::Chamber third = arm.segments[0].chambers[0];
    third.input = "chamber_3";
    third.bending_direction_rad = azimuth_deg * M_PI / 180.0;
    arm.segments[0].chambers.push_back(third);
    arm::ScalarInput input = arm.inputs.scalars[0];
    input.name = "chamber_3";
    input.topic = "/pressure/chamber_3";
    arm.inputs.scalars.push_back(input);
    recording.inputs.push_back(recording.inputs[0]);
    for (auto& v : recording.inputs[2]) v.value = 101325.0;
    for (std::size_t b = 1; b < 4; ++b) {
      for (auto& pose : recording.bodies[b]) {
        const double t = pose.stamp_s - kStart,
                     on = std::clamp(std::min(t - 2.0, kSeconds - 2.0 - t), 0.0, 1.0);
        pose.p_mocap.y() += on * moves_m * (b / 3.0) * (b / 3.0) * std::sin(2.6 * t + 0.02 * t * t);
      }
    }
  };
  with_third(90.0, 0.03);
  const check::CheckReport across = report();
  const check::CheckFinding* f = find(across, "dead_input", "chamber_3");
  ASSERT_NE(f, nullptr) << to_text(across);
  EXPECT_EQ(f->severity, check::Severity::kWarning);
  EXPECT_THAT(f->what, HasSubstr("along the line on which this input bends it"));
  EXPECT_EQ(find(across, "never_driven", "chamber_3"), nullptr);
  // It bends the arm elsewhere: then it may be anything.
  with_third(30.0, 0.03);
  EXPECT_EQ(find(report(), "dead_input"), nullptr) << complaints(report());
  EXPECT_NE(find(report(), "never_driven", "chamber_3"), nullptr);
  // Where the others explain the motion it is merely not driven.
  with_third(90.0, 0.0);
  EXPECT_EQ(find(report(), "dead_input"), nullptr) << complaints(report());
  EXPECT_NE(find(report(), "never_driven", "chamber_3"), nullptr);
}

TEST_F(AsTheyCome, AChamberThatIsNotDrivenIsNotDead) {
  recording = clean(1, 0.0, {kSeconds, [](int i, double t) { return i == 0 ? pressure_pa(0, t) : 0.0; }});
  EXPECT_EQ(find(report(), "dead_input"), nullptr) << complaints(report());
  EXPECT_NE(find(report(), "never_driven", "chamber_2"), nullptr);
  // An arm that hangs still does not accuse its inputs.
  recording = clean(1, 0.0, {kSeconds, [](int, double) { return 0.0; }});
  EXPECT_EQ(find(report(), "dead_input"), nullptr) << complaints(report());
}

/// Holds chamber_1 at 60 kPa for two seconds, then lets it go.
double driven_at_first(int chamber, double t_s) {
  const double w = 0.5 + 0.5 * std::cos(M_PI * std::clamp((t_s - 2.0) / 1.5, 0.0, 1.0));
  return (chamber == 0 ? 60e3 * w : 0.0) + (t_s > 4.0 ? 0.8 * pressure_pa(chamber, t_s) : 0.0);
}

TEST_F(AsTheyCome, ATrialThatBeginsDrivenHasItsUnitsAndNoZeroIsAdvised) {
  recording = clean(1, 0.0, {kSeconds, driven_at_first});
  const check::CheckReport found = report();
  EXPECT_EQ(find(found, "pressure_unit"), nullptr) << complaints(found);
  EXPECT_EQ(find(found, "offset_at_rest"), nullptr) << complaints(found);
  ASSERT_NE(find(found, "no_rest_at_start"), nullptr);
  EXPECT_THAT(find(found, "no_rest_at_start")->what, HasSubstr("chamber_1 is driven"));
  EXPECT_NE(found.worst(), check::Severity::kSerious) << complaints(found);
}

TEST_F(AsTheyCome, PressureThroughoutIsNoWrongUnit) {
  recording = clean(1, 0.0, {kSeconds, [](int i, double t) { return 150e3 + pressure_pa(i, t); }});
  EXPECT_EQ(find(report(), "pressure_unit"), nullptr) << complaints(report());
  for (arm::ScalarInput& input : arm.inputs.scalars) input.reference = arm::PressureReference::kGauge;
  recording = clean();
  ASSERT_NE(find(report(), "pressure_unit"), nullptr) << "the air's own pressure is no gauge pressure";
  EXPECT_THAT(find(report(), "pressure_unit")->setting, HasSubstr("reference: absolute"));
}

double stamp_of(const trial::Frame& frame) {
  return frame.stamp_s();
}
template <typename Sample>
double stamp_of(const Sample& sample) {
  return sample.stamp_s;
}

TEST_F(AsTheyCome, WhatTheImportLeftOutIsNoGapAndNothingSticksThere) {
  const auto cut = [](auto& samples) {
    samples.erase(std::remove_if(samples.begin(), samples.end(),
                                 [](const auto& s) {
                                   return stamp_of(s) > kStart + 5.0 && stamp_of(s) < kStart + 11.0;
                                 }),
                  samples.end());
  };
  for (auto& body : recording.bodies) cut(body);
  for (auto& input : recording.inputs) cut(input);
  cut(recording.frames);
  ASSERT_NE(find(report(), "gap", "mocap"), nullptr);
  EXPECT_EQ(find(report(), "gap", "mocap")->severity, check::Severity::kSerious);
  recording.left_out.emplace_back(kStart + 5.0, kStart + 11.0);
  EXPECT_EQ(complaints(report()), "");
  ASSERT_NE(find(report(), "left_out"), nullptr);
  EXPECT_NEAR(*find(report(), "left_out")->figure, 6.0, 0.05);
}

TEST_F(AsTheyCome, ASensorThatShowsOneValueOnBothSidesOfAGapDoesNotStick) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, 40.0);
  for (auto& v : recording.inputs[0]) v.value += noise(random);
  auto& values = recording.inputs[0];
  values.erase(values.begin() + 250, values.begin() + 400);
  for (std::size_t k = 244; k < 256; ++k) values[k].value = values[244].value;
  EXPECT_EQ(find(report(), "stuck_input"), nullptr) << complaints(report());
}

/// A slow ramp under noisy sensors, as if it were rest.
TEST_F(AsTheyCome, RestIsNotTakenFromARamp) {
  const auto ramp = [](int i, double t) {
    return i == 0 ? 16e3 + 1.5e3 * std::min(t, 3.0) + (t > 3.0 ? 20e3 * std::sin(0.9 * (t - 3.0)) : 0.0)
                  : (t > 3.0 ? 10e3 * (1.0 - std::cos(1.3 * (t - 3.0))) : 0.0);
  };
  for (unsigned seed = 1; seed <= 5; ++seed) {
    recording = clean(seed, 0.0, {kSeconds, ramp});
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0.0, 1.9e3);
    for (auto& input : recording.inputs) {
      for (auto& v : input) v.value += noise(random);
    }
    const check::CheckReport found = report();
    EXPECT_EQ(find(found, "offset_at_rest"), nullptr) << complaints(found);
    EXPECT_NE(find(found, "no_rest_at_start"), nullptr) << to_text(found);
  }
}

/// The arm sticks while a chamber fills under its sensor's noise.
TEST_F(AsTheyCome, ADriftThatNoiseHidesIsNoRest) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const auto drive = [](int i, double t) {
      return t < 3.0 ? 0.0 : (i == 0 ? 20e3 : 14e3) * (1.0 - std::cos((i == 0 ? 0.9 : 1.3) * (t - 3.0)));
    };
    recording = clean(seed, 0.0, {kSeconds, drive});
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0.0, 1.9e3);
    for (auto& input : recording.inputs) {
      for (auto& v : input) v.value += noise(random);
    }
    for (auto& v : recording.inputs[0]) v.value += std::min(2.0e3 * (v.stamp_s - kStart), 6e3);
    EXPECT_EQ(find(report(), "offset_at_rest"), nullptr) << seed << ": " << complaints(report());
  }
}

TEST_F(AsTheyCome, ALevelThatASensorFallsBelowIsNoZero) {
  for (auto& v : recording.inputs[0]) {
    const double t = v.stamp_s - kStart;
    v.value += 2000.0 * std::clamp(5.0 - t, 0.0, 1.0);  // at rest by what is left in it
  }
  EXPECT_EQ(find(report(), "offset_at_rest"), nullptr) << complaints(report());
}

TEST_F(AsTheyCome, WhatIsNeverDrivenMayBeHeldAtItsLevel) {
  for (auto& v : recording.inputs[1]) v.value = 101325.0 + 14e3;
  const check::CheckReport found = report();
  ASSERT_NE(find(found, "offset_at_rest", "chamber_2"), nullptr) << to_text(found);
  EXPECT_EQ(find(found, "offset_at_rest", "chamber_2")->severity, check::Severity::kInformation);
  EXPECT_EQ(find(found, "offset_at_rest", "chamber_2")->setting, "");
}

TEST_F(AsTheyCome, NoiseThatStandsForTheModelsErrorsIsLeftInPeace) {
  for (auto& body : arm.bodies) body.position_sd_m = 20.0 * kNoiseM;
  EXPECT_EQ(complaints(report()), "");
  // A mount that wanders by little is no reason to trust the bodies more.
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  double wander_m = 0.0;
  for (auto& pose : recording.bodies[0]) {
    wander_m += 0.02 * (8e-5 * 7.0 * normal(random) - wander_m);
    pose.p_mocap.x() += wander_m;
  }
  for (const check::CheckFinding& f : report().findings)
    EXPECT_EQ(f.setting.find("position_sd_m"), std::string::npos) << f.id << ": " << f.setting;
}

std::vector<check::CheckReport> reports_of(const arm::Arm& arm, const std::vector<double>& zeros_pa,
                                           const std::string& layout = "") {
  std::vector<check::CheckReport> reports;
  for (std::size_t i = 0; i < zeros_pa.size(); ++i) {
    trial::CheckRecording recording = clean(static_cast<unsigned>(i + 1));
    recording.name = "trial_" + std::to_string(i);
    recording.import_layout = layout;
    for (auto& v : recording.inputs[0]) v.value += zeros_pa[i];
    reports.push_back(check::check_recording(recording, arm));
  }
  return reports;
}

TEST_F(AsTheyCome, SettingsOfSeveralRecordingsArePooledOrSaidToDiffer) {
  const auto reports_of = [&](double first_s, double second_s) {
    std::vector<check::CheckReport> reports;
    for (const double ahead_s : {first_s, second_s}) {
      recording = clean(3, ahead_s, steps(150.0, 5));
      recording.import_layout = kLayout;
      recording.name = ahead_s == first_s ? "a.bag" : "b.bag";
      reports.push_back(report());
    }
    return reports;
  };
  std::vector<check::CheckReport> reports = reports_of(26.1, 31.0);
  std::vector<check::CheckFinding> together = check::check_together(reports);
  ASSERT_EQ(together.size(), 1u);
  EXPECT_EQ(together[0].id, "settings_differ");
  EXPECT_THAT(together[0].what, HasSubstr("mocap.ahead_s: 26.1"));
  EXPECT_THAT(together[0].what, HasSubstr("by a.bag, 31.0"));
  for (const check::CheckReport& r : reports) EXPECT_EQ(find(r, "clocks_apart")->setting, "");

  reports = reports_of(26.1, 31.0);
  for (check::CheckReport& r : reports) {
    for (check::CheckFinding& f : r.findings) {
      if (f.id == "clocks_apart") f.figure_sd = 2.0;  // as one of slow motions would have it
    }
  }
  together = check::check_together(reports);
  ASSERT_EQ(together.size(), 1u);
  EXPECT_EQ(together[0].id, "pooled_setting");
  EXPECT_THAT(together[0].setting, HasSubstr("mocap.ahead_s: 28.5"));
  EXPECT_THAT(together[0].setting, HasSubstr(" (of the layout)"));
  for (const check::CheckReport& r : reports)
    EXPECT_EQ(find(r, "clocks_apart")->setting, together[0].setting);
}

/// But for a latency of bodies below 2.5 ms, which is one here and another one there by the last digits.
std::vector<check::CheckFinding> without_latency(std::vector<check::CheckFinding> findings) {
  const std::string key = "inputs.bodies.latency_s: ";
  findings.erase(std::remove_if(findings.begin(), findings.end(),
                                [&key](const check::CheckFinding& f) {
                                  return f.severity == check::Severity::kInformation &&
                                         f.setting.rfind(key, 0) == 0 &&
                                         std::abs(std::stod(f.setting.substr(key.size()))) < 0.0025;
                                }),
                 findings.end());
  return findings;
}

TEST_F(AsTheyCome, LengthsThatBelongTogetherAreThoseOfOneRecording) {
  std::vector<check::CheckReport> reports;
  for (const double longer : {1.04, 1.05, 1.06}) {
    recording = clean(static_cast<unsigned>(reports.size()) + 1);
    arm = hanging_arm();
    arm.segments[0].length_m /= longer;
    arm.payload.arclength_m /= longer;
    for (auto& body : arm.bodies) body.arclength_m /= longer;
    reports.push_back(report());
    ASSERT_NE(find(reports.back(), "stretched"), nullptr) << to_text(reports.back());
  }
  const std::string middle = find(reports[1], "stretched")->setting;
  ASSERT_NE(find(reports[0], "stretched")->setting, middle);
  const std::vector<check::CheckFinding> together = without_latency(check::check_together(reports));
  ASSERT_EQ(together.size(), 1u);
  EXPECT_EQ(together[0].id, "pooled_setting");
  for (const check::CheckReport& r : reports) EXPECT_EQ(find(r, "stretched")->setting, middle);
}

TEST_F(AsTheyCome, ZerosAreTakenFromAllTrialsTogetherInTheUnitOfTheirFile) {
  std::vector<check::CheckReport> reports = reports_of(arm, {1000.0, 1060.0, 980.0});
  const std::vector<check::CheckFinding> together = without_latency(check::check_together(reports));
  ASSERT_EQ(together.size(), 1u);
  EXPECT_EQ(together[0].id, "zero_of_all");
  EXPECT_NEAR(*together[0].figure, 1000.0, 1.0);
  EXPECT_EQ(together[0].setting, "inputs.pressures[chamber_1].zero: 1000");
  for (const check::CheckReport& r : reports) {
    EXPECT_EQ(find(r, "offset_at_rest", "chamber_1")->setting, together[0].setting);
    EXPECT_EQ(complaints(r), "");
  }
  // Imported: in psi, on top of the 0.5 psi that the layout has.
  reports = reports_of(arm, {1000.0, 1060.0, 980.0}, kLayout);
  const std::vector<check::CheckFinding> in_psi = without_latency(check::check_together(reports));
  ASSERT_EQ(in_psi.size(), 1u);
  EXPECT_EQ(in_psi[0].setting, "pressures.inputs[/pressure/chamber_1].zero: 0.645 (of the layout)");
  EXPECT_THAT(in_psi[0].what, HasSubstr("0.645 psi"));
}

TEST_F(AsTheyCome, TrialsThatDisagreeHaveNoCommonZero) {
  std::vector<check::CheckReport> reports = reports_of(arm, {0.0, 6700.0});
  const std::vector<check::CheckFinding> together = without_latency(check::check_together(reports));
  ASSERT_EQ(together.size(), 1u);
  EXPECT_EQ(together[0].id, "zeros_differ");
  EXPECT_EQ(together[0].setting, "");
  EXPECT_EQ(find(reports[1], "offset_at_rest")->setting, "");
  std::vector<check::CheckReport> one = reports_of(arm, {1000.0});
  EXPECT_TRUE(check::check_together(one).empty());
  EXPECT_EQ(find(one[0], "offset_at_rest")->setting, "inputs.pressures[chamber_1].zero: 1000");
}

TEST_F(AsTheyCome, TheZeroThatIsProposedTakesTheOffsetAway) {
  for (auto& v : recording.inputs[0]) v.value += 1000.0;
  ASSERT_NE(find(report(), "offset_at_rest"), nullptr);
  arm.inputs.scalars[0].zero_si = 1000.0;
  EXPECT_EQ(complaints(report()), "");
}

}  // namespace
}  // namespace softarm
