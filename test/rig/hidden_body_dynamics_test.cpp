// What is hidden in the body of the arm, in motion; and the rod's modes that the ideal arm's tests leave out.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "rig/hidden_arm.h"
#include "rig/rods.h"
#include "rig/scenario_text.h"
#include "rig/simulator.h"

namespace softarm::rig {
namespace {

TEST(HiddenBodyDynamics, SecondBendingFrequencyOfACantilever) {
  // A force of the second mode's frequency rings it up; then it swings alone, the first mode taken out by the
  // node of the second at 0.7834 L (Blevins, table 8-1): there only the first moves.
  RitzRodParams params = paper_rod(8);
  params.pieces[0].diameter_m = 0.002;
  const double b = 4.6940911, expected = 2.0 * M_PI / (b * b * std::sqrt(0.03 / std::pow(0.2, 4)));
  RitzRod rod(params);
  RitzRodInputs inputs = paper_inputs();
  ASSERT_TRUE(rod.settle(inputs));
  const double dt = expected / 400.0;
  const int ringing = 400 * 12;
  for (int i = 1; i <= ringing; ++i) {
    const double phase = 2.0 * M_PI * i / 400.0, window = std::sin(M_PI * i / ringing);
    inputs.tip_force_base_n.x() = 2e-3 * window * window * std::sin(phase);
    ASSERT_TRUE(rod.step(inputs, dt));
  }
  inputs.tip_force_base_n.setZero();
  const double period = mean_period(
      [&] {
        EXPECT_TRUE(rod.step(inputs, dt));
        return rod.curvature(0.4711).y();  // where the second mode bends most
      },
      dt, 400 * 12);
  EXPECT_NEAR(period / expected, 1.0, 0.005);
}

TEST(HiddenBodyDynamics, StiffArmOnASoftHingeSwingsAsACompoundPendulum) {
  for (double offset_m : {0.0, 0.05}) {
    HiddenArm arm;
    arm.scenario.mount.q_mocap_base = Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0);
    arm.scenario.gravity_m_s2 = 9.81;
    arm.scenario.arm.segments[0].diameter_m = 0.002;
    arm.actuation.bending_stiffness_nm2 = arm.actuation.torsional_stiffness_nm2 = 1e3;
    arm.scenario.body.base_stiffness_nm_per_rad = 0.05;
    arm.scenario.body.payload_offset_m = {0.0, 0.0, offset_m};
    arm.inputs.payload_kg = 0.1;
    arm.inputs.tip_force_base_n = {0.02, 0.0, 0.0};
    RitzRod rod = arm.settled();
    arm.inputs.tip_force_base_n.setZero();
    const double far = 0.2 + offset_m;
    const double inertia = 0.2 * 0.2 * 0.2 / 3.0 + 0.1 * far * far;
    const double restoring = 0.05 + 9.81 * (0.2 * 0.1 + 0.1 * far);
    const double expected = 2.0 * M_PI * std::sqrt(inertia / restoring), dt = expected / 300.0;
    const double period = mean_period(
        [&] {
          EXPECT_TRUE(rod.step(arm.now(), dt));
          return rod.pose(1.0).translation().x();
        },
        dt, 1500);
    EXPECT_NEAR(period / expected, 1.0, 0.002) << offset_m;
  }
}

TEST(HiddenBodyDynamics, HeldMomentCreepsByItsShare) {
  HiddenArm arm;
  arm.scenario.arm.segments[0].retardation_s = 0.02;
  arm.scenario.body.creep = Creep{0.2, 3.0, false};
  RitzRod rod = arm.settled();
  arm.actuation.moment_nm = {0.15, 0.0};
  const double dt = 1.0 / 240.0;
  for (int i = 0; i < 720; ++i) ASSERT_TRUE(rod.step(arm.now(), dt));
  // Kelvin-Voigt damping of 20 ms delays it a little.
  EXPECT_NEAR(rod.curvature(0.5).y(), 5.0 * (1.0 + 0.2 * (1.0 - std::exp(-1.0))), 0.01);
  EXPECT_NEAR(arm.settled().curvature(0.5).y(), 5.0 * 1.2, 1e-7);
}

/// Everything in a body that keeps or burns energy, one at a time.
std::vector<HiddenArm> passive_arms() {
  std::vector<HiddenArm> arms(14);
  arms[1].scenario.body.stiffening = Stiffening{2e-3, true};
  arms[2].scenario.body.creep = Creep{0.3, 0.3, true};
  arms[3].scenario.body.hysteresis = MaterialHysteresis{0.5, 1.0};
  arms[4].scenario.body.first_loading = FirstLoading{0.3, 2.0, true};
  arms[5].scenario.body.core = JammedCore{1.0, 2.0, false};
  arms[6].scenario.body.core = JammedCore{0.0, 2.0, true};
  arms[7].scenario.body.tether = Tether{5.0, 1.0, 0.1, true, 0.005, 0.02};
  arms[8].scenario.body.wall = Wall{100.0, 0.02, 0.0, 0.7, true, 0.0, 0.4};
  arms[9].scenario.body.base_play_rad = 0.01;
  arms[10].scenario.body.payload_offset_m = {0.01, 0.0, 0.02};
  arms[11].scenario.body.soft_spot = SoftSpot{0.5, 0.2, 0.4};
  arms[12].scenario.body.kink = Kink{{0.3, 0.36}, 0.5, 2.0, 1.0};
  arms[13].scenario.body.joint_play = JointPlay{{0.4, 0.42}, 0.01};
  for (HiddenArm& arm : arms) {
    arm.scenario.mount.q_mocap_base = Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0);
    arm.scenario.gravity_m_s2 = 9.81;
    arm.scenario.arm.segments[0].retardation_s = 0.01;
    arm.actuation.core_stiffness_nm2 = 0.01;
    arm.inputs.payload_kg = 0.1;
  }
  return arms;
}

