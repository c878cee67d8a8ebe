// The rig's motion against closed forms: frequencies, energy, order in time, settling.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "rig/rods.h"

namespace softarm::rig {
namespace {

/// First eigenvalue of a cantilever with a tip mass of `ratio` times its own: smallest root of
/// 1 + cos b cosh b + ratio b (cos b sinh b - sin b cosh b) = 0.
double cantilever_eigenvalue(double ratio) {
  const auto f = [ratio](double b) {
    return 1.0 + std::cos(b) * std::cosh(b) +
           ratio * b * (std::cos(b) * std::sinh(b) - std::sin(b) * std::cosh(b));
  };
  double low = 0.1, high = 2.0;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (f(middle) > 0.0 ? low : high) = middle;
  }
  return low;
}

TEST(RigDynamics, FirstBendingFrequencyOfACantilever) {
  EXPECT_NEAR(cantilever_eigenvalue(0.0), 1.8751041, 1e-6);
  for (double payload : {0.0, 0.1, 0.3}) {
    RitzRodParams params = paper_rod();
    params.pieces[0].diameter_m = 0.002;  // the formula knows no rotary inertia
    RitzRod rod(params);
    RitzRodInputs inputs = paper_inputs();
    inputs.payload_kg = payload;
    inputs.tip_force_base_n = {0.01, 0.0, 0.0};
    ASSERT_TRUE(rod.settle(inputs));
    inputs.tip_force_base_n.setZero();
    const double dt = 5e-4;
    const double period = mean_period(
        [&] {
          EXPECT_TRUE(rod.step(inputs, dt));
          return rod.pose(1.0).translation().x();
        },
        dt, static_cast<int>(6.0 / dt));
    const double b = cantilever_eigenvalue(payload / params.pieces[0].mass_kg);
    const double expected =
        2.0 * M_PI / (b * b * std::sqrt(0.03 / (params.pieces[0].mass_kg / 0.2 * std::pow(0.2, 4))));
    EXPECT_NEAR(period / expected, 1.0, 0.004) << payload;
  }
}

TEST(RigDynamics, FirstTorsionalFrequency) {
  RitzRodParams params = paper_rod();
  RitzRod rod(params);
  RitzRodInputs inputs = paper_inputs();
  inputs.pieces[0].moment_section_nm = {0.0, 0.0, 0.02};
  ASSERT_TRUE(rod.settle(inputs));
  inputs.pieces[0].moment_section_nm.setZero();
  // 4 L sqrt(rho J / GJ), rho J = mass per length * a^2 / 2 for a disc of radius a.
  const double expected = 4.0 * 0.2 * std::sqrt(1.0 * 0.02 * 0.02 / 2.0 / 0.03);
  const double dt = expected / 800.0;
  const double period = mean_period(
      [&] {
        EXPECT_TRUE(rod.step(inputs, dt));
        const Eigen::Matrix3d r = rod.pose(1.0).linear();
        return std::atan2(r(1, 0), r(0, 0));
      },
      dt, 8000);
  EXPECT_NEAR(period / expected, 1.0, 0.01);
}

/// A rod let go far from its equilibrium, out of plane.
RitzRod released_rod(RitzRodParams params, RitzRodInputs& inputs) {
  params.gravity_base_m_s2 = {0.0, 0.0, 9.81};
  RitzRod rod(params);
  inputs = paper_inputs();
  inputs.payload_kg = 0.1;
  inputs.pieces[0].moment_section_nm = {-0.1, 0.2, 0.0};
  inputs.tip_force_base_n = {0.5, 1.0, 0.0};
  EXPECT_TRUE(rod.settle(inputs));
  inputs.tip_force_base_n.setZero();
  return rod;
}

TEST(RigDynamics, EnergyOfTheUndampedRodNeverGrowsAndHardlyFalls) {
  RitzRodInputs inputs;
  RitzRod rod = released_rod(paper_rod(), inputs);
  RitzRodInputs rest_inputs = inputs;
  RitzRodParams rest_params = paper_rod();
  rest_params.gravity_base_m_s2 = {0.0, 0.0, 9.81};
  RitzRod rest(rest_params);
  ASSERT_TRUE(rest.settle(rest_inputs));
  const double ground = rest.energy_j();
  const double dt = 1e-3;
  ASSERT_TRUE(rod.step(inputs, dt));
  const double start = rod.energy_j() - ground;
  ASSERT_GT(start, 0.01);
  double most = start;
  for (int i = 0; i < 3000; ++i) {
    ASSERT_TRUE(rod.step(inputs, dt));
    most = std::max(most, rod.energy_j() - ground);
  }
  EXPECT_LT(most, 1.002 * start);
  EXPECT_GT(rod.energy_j() - ground, 0.9 * start);
}

TEST(RigDynamics, DampedRodSettlesToStatics) {
  RitzRodParams params = paper_rod();
  params.pieces[0].retardation_s = 0.05;
  params.air_damping_n_s_m2 = 2.0;
  RitzRodInputs inputs;
  RitzRod rod = released_rod(params, inputs);
  params.gravity_base_m_s2 = {0.0, 0.0, 9.81};
  RitzRod rest(params);
  ASSERT_TRUE(rest.settle(inputs));
  const double dt = 1.0 / 480.0;
  double last = 0.0;
  for (int i = 0; i < 480 * 6; ++i) {
    ASSERT_TRUE(rod.step(inputs, dt));
    const double energy = rod.energy_j() - rest.energy_j();
    if (i > 2) {
      ASSERT_LT(energy, last + 1e-9) << i;  // decays in every step
    }
    last = energy;
  }
  EXPECT_NEAR(last, 0.0, 1e-8);
  for (double fraction : {0.25, 0.5, 0.75, 1.0})
    EXPECT_LT((rod.pose(fraction).translation() - rest.pose(fraction).translation()).norm(), 2e-6);
  EXPECT_LT(rod.velocity(1.0).norm(), 1e-4);
}

TEST(RigDynamics, SettlesToAnIndependentElasticaAfterAPayloadStep) {
  RitzRodParams params = paper_rod();
  params.gravity_base_m_s2 = {0.0, 0.0, 9.80665};
  params.pieces[0].retardation_s = 0.1;
  RitzRod rod(params);
  RitzRodInputs inputs = paper_inputs();
  inputs.pieces[0].moment_section_nm = {0.0, 0.3, 0.0};
  ASSERT_TRUE(rod.settle(inputs));
  inputs.payload_kg = 0.23;
  for (int i = 0; i < 480 * 8; ++i) ASSERT_TRUE(rod.step(inputs, 1.0 / 480.0));
  PlanarElastica reference;
  reference.gravity_z = 9.80665;
  reference.moment_nm = 0.3;
  reference.payload_kg = 0.23;
  const Eigen::Vector2d tip = reference.solve(4000).back();
  EXPECT_NEAR(rod.pose(1.0).translation().x(), tip.x(), 5e-6);
  EXPECT_NEAR(rod.pose(1.0).translation().z(), tip.y(), 5e-6);
}

TEST(RigDynamics, ThirdOrderInTimeAndSecondWhereTheWallHardlyDamps) {
  const auto tip_after = [](int steps, double retardation_s) {
    RitzRodParams params = paper_rod();
    params.gravity_base_m_s2 = {0.0, 0.0, 9.81};
    params.pieces[0].retardation_s = retardation_s;
    RitzRod rod(params);
    RitzRodInputs inputs = paper_inputs();
    inputs.payload_kg = 0.1;
    EXPECT_TRUE(rod.settle(inputs));
    const double dt = 0.5 / steps;
    for (int i = 1; i <= steps; ++i) {
      const double t = i * dt;
      inputs.pieces[0].moment_section_nm = {-1.2 * t * t * t, 0.5 * t * t * std::sin(6.0 * t), 0.0};
      inputs.pieces[0].length_m = 0.2 + 0.02 * t * t * t;
      EXPECT_TRUE(rod.step(inputs, dt));
    }
    return Eigen::Vector3d(rod.pose(1.0).translation());
  };
  for (const auto& [retardation_s, order] : {std::pair{0.02, 3.0}, std::pair{0.0009, 2.0}}) {
    const Eigen::Vector3d coarse = tip_after(120, retardation_s), middle = tip_after(240, retardation_s),
                          fine = tip_after(480, retardation_s);
    EXPECT_NEAR(std::log2((coarse - middle).norm() / (middle - fine).norm()), order, 0.25);
  }
}

TEST(RigDynamics, StableAtStepsFarAboveTheFastestPeriods) {
  RitzRodInputs inputs;
  RitzRodParams params = paper_rod(12);
  params.pieces[0].retardation_s = 0.06;
  RitzRod rod = released_rod(params, inputs);
  for (int i = 0; i < 400; ++i) ASSERT_TRUE(rod.step(inputs, 0.02));
  params.gravity_base_m_s2 = {0.0, 0.0, 9.81};
  RitzRod rest(params);
  ASSERT_TRUE(rest.settle(inputs));
  EXPECT_LT((rod.pose(1.0).translation() - rest.pose(1.0).translation()).norm(), 1e-4);
}

}  // namespace
}  // namespace softarm::rig
