// Departures of the laws against hand-computed cases.
#include <gtest/gtest.h>

#include <cmath>

#include "rig/hidden_inputs.h"

namespace softarm::rig {
namespace {

constexpr double kGain = 6e-6;

/// What a segment makes of commands in a scenario.
Actuation under(const Scenario& s, const Commands& c, double bend_rad = 0.0, int segment = 0) {
  Acting acting(c);
  acting.segment = segment;
  acting.bend_rad = bend_rad;
  return apply_laws(s.arm.segments[static_cast<std::size_t>(segment)], acting, s.input_path.laws);
}

Actuation ideal(const Commands& c) {
  return under(laboratory(), c);
}

Commands evacuated(Commands c, double vacuum_pa) {
  c.vacuum_pa = vacuum_pa;
  return c;
}

TEST(GainNonlinearity, BothFormsMeetAtTheReferenceAndOnlyOneGoesOn) {
  const Scenario quadratic = with("gain_nonlinearity", {{"share", 0.2}}),
                 saturating = with("gain_nonlinearity", {{"share", 0.2}}, "saturating");
  EXPECT_NEAR(under(quadratic, commands(25e3)).moment_nm.x(), kGain * 25e3 * 1.1, 1e-12);
  EXPECT_NEAR(under(quadratic, commands(50e3)).moment_nm.x(), kGain * 50e3 * 1.2, 1e-12);
  EXPECT_NEAR(under(saturating, commands(50e3)).moment_nm.x(), kGain * 50e3 * 1.2, 1e-12);
  const double at_25 = 0.2 * (1.0 - std::exp(-0.5)) / (1.0 - std::exp(-1.0));
  EXPECT_NEAR(under(saturating, commands(25e3)).moment_nm.x(), kGain * 25e3 * (1.0 + at_25), 1e-12);
  EXPECT_NEAR(under(quadratic, commands(500e3)).moment_nm.x(), kGain * 500e3 * 3.0, 1e-9);
  EXPECT_LT(under(saturating, commands(500e3)).moment_nm.x(), kGain * 500e3 * 1.32);
  EXPECT_EQ(under(quadratic, commands(25e3)).length_m, ideal(commands(25e3)).length_m);
}

TEST(DeadZone, SharpAndSmooth) {
  const Scenario sharp = with("pressure_dead_zone", {{"pressure_pa", 3e3}}),
                 smooth = with("pressure_dead_zone", {{"pressure_pa", 3e3}}, "smooth");
  EXPECT_EQ(under(sharp, commands(2.9e3)).moment_nm.norm(), 0.0);
  EXPECT_NEAR(under(sharp, commands(10e3)).moment_nm.x(), kGain * 7e3, 1e-12);
  EXPECT_NEAR(under(sharp, commands(-10e3)).moment_nm.x(), -kGain * 7e3, 1e-12);
  EXPECT_EQ(under(smooth, commands(0.0)).moment_nm.norm(), 0.0);
  // At its edge a width of 750 Pa times ln 2, less 750 ln(1 + e^-4).
  EXPECT_NEAR(under(smooth, commands(3e3)).moment_nm.x(),
              kGain * 750.0 * (std::log(2.0) - std::log1p(std::exp(-4.0))), 1e-12);
  EXPECT_NEAR(under(smooth, commands(30e3)).moment_nm.x(), kGain * 27e3, kGain * 15.0);
}

TEST(PressureStiffening, GoesWithTheMeanPressure) {
  const Commands c = commands(60e3, 15e3, 0.0);  // mean: half the reference
  const double before = ideal(c).bending_stiffness_nm2;
  EXPECT_NEAR(under(with("pressure_stiffening", {{"share", 0.2}}), c).bending_stiffness_nm2, before * 1.1,
              1e-12);
  EXPECT_NEAR(under(with("pressure_stiffening", {{"share", 0.2}}, "quadratic"), c).bending_stiffness_nm2,
              before * 1.05, 1e-12);
  EXPECT_EQ(under(with("pressure_stiffening", {{"share", 0.2}}), commands()).bending_stiffness_nm2,
            ideal(commands()).bending_stiffness_nm2);
}

TEST(RadialExpansion, SquareAndFourthPowerOfTheRadius) {
  const Commands c = commands(50e3, 50e3, 50e3);
  const Actuation square = under(with("radial_expansion", {{"share", 0.1}}), c),
                  fourth = under(with("radial_expansion", {{"share", 0.1}}, "fourth_power"), c);
  EXPECT_NEAR(square.bending_stiffness_nm2, ideal(c).bending_stiffness_nm2 * 1.21, 1e-12);
  EXPECT_NEAR(fourth.bending_stiffness_nm2, ideal(c).bending_stiffness_nm2 * 1.4641, 1e-12);
  EXPECT_NEAR(fourth.torsional_stiffness_nm2, 0.02 * 1.4641, 1e-12);
}

TEST(Length, GrowsWithPressureAndShrinksWithVacuum) {
  const Commands c = commands(50e3, 50e3, 50e3);
  EXPECT_NEAR(under(with("pressure_elongation", {{"share", 0.026}}), c).length_m, ideal(c).length_m * 1.026,
              1e-12);
  EXPECT_NEAR(under(with("vacuum_shortening", {{"share", 0.01}}), evacuated(c, 30e3)).length_m,
              ideal(c).length_m * 0.995, 1e-12);
}

TEST(Vacuum, LowersTheGainAndStiffensByItsLaw) {
  const Commands c = evacuated(commands(20e3), 30e3);
  EXPECT_NEAR(under(with("vacuum_gain", {{"share", 0.1}}), c).moment_nm.x(), kGain * 20e3 * 0.95, 1e-12);
  const auto added = [&](const Scenario& s, double vacuum_pa) {
    return under(s, evacuated(commands(), vacuum_pa)).bending_stiffness_nm2 - 0.03;
  };
  const Scenario power = with("jamming_law", {{"exponent", 0.5}}, "power"),
                 saturating = with("jamming_law", {{"scale_pa", 20e3}}, "saturating");
  for (const Scenario& s : {power, saturating}) {
    EXPECT_NEAR(added(s, 60e3), 1e-7 * 60e3, 1e-12);
    EXPECT_NEAR(added(s, 0.0), 0.0, 1e-15);
  }
  EXPECT_NEAR(added(power, 15e3), 1e-7 * 30e3, 1e-12);
  EXPECT_NEAR(added(saturating, 20e3), 1e-7 * 60e3 * (1.0 - std::exp(-1.0)) / (1.0 - std::exp(-3.0)), 1e-12);
}

TEST(Geometry, OneChamberDiffers) {
  const Scenario s = with("chamber_mismatch", {{"chamber", 2.0}, {"share", 0.05}});
  for (std::size_t i = 0; i < 3; ++i) {
    Commands c = commands();
    c.pressures_pa[i] = 10e3;
    EXPECT_NEAR(under(s, c).moment_nm.norm(), kGain * 10e3 * (i == 1 ? 1.05 : 1.0), 1e-12);
  }
}

TEST(Geometry, AllActuatorsAreTurned) {
  const Scenario s = with("bending_plane_offset", {{"angle_deg", 5.0}});
  Commands c = commands(20e3, 5e3, 0.0);
  c.tensions_n = {2.0, 1.0};
  const Eigen::Vector2d before = ideal(c).moment_nm, after = under(s, c).moment_nm;
  EXPECT_NEAR(after.norm(), before.norm(), 1e-12);
  EXPECT_NEAR(std::atan2(after.y(), after.x()) - std::atan2(before.y(), before.x()), 5.0 * M_PI / 180.0,
              1e-12);
}

TEST(Geometry, RestCurvatureIsThereWithoutInputAndOnlyWhereItIs) {
  const Scenario s =
      with("rest_curvature", {{"curvature_per_m", 0.2}, {"azimuth_deg", 90.0}, {"segment", 2.0}});
  EXPECT_EQ(under(s, commands()).moment_nm.norm(), 0.0);
  for (double p : {0.0, 40e3}) {  // fixed in the body, whatever EI
    const Actuation a = under(s, commands(p, p, p), 0.0, 1);
    EXPECT_NEAR(a.moment_nm.y() / a.bending_stiffness_nm2, 0.2, 1e-9);
    EXPECT_NEAR(a.moment_nm.x(), 0.0, 1e-12);
  }
}

TEST(Torsion, ComplianceAndTwistWithPressureOrTension) {
  const Scenario soft = with("torsion", {{"stiffness_ratio", 0.5}}, "compliance");
  EXPECT_NEAR(under(soft, commands()).torsional_stiffness_nm2, 0.015, 1e-12);
  const Scenario pressure = with("torsion", {{"twist_deg", 4.0}}, "pressure");
  const Actuation a = under(pressure, commands(25e3, 25e3, 25e3));
  EXPECT_NEAR(a.twist_moment_nm / a.torsional_stiffness_nm2 * a.length_m, 2.0 * M_PI / 180.0, 1e-12);
  EXPECT_EQ(ideal(commands(25e3)).twist_moment_nm, 0.0);
  Commands pulled = commands();
  pulled.tensions_n = {3.0, 3.0};
  const Scenario tension = with("torsion", {{"twist_deg", 4.0}}, "tension");
  EXPECT_NEAR(under(tension, pulled).twist_moment_nm * under(tension, pulled).length_m / 0.02,
              4.0 * M_PI / 180.0, 1e-12);
}

TEST(OutsideTheCatalogue, BulgeIsAProductOfPressures) {
  const Scenario s = with("chamber_bulge", {{"share", 0.2}});
  EXPECT_NEAR(under(s, commands(20e3)).moment_nm.x(), kGain * 20e3, 1e-12);
  // c p1 p2 (d1 + d2) more, with c = gain * share / reference.
  const Eigen::Vector2d more =
      under(s, commands(20e3, 30e3)).moment_nm - ideal(commands(20e3, 30e3)).moment_nm;
  const Eigen::Vector2d directions(1.0 + std::cos(2.0 * M_PI / 3.0), std::sin(2.0 * M_PI / 3.0));
  EXPECT_LT((more - kGain * 0.2 / 50e3 * 20e3 * 30e3 * directions).norm(), 1e-12);
}

TEST(OutsideTheCatalogue, BulgeThatSaturatesIsTheSameAtTheReference) {
  const Scenario s = with("chamber_bulge", {{"share", 0.2}}, "saturating");
  const auto more = [&](double others_pa) {
    const Commands c = commands(20e3, others_pa);
    return (under(s, c).moment_nm - ideal(c).moment_nm).x() -
           kGain * others_pa * 0.2 * 2.0 * 0.4 / 1.4 * std::cos(2.0 * M_PI / 3.0);
  };
  EXPECT_NEAR(more(50e3), kGain * 20e3 * 0.2, 1e-12);
  EXPECT_NEAR(more(25e3), kGain * 20e3 * 0.2 * 2.0 / 3.0, 1e-12);
}

TEST(CableSlack, IsTakenUpBeforeTheCablePulls) {
  Scenario wound = laboratory();
  wound.arm.servos = 1;
  for (SegmentSpec& segment : wound.arm.segments) {
    segment.chambers.clear();
    segment.tendons.clear();
    segment.cables = {CableSpec{0, 0.0, 0.01, 0.02}};
  }
  const auto pull = [&](double angle_rad, const Scenario& s) {
    Commands c;
    c.angles_rad = {angle_rad};
    return apply_laws(s.arm.segments[0], Acting(c), s.input_path.laws).moment_nm.norm();
  };
  const double slack_rad = 5.0 * M_PI / 180.0;
  const Scenario taut = with("tendon_slack", {{"angle_deg", 5.0}}, "taut", wound),
                 sags = with("tendon_slack", {{"angle_deg", 5.0}}, "sags", wound);
  EXPECT_EQ(pull(0.9 * slack_rad, taut), 0.0);
  EXPECT_NEAR(pull(0.5, taut), pull(0.5 - slack_rad, wound), 1e-12);
  EXPECT_NEAR(pull(-0.5, taut), pull(0.5, taut), 1e-15);
  EXPECT_NEAR(pull(slack_rad, sags), pull(slack_rad * std::exp(-1.0), wound), 1e-12);
}

TEST(CablesThroughSegments, LackWhatThoseBendTowardsThem) {
  const Scenario wound = wound_laboratory();
  const auto curvature = [&](const Scenario& s, const Eigen::Vector2d& angles_rad,
                             const Eigen::Vector2d& before_rad) {
    Commands c;
    c.angles_rad = {0.0, 0.0, angles_rad.x(), angles_rad.y()};
    Acting acting(c);
    acting.bent_before_rad = before_rad;
    const Actuation a = apply_laws(s.arm.segments[1], acting, s.input_path.laws);
    return Eigen::Vector2d(a.moment_nm / a.bending_stiffness_nm2);
  };
  // A spool of half the lever: half the angle over 0.1 m.
  const Eigen::Vector2d angles(0.4, 0.2), before(0.3, -0.1), none = Eigen::Vector2d::Zero();
  EXPECT_LT((curvature(wound, angles, before) - 5.0 * angles).norm(), 1e-12);
  const Scenario held = with("tendon_length", {{"share", 0.8}}, "held", wound),
                 slackens = with("tendon_length", {{"share", 0.8}}, "slackens", wound);
  for (const Scenario& s : {held, slackens}) {
    EXPECT_LT((curvature(s, angles, none) - 5.0 * angles).norm(), 1e-12);
    // 0.2 - 0.24 and 0.1 + 0.08, over 0.1 m: the first is slack.
    const Eigen::Vector2d left(s.input_path.laws.cables_through->slackens ? 0.0 : -0.4, 1.8);
    EXPECT_LT((curvature(s, angles, before) - left).norm(), 1e-12);
  }
}

TEST(CablesThroughSegments, ThatAreSlackLoseNoMore) {
  const Scenario slackens = with("tendon_length", {{"share", 1.0}}, "slackens", wound_laboratory());
  const auto curvature = [&](double angle_rad, double before_rad) {
    Commands c;
    c.angles_rad = {0.0, 0.0, angle_rad, 0.0};
    Acting acting(c);
    acting.bent_before_rad = {before_rad, 0.0};
    const Actuation a = apply_laws(slackens.arm.segments[1], acting, slackens.input_path.laws);
    return a.moment_nm.x() / a.bending_stiffness_nm2;
  };
  EXPECT_NEAR(curvature(-0.2, 0.3), -1.0, 1e-12);
  EXPECT_NEAR(curvature(-0.2, -0.3), 2.0, 1e-12);  // drawn tight
  for (double before_rad : {-0.3, 0.0, 0.3})       // no jump where it begins to be wound up
    EXPECT_NEAR(curvature(-1e-9, before_rad), curvature(1e-9, before_rad), 1e-7);
}

TEST(CablesThroughSegments, AreTakenUpByAllSegmentsBefore) {
  Scenario s = wound_laboratory();
  s.arm.segments.push_back(s.arm.segments.back());
  Commands c;
  c.angles_rad = std::vector<double>(4, 0.0);
  EXPECT_FALSE(InputPath(s, c).feels_bending());
  InputPath path(with("tendon_length", {{"share", 1.0}}, "held", s), c);
  EXPECT_TRUE(path.feels_bending());
  const std::vector<Acting> acting =
      path.act(c, 0.01, {{0.5, {0.3, 0.4}}, {0.2, {-0.2, 0.0}}, {0.1, {0.1, 0.0}}});
  EXPECT_EQ(acting[0].bent_before_rad, Eigen::Vector2d(0.0, 0.0));
  EXPECT_EQ(acting[1].bent_before_rad, Eigen::Vector2d(0.3, 0.4));
  EXPECT_LT((acting[2].bent_before_rad - Eigen::Vector2d(0.1, 0.4)).norm(), 1e-15);
}

TEST(OutsideTheCatalogue, GainGoesWithTheBending) {
  const Scenario s = with("curvature_gain", {{"share_per_rad", 0.1}});
  EXPECT_NEAR(under(s, commands(20e3), 0.5).moment_nm.x(), kGain * 20e3 * 1.05, 1e-12);
  EXPECT_NEAR(under(s, commands(20e3), 0.0).moment_nm.x(), kGain * 20e3, 1e-12);
}

TEST(Age, ScalesReachEveryStiffnessAndMoment) {
  Commands c = commands(20e3, 0.0, 10e3);
  c.tensions_n = {1.0, 0.0};
  Acting acting(c);
  const SegmentSpec segment = laboratory().arm.segments[0];
  const Actuation before = apply_laws(segment, acting);
  acting.gain_scale = 0.9;
  acting.length_scale = 1.01;
  const Actuation other = apply_laws(segment, acting);
  EXPECT_LT((other.moment_nm - 0.9 * before.moment_nm).norm(), 1e-12);
  EXPECT_NEAR(other.length_m, 1.01 * before.length_m, 1e-12);
  acting = Acting(c);
  acting.stiffness_scale = 0.8;
  const Actuation softer = apply_laws(segment, acting);
  EXPECT_NEAR(softer.bending_stiffness_nm2, 0.8 * before.bending_stiffness_nm2, 1e-12);
  EXPECT_NEAR(softer.torsional_stiffness_nm2 - 1e-4, 0.8 * 0.02, 1e-12);
  EXPECT_NEAR(*softer.shear_stiffness_n - 1.0, 0.8 * 60.0, 1e-9);
  // One newton shortens the softer wall by 1 / 400.
  EXPECT_NEAR(softer.stretch, 1.0 - 1.0 / 400.0, 1e-12);
}

}  // namespace
}  // namespace softarm::rig