TEST(HiddenBodyDynamics, LetGoTheEnergyOnlyFallsWhateverIsHidden) {
  std::vector<HiddenArm> arms = passive_arms();
  for (std::size_t i = 0; i < arms.size(); ++i) {
    HiddenArm& arm = arms[i];
    arm.inputs.tip_force_base_n = {-0.6, 0.3, 0.0};
    RitzRod rod = arm.settled();
    arm.inputs.tip_force_base_n.setZero();
    ASSERT_TRUE(rod.step(arm.now(), 1e-3)) << i;
    const double start = rod.energy_j();
    double last = start, end = start;
    for (int k = 0; k < 500; ++k) {
      ASSERT_TRUE(rod.step(arm.now(), 1e-3)) << i << " " << k;
      end = rod.energy_j();
      ASSERT_LT(end, last + 1e-9) << i << " " << k;
      last = end;
    }
    EXPECT_LT(end, start - 0.002) << i;
  }
}

TEST(HiddenBodyDynamics, ThirdOrderInTimeWithLawsAndLoads) {
  const auto tip_after = [](int steps) {
    HiddenArm arm;
    arm.scenario.mount.q_mocap_base = Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0);
    arm.scenario.gravity_m_s2 = 9.81;
    arm.scenario.arm.segments[0].retardation_s = 0.02;
    arm.scenario.body.stiffening = Stiffening{2e-3, false};
    arm.scenario.body.creep = Creep{0.3, 0.5, true};
    arm.scenario.body.core = JammedCore{0.8, 0.0, false};
    arm.scenario.body.tether = Tether{5.0, 0.5, 0.02, false, 0.0, 0.0};
    arm.scenario.body.payload_offset_m = {0.005, 0.0, 0.02};
    arm.scenario.body.stiffness_taper = 0.2;
    arm.inputs.payload_kg = 0.1;
    RitzRod rod = arm.settled();
    const double dt = 0.5 / steps;
    for (int i = 1; i <= steps; ++i) {
      const double t = i * dt;
      arm.actuation.moment_nm = {0.5 * t * t * std::sin(6.0 * t), 1.2 * t * t * t};
      arm.actuation.core_stiffness_nm2 = 0.01 * t;
      EXPECT_TRUE(rod.step(arm.now(), dt));
    }
    return Eigen::Vector3d(rod.pose(1.0).translation());
  };
  const Eigen::Vector3d coarse = tip_after(120), middle = tip_after(240), fine = tip_after(480);
  EXPECT_NEAR(std::log2((coarse - middle).norm() / (middle - fine).norm()), 3.0, 0.3);
}

