// What the live monitor says of the rig's streams: silence where nothing is wrong, and what, where and when
// where something is.
#include <random>

#include "mismatch_rig.h"

namespace softarm::diagnose::testing {
namespace {

constexpr double kSlip_s = 15.3;

TEST(MismatchOnTheRig, NoAlarmInMotionWithPayloadChangesAndDropouts) {
  const arm::Arm arm = shipped_arm("online_200mm");
  rig::Scenario scenario = demo_scenario("", 40.0, 120.0, 3);
  scenario.mocap.dropout_probability = 0.02;
  const Watched watched = watch(arm, scenario);
  EXPECT_EQ(watched.frames, 4801u);
  EXPECT_TRUE(watched.alarms.empty())
      << watched.alarms[0].at_s << " s: " << watched.alarms[0].named.description;
  EXPECT_LT(watched.largest_quiet_sd, 5.0);
  EXPECT_TRUE(watched.last.valid && watched.last.laws);
  EXPECT_LT(watched.last.score_sd, 3.0);
}

TEST(MismatchOnTheRig, NoAlarmAt240HzInQuickMotion) {
  const arm::Arm arm = shipped_arm("online_200mm");
  rig::Scenario scenario = demo_scenario("", 18.0, 240.0, 5);
  scenario.pressures.random->lowest_hz *= 3.0;
  scenario.pressures.random->highest_hz *= 3.0;
  const Watched watched = watch(arm, scenario);
  EXPECT_TRUE(watched.alarms.empty())
      << watched.alarms[0].at_s << " s: " << watched.alarms[0].named.description;
}

TEST(MismatchOnTheRig, AWrongGainIsInTheScoreButNoAlarm) {
  arm::Arm arm = shipped_arm("online_200mm");
  for (arm::Chamber& chamber : arm.segments[0].chambers) chamber.moment_gain_nm_per_pa *= 0.85;
  const Watched watched = watch(arm, demo_scenario("", 25.0, 120.0, 4));
  EXPECT_TRUE(watched.alarms.empty())
      << watched.alarms[0].at_s << " s: " << watched.alarms[0].named.description;
  EXPECT_GT(watched.largest_score_sd, 10.0);
}

TEST(MismatchOnTheRig, ASlippedRingIsNamedWithinHalfASecond) {
  const arm::Arm arm = shipped_arm("online_200mm");
  for (int ring = 1; ring <= 3; ++ring) {
    const std::string slip = "{effect: marker_slip, body: " + std::to_string(ring) +
                             (ring == 2 ? ", sideways_m: 0.002, direction_deg: 60" : ", along_m: 0.002") +
                             ", from_s: " + std::to_string(kSlip_s) + "}";
    rig::Scenario scenario = demo_scenario(slip, kSlip_s + 1.3, 120.0, 2);
    scenario.payload.schedule.resize(1);
    scenario.payload.repeat_s = 0.0;
    const Watched watched = watch(arm, scenario);
    ASSERT_EQ(watched.alarms.size(), 1u) << ring << ": " << watched.largest_quiet_sd;
    const Alarm& alarm = watched.alarms[0];
    EXPECT_GT(alarm.at_s, kSlip_s);
    EXPECT_LT(alarm.at_s, kSlip_s + 0.5) << ring;
    EXPECT_EQ(alarm.named.kind, monitor::ChangeKind::kRing) << ring << ": " << alarm.named.description;
    EXPECT_EQ(alarm.named.body, ring - 1) << alarm.named.description;
    EXPECT_NEAR(*alarm.named.onset_s - kEpoch_s, kSlip_s, 0.1) << ring;
    EXPECT_NEAR(alarm.named.size_m, 0.002, 0.0006) << ring;
    if (ring != 2) {
      EXPECT_EQ(alarm.named.axis, monitor::MismatchAxis::kAxial) << ring;
    }
    EXPECT_NE(alarm.named.description.find("ring_" + std::to_string(ring)), std::string::npos);
  }
}

/// Also where all bodies together are over a low threshold, and none of them much.
TEST(MismatchOnTheRig, EveryAlarmHasAKindAndAnOnset) {
  const arm::Arm arm = shipped_arm("online_200mm");
  monitor::MismatchMonitorParams params;
  params.threshold_sd = 3.0;
  std::size_t alarms = 0;
  for (const char* along_m : {"0.0003", "0.0005", "0.001"}) {
    rig::Scenario scenario = demo_scenario(
        std::string("{effect: marker_slip, body: 2, from_s: 10, along_m: ") + along_m + "}", 16.0, 120.0, 7);
    scenario.payload.schedule.resize(1);
    scenario.payload.repeat_s = 0.0;
    const Watched watched = watch(arm, scenario, params);
    alarms += watched.alarms.size();
    for (const Alarm& alarm : watched.alarms) {
      EXPECT_NE(alarm.first.kind, monitor::ChangeKind::kNone) << along_m << " " << alarm.at_s;
      ASSERT_TRUE(alarm.first.onset_s) << along_m << " " << alarm.at_s;
      EXPECT_LE(*alarm.first.onset_s - kEpoch_s, alarm.at_s) << along_m;
      EXPECT_GT(*alarm.first.onset_s - kEpoch_s, alarm.at_s - 2.5) << along_m;
    }
  }
  EXPECT_GT(alarms, 0u);
}

TEST(MismatchOnTheRig, AContactIsSeenWithinHalfASecondAndAtItsPlace) {
  const arm::Arm arm = shipped_arm("online_200mm");
  struct Case {
    std::string effect;
    double s_m;
    std::uint64_t seed;
  };
  const Case cases[] = {
      {"{effect: contact, form: spring_wall, stiffness_n_per_m: 300, distance_m: 0.026, fraction: 0.75, "
       "azimuth_deg: 0}",
       0.15, 1},
      {"{effect: contact, form: spring_wall, stiffness_n_per_m: 100, distance_m: 0.035, fraction: 1, "
       "azimuth_deg: 0}",
       0.2, 2},
  };
  for (const Case& contact : cases) {
    rig::Scenario scenario = demo_scenario(contact.effect, 21.0, 120.0, contact.seed);
    rig::Scenario clean = demo_scenario("", 21.0, 120.0, contact.seed);
    for (rig::Scenario* s : {&scenario, &clean}) {
      s->payload.schedule.resize(1);
      s->payload.repeat_s = 0.0;
    }
    // Three times the mocap's noise.
    const auto displaced_s = displaced_at_s(scenario, clean, 0.0015);
    ASSERT_TRUE(displaced_s) << contact.effect;
    const Watched watched = watch(arm, scenario);
    ASSERT_FALSE(watched.alarms.empty()) << contact.effect << watched.largest_quiet_sd;
    const Alarm& alarm = watched.alarms[0];
    EXPECT_GT(alarm.at_s, *displaced_s - 0.2) << contact.effect;
    EXPECT_LT(alarm.at_s, *displaced_s + 0.5) << contact.effect;
    EXPECT_EQ(alarm.named.kind, monitor::ChangeKind::kContact)
        << contact.effect << ": " << alarm.named.description;
    EXPECT_NEAR(alarm.named.s_m, contact.s_m, 0.05) << contact.effect;
    EXPECT_NEAR(*alarm.named.onset_s - kEpoch_s, *displaced_s, 0.3) << contact.effect;
  }
}

TEST(MismatchOnTheRig, WhatStaysIsTakenAsHowTheArmNowIs) {
  const arm::Arm arm = shipped_arm("online_200mm");
  rig::Scenario scenario =
      demo_scenario("{effect: marker_slip, body: 2, along_m: 0.003, from_s: 14}", 26.0, 60.0, 6);
  scenario.payload.schedule.resize(1);
  scenario.payload.repeat_s = 0.0;
  monitor::MismatchMonitorParams params;
  params.accept_after_s = 5.0;
  const Watched watched = watch(arm, scenario, params);
  ASSERT_EQ(watched.alarms.size(), 1u);
  EXPECT_FALSE(watched.last.alarm) << watched.last.description;
  EXPECT_FALSE(watched.last.onset_s);
  EXPECT_LT(watched.last.change_sd, 5.0);
}

TEST(MismatchOnTheRig, WithoutInputsASlippedRingIsStillSeen) {
  const arm::Arm arm = shipped_arm("online_200mm");
  rig::Scenario scenario =
      demo_scenario("{effect: marker_slip, body: 2, sideways_m: 0.003, from_s: 12}", 13.0, 120.0, 6);
  scenario.payload.schedule.resize(1);
  scenario.payload.repeat_s = 0.0;
  const Watched watched = watch(arm, scenario, {}, [](double, trial::Frame& frame) {
    frame.inputs.clear();
    return true;
  });
  EXPECT_FALSE(watched.last.laws);
  ASSERT_EQ(watched.alarms.size(), 1u) << watched.largest_quiet_sd;
  EXPECT_LT(watched.alarms[0].at_s, 12.5);
  EXPECT_EQ(watched.alarms[0].named.body, 1) << watched.alarms[0].named.description;
}

TEST(MismatchOnTheRig, AGapOrAJumpInTimeIsNoChange) {
  const arm::Arm arm = shipped_arm("online_200mm");
  bool jumped = false;
  const Watched watched =
      watch(arm, demo_scenario("", 22.0, 120.0, 8), {}, [&](double t_s, trial::Frame& frame) {
        if (t_s > 12.0 && t_s < 14.5) return false;
        if (t_s > 18.0) {
          frame.stamp_ns -= 50'000'000'000;
          jumped = true;
        }
        return true;
      });
  EXPECT_TRUE(jumped);
  EXPECT_TRUE(watched.alarms.empty())
      << watched.alarms[0].at_s << " s: " << watched.alarms[0].named.description;
  EXPECT_TRUE(watched.last.valid);
  EXPECT_EQ(watched.last.threshold_sd, 0.0);  // learns anew since the jump
}

/// What the monitor learns of an arm must not wander off where mocap fails now and then: bodies that are
/// lost, freeze or jump, inputs that fall silent. With covariances that were none, bodies had "moved" by
/// kilometres.
TEST(MismatchOnTheRig, ManyFaultsTeachNoNonsense) {
  constexpr double kRate_hz = 40.0, kFaulty_s = 1200.0, kGood_s = 60.0, kGhost_m = 0.3;
  const arm::Arm arm = shipped_arm("online_200mm");
  std::vector<trial::Frame> frames;
  watch(arm, demo_scenario("", 20.0, kRate_hz, 5), {}, [&](double, trial::Frame& frame) {
    frames.push_back(frame);
    return true;
  });
  estimate::Estimator estimator(arm);
  monitor::MismatchMonitor monitor(arm, {});
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> any(0.0, 1.0);
  double t_s = 0.0;
  const auto happens = [&](double per_s) { return any(random) < per_s / kRate_hz && t_s < kFaulty_s; };
  const auto until = [&](std::size_t k, double longest_s) {
    return k + static_cast<std::size_t>(longest_s * kRate_hz * any(random));
  };
  std::vector<std::size_t> lost(4), frozen(4), ghost(4);
  std::vector<Eigen::Vector3d> held(4);
  std::size_t silent = 0;
  double largest_m = 0.0;
  bool alarmed = false;
  const auto count = static_cast<std::size_t>((kFaulty_s + kGood_s) * kRate_hz);
  for (std::size_t k = 0; k < count; ++k) {
    t_s = static_cast<double>(k) / kRate_hz;
    const std::size_t way = k % (2 * frames.size());  // there and back again
    trial::Frame frame = frames[way < frames.size() ? way : 2 * frames.size() - 1 - way];
    frame.stamp_ns = frames.front().stamp_ns + static_cast<std::int64_t>(1e9 * t_s);
    if (happens(0.02)) silent = until(k, 1.7);
    if (silent > k) frame.inputs.clear();
    frame.samples.clear();
    std::vector<trial::BodyObservation> bodies;
    for (trial::BodyObservation body : frame.bodies) {
      const auto b = static_cast<std::size_t>(body.body);
      if (happens(0.03)) lost[b] = until(k, 3.0);
      if (happens(0.03)) frozen[b] = until(k, 2.0), held[b] = body.p_mocap;
      if (happens(0.05)) ghost[b] = until(k, 0.1);
      if (lost[b] > k) continue;
      if (frozen[b] > k) body.p_mocap = held[b];
      if (ghost[b] > k) body.p_mocap.y() += kGhost_m;
      bodies.push_back(body);
    }
    frame.bodies = bodies;
    const monitor::Mismatch& mismatch = monitor.add(frame, estimator.estimate(frame));
    largest_m = std::max(largest_m, mismatch.size_m);
    if (t_s > kFaulty_s + 0.5 * kGood_s) alarmed = alarmed || mismatch.alarm;
  }
  EXPECT_GT(largest_m, 0.1 * kGhost_m);  // they are seen
  EXPECT_LT(largest_m, kGhost_m + arm.total_length_m());
  EXPECT_FALSE(alarmed);  // half a minute after the last
}

}  // namespace
}  // namespace softarm::diagnose::testing
