// Memory, friction and age between command and arm against hand-computed cases; the table of all of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "rig/hidden_inputs.h"
#include "rig/simulator.h"

namespace softarm::rig {
namespace {

using ::testing::HasSubstr;

TEST(Hysteresis, BothFormsHaveTheirWidthInAWideCycleAtEverySpeed) {
  for (const char* form : {"play", "bouc_wen"})
    for (double over_s : {5.0, 0.5}) {
      Walk walk(with("hysteresis", {{"loop_pa", 2500.0}}, form));
      walk.to(commands(40e3), over_s);
      double up = 0.0, down = 0.0;
      const auto at_middle = [](double& lag) {
        return [&lag](const Commands& c, const Acting& a) {
          if (std::abs(c.pressures_pa[0] - 20e3) < 50.0) lag = a.pressures_pa[0] - c.pressures_pa[0];
        };
      };
      walk.to(commands(0.0), over_s, at_middle(down));
      walk.to(commands(40e3), over_s, at_middle(up));
      EXPECT_NEAR(down - up, 2500.0, 0.1) << form << over_s;
      EXPECT_NEAR(down + up, 0.0, 0.1) << form;
    }
}

TEST(Hysteresis, MayBeOfOneChamber) {
  for (const char* form : {"play", "bouc_wen"}) {
    Walk walk(with("hysteresis", {{"loop_pa", 2500.0}, {"chamber", 2.0}}, form));
    const std::vector<double> up = walk.to(commands(40e3, 40e3, 40e3), 1.0).pressures_pa,
                              down = walk.to(commands(), 1.0).pressures_pa;
    for (const std::size_t other : {0u, 2u}) {
      EXPECT_EQ(up[other], 40e3) << form;
      EXPECT_EQ(down[other], 0.0) << form;
    }
    EXPECT_NEAR(up[1], 40e3 - 1250.0, 0.1) << form;
    EXPECT_NEAR(down[1], 1250.0, 0.1) << form;
  }
}

TEST(Hysteresis, BoucWenBendsWithItsKneeAndNeverGoesBack) {
  Walk walk(with("hysteresis", {{"loop_pa", 2000.0}}, "bouc_wen"));
  // Virgin curve: z = 1 - e^(-u / 1200), output u - 1000 z.
  EXPECT_NEAR(walk.to(commands(1200.0), 1.0).pressures_pa[0], 1200.0 - 1000.0 * (1.0 - std::exp(-1.0)), 1e-6);
  walk.to(commands(40e3), 1.0);
  // Turned back by one knee: z straight from 1 to 0.
  EXPECT_NEAR(walk.to(commands(40e3 - 1200.0), 1.0).pressures_pa[0], 40e3 - 1200.0, 1e-6);
  double last = walk.acting().pressures_pa[0];
  walk.to(commands(0.0), 1.0, [&](const Commands&, const Acting& a) {
    EXPECT_LT(a.pressures_pa[0], last);
    last = a.pressures_pa[0];
  });
}

TEST(TendonFriction, LoopAndLossFollowTheCapstanEquation) {
  const double mu = 0.2, routing = 0.5;
  InputPath path(with("tendon_friction", {{"coefficient", mu}, {"routing_rad", routing}}), commands());
  EXPECT_TRUE(path.feels_bending());
  const std::vector<Bend> bends{{1.0}, {0.5}};
  double t = 0.0;
  const auto pull = [&](double tension_n) {
    Commands c = commands();
    c.tensions_n = {tension_n, 0.0};
    return path.act(c, t += 0.01, bends);
  };
  const auto mean = [](double from, double angle) { return from * -std::expm1(-angle) / angle; };
  const std::vector<Acting> pulled = pull(8.0);
  const double at_base = 8.0 * std::exp(-mu * routing), at_joint = at_base * std::exp(-mu * 1.0);
  EXPECT_NEAR(pulled[0].tensions_n[0], mean(at_base, mu * 1.0), 1e-12);
  EXPECT_NEAR(pulled[1].tensions_n[0], mean(at_joint, mu * 0.5), 1e-12);
  EXPECT_NEAR(pulled[0].tension_change_n[0], at_joint - at_base, 1e-12);
  EXPECT_EQ(pulled[0].tensions_n[1], 0.0);
  // Let go a little: behind the friction nothing moves at once, then it is above.
  EXPECT_NEAR(pull(7.9)[1].tensions_n[0], pulled[1].tensions_n[0], 1e-9);
  const std::vector<Acting> released = pull(3.0);
  const double back = 3.0 * std::exp(mu * routing);
  EXPECT_NEAR(released[0].tensions_n[0], mean(back * std::exp(mu), mu), 1e-12);
  EXPECT_GT(released[1].tensions_n[0], released[0].tensions_n[0]);
  EXPECT_EQ(pull(0.0)[1].tensions_n[0], 0.0);
}

TEST(TendonFriction, AStraightArmLosesNothing) {
  InputPath path(with("tendon_friction", {{"coefficient", 0.3}}), commands());
  Commands c = commands();
  c.tensions_n = {5.0, 2.0};
  for (const Acting& a : path.act(c, 0.01, {Bend(), Bend()})) EXPECT_EQ(a.tensions_n, c.tensions_n);
}

TEST(JammingSettling, FastEvacuationStaysShortThenCreepsAndReleaseIsProportional) {
  Walk walk(with("jamming_settling", {{"rate_pa_per_s", 60e3}, {"compaction_s", 5.0}}));
  Commands jammed = commands();
  jammed.vacuum_pa = 60e3;
  // 60 kPa at 6 MPa/s: 1 / (1 + 100) of it at once.
  walk.to(jammed, 0.01);
  EXPECT_NEAR(walk.acting().jamming_pa, 60e3 / 101.0, 0.003 * 60e3);
  EXPECT_EQ(walk.acting().vacuum_pa, 60e3);
  const double early = walk.acting().jamming_pa;
  walk.hold(5.0);
  EXPECT_NEAR(walk.acting().jamming_pa, 60e3 - (60e3 - early) * std::exp(-1.0), 1.0);
  const double before = walk.acting().jamming_pa;
  Commands half = commands();
  half.vacuum_pa = 30e3;
  EXPECT_NEAR(walk.to(half, 0.005).jamming_pa, 0.5 * before, 30.0);
  // Slowly, it is as the vacuum.
  Walk slow(with("jamming_settling", {{"rate_pa_per_s", 60e3}, {"compaction_s", 5.0}}));
  EXPECT_GT(slow.to(jammed, 120.0).jamming_pa, 0.99 * 60e3);
}

TEST(JammingSettling, LoopInVacuum) {
  Walk walk(with("jamming_settling", {{"rate_pa_per_s", 1e9}, {"compaction_s", 0.05}, {"loop_pa", 4e3}}));
  Commands jammed = commands(), half = commands();
  jammed.vacuum_pa = 60e3;
  half.vacuum_pa = 30e3;
  EXPECT_NEAR(walk.to(half, 3.0).jamming_pa, 28e3, 1.0);
  walk.to(jammed, 3.0);
  EXPECT_NEAR(walk.to(half, 3.0).jamming_pa, 32e3, 1.0);
}

TEST(Drift, LinearAndSaturatingAtGivenTimes) {
  const std::map<std::string, double> values{
      {"gain_share", -0.1}, {"stiffness_share", 0.2}, {"over_s", 20.0}};
  Scenario later = laboratory();
  later.session_s = 10.0;
  Walk linear(with("drift", values, "linear", later));
  EXPECT_NEAR(linear.acting().gain_scale, 1.0 - 0.1 * 0.5, 1e-12);
  linear.hold(30.0);
  EXPECT_NEAR(linear.acting().gain_scale, 1.0 - 0.1 * 2.0, 1e-9);
  EXPECT_NEAR(linear.acting().stiffness_scale, 1.4, 1e-9);
  Walk saturating(with("drift", values, "saturating", later));
  EXPECT_NEAR(saturating.hold(10.0).gain_scale, 1.0 - 0.1 * (1.0 - std::exp(-1.0)), 1e-9);
  EXPECT_NEAR(saturating.hold(200.0).stiffness_scale, 1.2, 1e-4);
}

TEST(Drift, LogarithmicIsFastAtFirstAndNeverEnds) {
  const std::map<std::string, double> values{
      {"gain_share", -0.1}, {"stiffness_share", 0.2}, {"over_s", 20.0}};
  Scenario later = laboratory();
  later.session_s = 10.0;
  Walk walk(with("drift", values, "logarithmic", later));
  EXPECT_NEAR(walk.acting().gain_scale, 1.0 - 0.1 * std::log(11.0) / std::log(21.0), 1e-12);
  EXPECT_NEAR(walk.hold(10.0).gain_scale, 0.9, 1e-9);
  EXPECT_NEAR(walk.acting().stiffness_scale, 1.2, 1e-9);
  EXPECT_NEAR(walk.hold(180.0).stiffness_scale, 1.0 + 0.2 * std::log(201.0) / std::log(21.0), 1e-9);
}

TEST(Temperature, SwingsStiffnessAndLength) {
  Walk walk(with("temperature", {{"amplitude_k", 5.0}, {"period_s", 40.0}}));
  EXPECT_EQ(walk.acting().stiffness_scale, 1.0);
  walk.hold(10.0);
  EXPECT_NEAR(walk.acting().stiffness_scale, 1.0 - 0.05, 1e-9);
  EXPECT_NEAR(walk.acting().length_scale, 1.0 + 5.0 * 3e-4, 1e-12);
  EXPECT_NEAR(walk.hold(20.0).stiffness_scale, 1.05, 1e-9);
}

TEST(Temperature, OfAThermostatRisesFasterThanItFalls) {
  Scenario later = laboratory();
  later.session_s = 100.0;
  Walk walk(with("temperature", {{"amplitude_k", 5.0}, {"period_s", 40.0}}, "thermostat", later));
  // 100 s are two periods and a half: a tenth after the heater's 0.4 are over.
  const double fallen = std::expm1(-0.1 / 0.3) / std::expm1(-0.6 / 0.3);
  EXPECT_NEAR(walk.acting().stiffness_scale, 1.0 - 0.05 * (1.0 - 2.0 * fallen), 1e-9);
  EXPECT_NEAR(walk.hold(20.0).stiffness_scale, 1.05, 1e-9);  // coldest
  EXPECT_NEAR(walk.hold(16.0).stiffness_scale, 0.95, 1e-9);  // warmest
  EXPECT_NEAR(walk.hold(24.0).stiffness_scale, 1.05, 1e-9);
}

TEST(PayloadScale, WhatIsPublishedIsOffAndWhatHangsIsNot) {
  const Scenario s = with("payload_scale", {{"share", 0.05}});
  const Protocol protocol(s);
  EXPECT_DOUBLE_EQ(protocol.at(3.0).payload_kg, 0.1);
  EXPECT_DOUBLE_EQ(protocol.payload_known_at(3.0).kg, 0.105);
}

TEST(Simulated, TendonFrictionBendsLessOnTheWayUpThanOnTheWayDown) {
  Scenario s = laboratory();
  s.gravity_m_s2 = 0.0;
  s.mocap.rate_hz = 50.0;
  s.mocap.ring_fractions = {0.25, 0.5};
  s.payload.schedule.clear();
  s.payload.publish = false;
  s.duration_s = 8.0;
  s.tensions.settle_s = 0.2;
  s.tensions.ramp_s = 1.0;
  s.tensions.schedule = {{0.0, {0.0, 0.0}}, {1.0, {6.0, 0.0}}, {3.0, {12.0, 0.0}}, {5.0, {6.0, 0.0}}};
  s = with("tendon_friction", {{"coefficient", 0.3}, {"routing_rad", 0.5}}, "", s);
  Simulator simulator(s);
  double up = 0.0, down = 0.0, joint_up = 0.0, near_half = 0.0, far_half = 0.0;
  while (const auto sample = simulator.next()) {
    if (std::abs(sample->stamp_s - 2.98) < 1e-6) {
      up = sample->truth.segments[0].moment_nm.x();
      const std::vector<Pose>& rings = sample->truth.rings_base;
      near_half = rings[0].q.angularDistance(Eigen::Quaterniond::Identity());
      far_half = rings[1].q.angularDistance(rings[0].q);
      joint_up = sample->truth.segments[1].moment_nm.x();
    }
    if (std::abs(sample->stamp_s - 6.6) < 1e-6) down = sample->truth.segments[0].moment_nm.x();
  }
  // A segment is bent by M L / EI; friction takes from the tension before it.
  const double theta = up * 0.1 / 0.03;
  const double mean = -std::expm1(-0.3 * theta) / (0.3 * theta);
  EXPECT_NEAR(up, 0.01 * 6.0 * std::exp(-0.3 * 0.5) * mean, 1e-4);
  EXPECT_LT(joint_up, up);
  // Within the segment the tension falls by 1 - e^(-mu theta); half of that from half to half.
  const double fall = -std::expm1(-0.3 * theta) / mean;
  EXPECT_NEAR(far_half / near_half, (1.0 - 0.25 * fall) / (1.0 + 0.25 * fall), 2e-3);
  EXPECT_GT(down, 0.06);
  EXPECT_LT(up, 0.06);
}

TEST(Simulated, CablesThatPassThroughAnotherSegmentBendTheirOwnBack) {
  Scenario s = wound_laboratory();
  s.gravity_m_s2 = 0.0;
  s.mocap.rate_hz = 50.0;
  s.mocap.ring_fractions = {0.5, 1.0};
  s.duration_s = 4.0;
  s.payload.schedule.clear();
  s.payload.publish = false;
  s.angles.rest = 0.6;
  s = with("tendon_length", {{"share", 2.0}}, "held", s);
  Simulator simulator(s);
  const Truth first = simulator.next()->truth;
  // Half the servos' angles towards x and y; of the second segment the same less twice that.
  const Eigen::Quaterniond straight = Eigen::Quaterniond::Identity();
  const double bend = 0.3 * std::sqrt(2.0);
  EXPECT_NEAR(first.rings_base[0].q.angularDistance(straight), bend, 1e-6);
  EXPECT_NEAR(first.rings_base[1].q.angularDistance(straight), 0.0, 1e-6);
  const SegmentTruth& distal = first.segments[1];
  EXPECT_LT((distal.moment_nm + distal.bending_stiffness_nm2 * Eigen::Vector2d(3.0, 3.0)).norm(), 1e-7);
  // Two arcs, there and back.
  EXPECT_NEAR(first.rings_base[1].p.head<2>().norm(), 2.0 * 0.1 / bend * (1.0 - std::cos(bend)), 1e-7);
  const Truth second = simulator.next()->truth;
  EXPECT_LT((second.rings_base[1].p - first.rings_base[1].p).norm(), 1e-7);
}

TEST(Simulated, AGainThatDependsOnTheBendingStartsSettled) {
  Scenario s = laboratory();
  s.gravity_m_s2 = 0.0;
  s.mocap.rate_hz = 50.0;
  s.duration_s = 4.0;
  s.payload.schedule.clear();
  s.pressures.rest = 0.0;
  s.pressures.settle_s = 0.0;
  s.pressures.ramp_s = 0.01;
  s.tensions.rest = 3.0;
  s.tensions.schedule = {{0.0, {3.0, 0.0}}};
  s = with("curvature_gain", {{"share_per_rad", 0.5}}, "", s);
  Simulator simulator(s);
  const Truth first = simulator.next()->truth;
  // Both tendons pull at rest: M = M0 (1 + M L / EI / 2).
  const double alone = 0.03 * std::sqrt(2.0);
  for (const SegmentTruth& segment : first.segments) {
    const double flexibility = segment.length_m / segment.bending_stiffness_nm2;
    EXPECT_NEAR(segment.moment_nm.norm(), alone / (1.0 - 0.5 * alone * flexibility), 1e-7);
  }
  const Truth second = simulator.next()->truth;
  EXPECT_NEAR(second.segments[0].moment_nm.norm(), first.segments[0].moment_nm.norm(), 1e-8);
}

TEST(InputEffects, TableIsSound) {
  std::set<std::string> ids;
  for (const HiddenEffect& effect : hidden_effects()) {
    EXPECT_TRUE(ids.insert(effect.id).second) << effect.id << " stands twice";
    EXPECT_FALSE(effect.words.empty()) << effect.id;
    EXPECT_TRUE(effect.like.empty() || !effect.catalogued) << effect.id;
    std::set<std::string> keys;
    for (const HiddenParameter& p : effect.parameters) {
      EXPECT_TRUE(keys.insert(p.key).second) << effect.id << ": " << p.key;
      EXPECT_LE(p.low, p.usual_low) << effect.id << ": " << p.key;
      EXPECT_LE(p.usual_low, p.usual_high) << effect.id << ": " << p.key;
      EXPECT_LE(p.usual_high, p.high) << effect.id << ": " << p.key;
      if (p.otherwise) {
        EXPECT_GE(*p.otherwise, p.low) << effect.id << ": " << p.key;
        EXPECT_LE(*p.otherwise, p.high) << effect.id << ": " << p.key;
      }
    }
  }
  for (const char* id : {"pressure_lag",
                         "pressure_leak",
                         "gain_nonlinearity",
                         "pressure_dead_zone",
                         "pressure_stiffening",
                         "radial_expansion",
                         "pressure_elongation",
                         "vacuum_shortening",
                         "vacuum_gain",
                         "chamber_mismatch",
                         "bending_plane_offset",
                         "rest_curvature",
                         "torsion",
                         "tendon_friction",
                         "payload_scale",
                         "drift",
                         "axial_memory",
                         "hysteresis",
                         "jamming_settling",
                         "jamming_law",
                         "supply_sag",
                         "supply_ripple",
                         "valve_stiction",
                         "chamber_bulge",
                         "curvature_gain",
                         "tendon_slack",
                         "tendon_length",
                         "temperature",
                         "regulator_error",
                         "flow_limit",
                         "line_delay"})
    EXPECT_EQ(ids.count(id), 1u) << id;
}

TEST(InputEffects, WhatDoesNotFitIsOneLine) {
  const auto says = [](const auto& make) -> std::string {
    try {
      make();
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  Scenario bare = laboratory();
  bare.arm.chambers = bare.arm.tendons = 0;
  for (SegmentSpec& segment : bare.arm.segments) {
    segment.chambers.clear();
    segment.tendons.clear();
    segment.stiffness_per_jamming_nm2_per_pa = 0.0;
  }
  bare.payload.publish = false;
  const auto on_bare = [&](const std::string& id, const std::map<std::string, double>& values,
                           const std::string& form = "") {
    return says([&] { with(id, values, form, bare); });
  };
  EXPECT_THAT(on_bare("pressure_lag", {{"time_constant_s", 1.0}}), HasSubstr("pressures"));
  EXPECT_THAT(on_bare("gain_nonlinearity", {{"share", 0.1}}), HasSubstr("chambers"));
  EXPECT_THAT(on_bare("tendon_friction", {{"coefficient", 0.1}}), HasSubstr("tendons"));
  EXPECT_THAT(on_bare("torsion", {}, "tension"), HasSubstr("tendons"));
  EXPECT_THAT(on_bare("tendon_length", {{"share", 1.0}}), HasSubstr("cables"));
  EXPECT_THAT(on_bare("jamming_law", {}), HasSubstr("per_jamming_pressure"));
  EXPECT_THAT(on_bare("payload_scale", {{"share", 0.1}}), HasSubstr("published"));
  bare.vacuum.schedule.clear();
  EXPECT_THAT(on_bare("vacuum_gain", {{"share", 0.1}}), HasSubstr("schedule"));
  EXPECT_THAT(says([] { with("pressure_leak", {{"chamber", 4.0}, {"share", 0.1}}); }), HasSubstr("0 ... 3"));
  EXPECT_THAT(says([] { with("pressure_leak", {{"chamber", 1.5}, {"share", 0.1}}); }), HasSubstr("whole"));
  EXPECT_THAT(says([] {
                with("rest_curvature", {{"curvature_per_m", 1.0}, {"segment", 3.0}});
              }),
              HasSubstr("0 ... 2"));
  EXPECT_THAT(
      says([] {
        with("flow_limit", {{"rise_pa_per_s", 1e3}}, "", with("flow_limit", {{"rise_pa_per_s", 1e3}}));
      }),
      HasSubstr("twice"));
}

}  // namespace
}  // namespace softarm::rig