/// The truth's rings at some instants of a second with the first chamber blown up and vacuum drawn.
std::vector<Eigen::Vector3d> rings(const std::string& hidden, int elements = NumericsSpec{}.elements) {
  std::string text = kScenarioText;
  const auto replace = [&text](const std::string& from, const std::string& to) {
    ASSERT_NE(text.find(from), std::string::npos);
    text.replace(text.find(from), from.size(), to);
  };
  replace("duration_s: 10", "duration_s: 1.6");
  replace("settle_s: 0.5\n  ramp_s: 2", "settle_s: 0.05\n  ramp_s: 0.5");
  replace("    per_min", "    per_jamming_pressure_nm2_per_pa: 2.0e-7\n    per_min");
  text +=
      "vacuum:\n  ramp_s: 0.3\n  schedule:\n    - {t_s: 0, vacuum_pa: 0}\n    - {t_s: 0.7, vacuum_pa: "
      "40000}\n";
  text += "numerics: {max_step_s: 0.0021, elements: " + std::to_string(elements) + "}\n";
  Simulator simulator(parse_scenario(text + hidden, "case.yaml"));
  std::vector<Eigen::Vector3d> result;
  std::size_t frame = 0;
  while (const std::optional<Sample> sample = simulator.next())
    if (frame++ % 8 == 0)
      for (const Pose& ring : sample->truth.rings_base) result.push_back(ring.p);
  return result;
}

double largest_difference(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b) {
  EXPECT_EQ(a.size(), b.size());
  double most = 0.0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) most = std::max(most, (a[i] - b[i]).norm());
  return most;
}

TEST(HiddenBodyDynamics, AbsentIsTheIdealArm) {
  constexpr int kFine = 6;  // the arm is cut in another way where something is hidden
  const std::vector<Eigen::Vector3d> ideal = rings("", kFine);
  for (const char* hidden : {"stiffness_taper, share: 0",
                             "actuation_taper, share: 0",
                             "soft_spot, centre_fraction: 0.5, width_fraction: 0.2, share: 0",
                             "mass_distribution, share: 0",
                             "strain_stiffening, beta_m2: 0",
                             "creep, share: 0, time_s: 20",
                             "mullins, share: 0",
                             "jamming_memory, share: 0",
                             "jamming_yield, yield_per_m: 1000",
                             "plane_stiffness, share: 0, azimuth_deg: 20",
                             "one_sided_softness, share: 0, azimuth_deg: 20",
                             "base_tilt, angle_deg: 0, azimuth_deg: 9",
                             "gravity_direction, angle_deg: 0, azimuth_deg: 9",
                             "base_free_play, play_deg: 0",
                             "curvature_softening, share: 0, knee_per_m: 2",
                             "payload_offset",
                             "tip_mass, mass_kg: 0",
                             "tether, stiffness_n_per_m: 0",
                             "contact, stiffness_n_per_m: 50, distance_m: 1, azimuth_deg: 0",
                             "hysteresis, form: material, loop_per_m: 0",
                             "draught, force_n: 0, correlation_s: 2",
                             "kink, share: 0, fraction: 0.4, fold_per_m: 1",
                             "joint_play, play_deg: 0, fraction: 0.4"})
    EXPECT_LT(largest_difference(rings("hidden: [{effect: " + std::string(hidden) + "}]\n", kFine), ideal),
              1e-8)
        << hidden;
}

TEST(HiddenBodyDynamics, EveryEffectAndFormMovesTheArm) {
  const std::vector<Eigen::Vector3d> ideal = rings("");
  for (const char* hidden :
       {"stiffness_taper, share: 0.2",
        "stiffness_taper, form: step, share: 0.2",
        "actuation_taper, share: 0.1",
        "actuation_taper, form: step, share: 0.1",
        "soft_spot, centre_fraction: 0.5, width_fraction: 0.15, share: 0.3",
        "soft_spot, form: bell, centre_fraction: 0.5, width_fraction: 0.15, share: 0.3",
        "rigid_ends, base_m: 0.015, tip_m: 0.01",
        "mass_distribution, share: 0.2",
        "mass_distribution, form: lump, share: 0.2, lump_fraction: 0.4",
        "axial_compliance, axial_stiffness_n: 150",
        "shear, shear_stiffness_n: 45",
        "strain_stiffening, beta_m2: 2.0e-3",
        "strain_stiffening, form: gent, beta_m2: 2.0e-3",
        "creep, share: 0.2, time_s: 5",
        "creep, form: prony, share: 0.2, time_s: 5",
        "creep, form: wall, share: 0.2, time_s: 5",
        "creep, form: wall, share: 0.2, time_s: 5, left_nm: 0.01",
        "mullins, share: 0.2",
        "mullins, form: softening, share: 0.2",
        "jamming_memory, share: 1",
        "jamming_yield, yield_per_m: 0.1",
        "jamming_yield, form: bouc_wen, yield_per_m: 0.1",
        "plane_stiffness, share: 0.3, azimuth_deg: 20",
        "one_sided_softness, share: 0.3, azimuth_deg: 20",
        "plane_stiffness, form: ribs, share: 0.3, azimuth_deg: 20",
        "one_sided_softness, form: folds, share: 0.3, azimuth_deg: 20",
        "base_compliance, stiffness_nm_per_rad: 5",
        "base_tilt, angle_deg: 1, azimuth_deg: 9",
        "gravity_direction, angle_deg: 1, azimuth_deg: 9",
        "base_free_play, play_deg: 1",
        "base_free_play, form: bush, play_deg: 1",
        "curvature_softening, share: 0.3, knee_per_m: 1",
        "curvature_softening, form: wrinkling, share: 0.3, knee_per_m: 1",
        "payload_offset, axial_m: 0.02",
        "tip_mass, mass_kg: 0.02",
        "tether, stiffness_n_per_m: 2",
        "tether, form: hose, stiffness_n_per_m: 2, hose_kg: 0.02",
        "contact, stiffness_n_per_m: 50, distance_m: 0.0005, azimuth_deg: 0",
        "contact, form: rough_wall, stiffness_n_per_m: 50, distance_m: 0.0005, azimuth_deg: 0",
        "hysteresis, form: material, loop_per_m: 0.5",
        "draught, force_n: 0.01, correlation_s: 2",
        "draught, form: sheltered, force_n: 0.01, correlation_s: 2",
        "kink, share: 0.4, fraction: 0.4, fold_per_m: 0.5",
        "joint_play, play_deg: 0.5, fraction: 0.4"})
    EXPECT_GT(largest_difference(rings("hidden: [{effect: " + std::string(hidden) + "}]\n"), ideal), 5e-6)
        << hidden;
}

TEST(HiddenBodyDynamics, WhatDoesNotFitIsRefused) {
  for (const char* hidden : {"soft_spot, centre_fraction: 0.05, width_fraction: 0.3, share: 0.3",
                             "rigid_ends, base_m: 0.1, tip_m: 0.1",
                             "contact, form: rough_wall, stiffness_n_per_m: 50, distance_m: 0.1, "
                             "azimuth_deg: 0, inclination_deg: 90",
                             "tip_mass, mass_kg: 0.01}, {effect: tip_mass, mass_kg: 0.02"})
    EXPECT_THROW(rings("hidden: [{effect: " + std::string(hidden) + "}]\n"), ScenarioError) << hidden;
  EXPECT_THROW(parse_scenario(std::string(kScenarioText) + "hidden: [{effect: jamming_memory, share: 1}]\n",
                              "case.yaml"),
               ScenarioError);
}

}  // namespace
}  // namespace softarm::rig
