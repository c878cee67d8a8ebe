// What the cameras see: coloured noise, bias, slipped and wobbling rings, calibration.
#include <gtest/gtest.h>

#include <cmath>

#include "rig/hidden_sensors.h"

namespace softarm::rig {
namespace {

Eigen::Vector3d error_m(const Scenario& s, const Sample& sample, std::size_t body) {
  return sample.bodies[body]->p - true_pose(s, sample, body).p;
}

TEST(HiddenSensorsPoses, CorrelatedNoiseHasItsSizeAndForgetsItselfInItsTime) {
  Scenario s = resting(400.0);
  s.mocap.rate_hz = 50.0;
  s.numerics.max_step_s = 0.05;
  s.mocap.ring_fractions = {1.0};
  hide("correlated_noise", {{"position_sd_m", 1e-3}, {"orientation_sd_rad", 0.01}, {"correlation_s", 0.5}},
       s);
  const std::vector<Sample> samples = samples_of(s);
  std::vector<Eigen::Vector3d> p, turn;
  double across_bodies = 0.0;
  for (const Sample& sample : samples) {
    p.push_back(error_m(s, sample, 1));
    turn.push_back(turn_between(true_pose(s, sample, 1), *sample.bodies[1]));
    across_bodies += p.back().dot(error_m(s, sample, 0));
  }
  const auto covariance = [](const std::vector<Eigen::Vector3d>& x, std::size_t lag) {
    double sum = 0.0;
    for (std::size_t k = lag; k < x.size(); ++k) sum += x[k].dot(x[k - lag]);
    return sum / (3.0 * static_cast<double>(x.size() - lag));
  };
  // 3 x 400 s / (2 x 0.5 s): about 1200 independent numbers.
  EXPECT_NEAR(std::sqrt(covariance(p, 0)), 1e-3, 0.08e-3);
  EXPECT_NEAR(std::sqrt(covariance(turn, 0)), 0.01, 0.8e-3);
  EXPECT_NEAR(covariance(p, 1) / covariance(p, 0), std::exp(-0.02 / 0.5), 0.01);
  EXPECT_NEAR(covariance(p, 25) / covariance(p, 0), std::exp(-1.0), 0.08);
  EXPECT_NEAR(covariance(turn, 25) / covariance(turn, 0), std::exp(-1.0), 0.08);
  EXPECT_NEAR(covariance(p, 100) / covariance(p, 0), 0.0, 0.12);
  EXPECT_NEAR(across_bodies / (3.0 * static_cast<double>(p.size())) / 1e-6, 0.0, 0.12);
}

TEST(HiddenSensorsPoses, BodiesSitWhereTheScenarioHasThemOnTheirSection) {
  Scenario s = quiet(4.0);
  s.mocap.rings = {{"a"}, {"b", {0.0, 0.03, 0.002}, Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0)}, {"c"}};
  s.mocap.base = {"clamp", {0.1, 0.0, 0.0}};
  EXPECT_EQ(Simulator(s).body_names(), (std::vector<std::string>{"clamp", "a", "b", "c"}));
  for (const Sample& sample : samples_of(s)) {
    const Pose truth = true_pose(s, sample, 2);
    EXPECT_LT((truth.q.conjugate() * error_m(s, sample, 2) - Eigen::Vector3d(0.0, 0.03, 0.002)).norm(),
              1e-12);
    EXPECT_LT((truth.q * Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0)).angularDistance(sample.bodies[2]->q), 1e-7);
    EXPECT_LT(
        (s.mount.q_mocap_base.conjugate() * error_m(s, sample, 0) - Eigen::Vector3d(0.1, 0.0, 0.0)).norm(),
        1e-12);
    EXPECT_LT(error_m(s, sample, 1).norm(), 1e-12);
  }
}

TEST(HiddenSensorsPoses, BiasIsConstantInTheBodysFrame) {
  Scenario s = quiet(4.0);
  hide("marker_bias", {{"body", 2}, {"x_m", 1e-3}, {"y_m", -2e-3}, {"z_m", 0.5e-3}}, s, "given");
  for (const Sample& sample : samples_of(s)) {
    const Pose truth = true_pose(s, sample, 2);
    EXPECT_LT((truth.q.conjugate() * error_m(s, sample, 2) - Eigen::Vector3d(1e-3, -2e-3, 0.5e-3)).norm(),
              1e-12);
    EXPECT_LT(error_m(s, sample, 1).norm(), 1e-12);
  }
  // Drawn: from the seed, with the stated spread.
  double sum = 0.0, sum_turn = 0.0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Scenario drawn = resting(0.03);
    drawn.seed = seed;
    hide("marker_bias", {{"position_sd_m", 1e-3}, {"orientation_sd_rad", 0.02}}, drawn);
    const std::vector<Sample> samples = samples_of(drawn);
    for (std::size_t body = 0; body < 4; ++body) {
      sum += error_m(drawn, samples[0], body).squaredNorm();
      sum_turn += turn_between(true_pose(drawn, samples[0], body), *samples[0].bodies[body]).squaredNorm();
      EXPECT_LT((error_m(drawn, samples[0], body) - error_m(drawn, samples[2], body)).norm(), 1e-9);
    }
  }
  EXPECT_NEAR(std::sqrt(sum / 720.0), 1e-3, 0.1e-3);
  EXPECT_NEAR(std::sqrt(sum_turn / 720.0), 0.02, 2e-3);
}

TEST(HiddenSensorsPoses, ASlippedRingSitsElsewhereOnTheArm) {
  // Beside a scenario whose ring is mounted where the slipped one ends up.
  Scenario s = quiet(4.0), there = quiet(4.0);
  there.mocap.ring_fractions = {0.3, 0.6 + 0.01 / 0.2, 1.0};
  hide("marker_slip", {{"body", 2}, {"along_m", 0.01}, {"from_s", 1.5}}, s);
  const std::vector<Sample> slipped = samples_of(s), other = samples_of(there);
  for (std::size_t k = 0; k < slipped.size(); ++k) {
    const bool before = slipped[k].stamp_s < 1.5;
    const Pose expected = before ? true_pose(s, slipped[k], 2) : *other[k].bodies[2];
    EXPECT_LT((slipped[k].bodies[2]->p - expected.p).norm(), 1e-9);
    EXPECT_LT(slipped[k].bodies[2]->q.angularDistance(expected.q), 1e-6);
    EXPECT_LT(error_m(s, slipped[k], 3).norm(), 1e-12);
  }
}

TEST(HiddenSensorsPoses, SlipsSidewaysAndBeyondTheTip) {
  Scenario s = quiet(3.0);
  hide("marker_slip", {{"body", 3}, {"along_m", 0.004}, {"sideways_m", 0.002}, {"direction_deg", 90.0}}, s);
  hide("marker_slip", {{"body", 0}, {"sideways_m", 0.003}}, s);
  for (const Sample& sample : samples_of(s)) {
    const Pose tip = true_pose(s, sample, 3), base = true_pose(s, sample, 0);
    EXPECT_LT((tip.q.conjugate() * error_m(s, sample, 3) - Eigen::Vector3d(0.0, 0.002, 0.004)).norm(), 1e-9);
    EXPECT_LT((base.q.conjugate() * error_m(s, sample, 0) - Eigen::Vector3d(0.003, 0.0, 0.0)).norm(), 1e-12);
  }
}

TEST(HiddenSensorsPoses, AWobblingRingFollowsTheApparentWeight) {
  // At rest: towards gravity, by its share across the arm.
  Scenario still = resting(1.0);
  still.mount.q_mocap_base = Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitY()));
  hide("wobbling_ring", {{"body", 1}, {"tilt_deg_per_g", 2.0}, {"shift_m_per_g", 1e-3}}, still);
  const Sample first = samples_of(still)[0];
  const Pose truth = true_pose(still, first, 1);
  const Eigen::Vector3d tangent = truth.q * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d across = -Eigen::Vector3d::UnitZ() + tangent.z() * tangent;
  EXPECT_GT(across.norm(), 0.5);
  EXPECT_LT((error_m(still, first, 1) - 1e-3 * across).norm(), 1e-9);
  const Eigen::Vector3d tilted = first.bodies[1]->q * Eigen::Vector3d::UnitZ();
  EXPECT_NEAR(std::acos(tilted.dot(tangent)), 2.0 * M_PI / 180.0 * across.norm(), 1e-6);
  EXPECT_GT((tilted - tangent).dot(across), 0.0);
  EXPECT_LT(error_m(still, first, 2).norm(), 1e-12);

  // Shaken without gravity: against its acceleration; a lag makes it smaller.
  Scenario shaken = quiet(4.0);
  shaken.gravity_m_s2 = 0.0;
  shaken.pressures.random.reset();
  shaken.pressures.schedule = {{0.0, {0.0, 0.0, 0.0}}, {0.5, {30e3, 0.0, 0.0}}};
  shaken.pressures.settle_s = shaken.pressures.ramp_s = 0.2;
  Scenario lagging = shaken;
  hide("wobbling_ring", {{"body", 3}, {"shift_m_per_g", 1e-3}}, shaken);
  hide("wobbling_ring", {{"body", 3}, {"shift_m_per_g", 1e-3}, {"lag_s", 0.2}}, lagging);
  const std::vector<Sample> quick = samples_of(shaken), slow = samples_of(lagging);
  double quick_sum = 0.0, slow_sum = 0.0, largest = 0.0;
  for (std::size_t k = 2; k < quick.size(); ++k) {
    const Eigen::Vector3d acceleration =
        1e4 * (true_pose(shaken, quick[k], 3).p - 2.0 * true_pose(shaken, quick[k - 1], 3).p +
               true_pose(shaken, quick[k - 2], 3).p);
    const Eigen::Vector3d z = true_pose(shaken, quick[k], 3).q * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d expected = -1e-3 / 9.80665 * (acceleration - acceleration.dot(z) * z);
    EXPECT_LT((error_m(shaken, quick[k], 3) - expected).norm(), 1e-9);
    largest = std::max(largest, expected.norm());
    quick_sum += error_m(shaken, quick[k], 3).squaredNorm();
    slow_sum += error_m(lagging, slow[k], 3).squaredNorm();
  }
  EXPECT_GT(largest, 1e-4);
  EXPECT_LT(slow_sum, 0.5 * quick_sum);
  EXPECT_GT(slow_sum, 1e-4 * quick_sum);
}

TEST(HiddenSensorsPoses, BumpedCamerasMoveAllBodiesAsOne) {
  Scenario s = quiet(3.0);
  hide("bumped_cameras",
       {{"x_m", 0.01}, {"y_m", -0.02}, {"z_m", 0.003}, {"turn_z_deg", 2.0}, {"from_s", 1.0}}, s);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(2.0 * M_PI / 180.0, Eigen::Vector3d::UnitZ()));
  for (const Sample& sample : samples_of(s))
    for (std::size_t body = 0; body < 4; ++body) {
      Pose expected = true_pose(s, sample, body);
      if (sample.stamp_s >= 1.0)
        expected = {turn * expected.p + Eigen::Vector3d(0.01, -0.02, 0.003), turn * expected.q};
      EXPECT_LT((sample.bodies[body]->p - expected.p).norm(), 1e-12);
      EXPECT_LT(sample.bodies[body]->q.angularDistance(expected.q), 1e-7);
    }
}

TEST(HiddenSensorsPoses, AWrongWandScalesAllDistances) {
  Scenario s = quiet(1.0);
  hide("camera_scale", {{"share", 0.003}}, s);
  Scenario uneven = quiet(1.0), warms = quiet(1.0);
  hide("camera_scale", {{"share", 0.003}, {"height_ratio", 0.5}}, uneven);
  hide("camera_scale", {{"share", 0.003}, {"warms_s", 100.0}}, warms, "warming");
  warms.session_s = 50.0;
  const std::vector<Sample> even_ones = samples_of(s), uneven_ones = samples_of(uneven),
                            warming_ones = samples_of(warms);
  const Eigen::Vector3d factors(1.003, 1.003, 1.0015);
  for (std::size_t k = 0; k < even_ones.size(); ++k)
    for (std::size_t body = 0; body < 4; ++body) {
      const Eigen::Vector3d truth = true_pose(s, even_ones[k], body).p;
      EXPECT_LT((even_ones[k].bodies[body]->p - 1.003 * truth).norm(), 1e-12);
      EXPECT_LT((uneven_ones[k].bodies[body]->p - factors.cwiseProduct(truth)).norm(), 1e-12);
      const double warm = -std::expm1(-(50.0 + warming_ones[k].stamp_s) / 100.0);
      EXPECT_LT((warming_ones[k].bodies[body]->p - (1.0 + 0.003 * warm) * truth).norm(), 1e-9);
    }
}

TEST(HiddenSensorsPoses, LensesThatAreOffBowTheSpaceAndLeaveItsMiddle) {
  Scenario fades = quiet(0.1), lenses = quiet(0.1);
  const auto error_at = [&](Scenario& s, const Eigen::Vector3d& base) {
    s.mount.p_mocap_base = base;
    return error_m(s, samples_of(s)[0], 0);
  };
  hide("camera_bow", {{"off", 0.01}, {"fades_m", 2.0}}, fades, "fading");
  const Eigen::Vector3d far(0.5, -0.4, 1.2);
  const double square = far.squaredNorm();
  EXPECT_LT((error_at(fades, far) - 0.01 * square / (1.0 + square / 4.0) * far).norm(), 1e-12);

  hide("camera_bow", {{"off", 0.02}}, lenses);
  EXPECT_LT(error_at(lenses, {0.0, 0.0, 0.0}).norm(), 1e-12);
  // About the middle as a cubic: twice as far, eight times as much; alike on all sides.
  const double near = error_at(lenses, {0.1, 0.0, 0.0}).norm();
  EXPECT_NEAR(error_at(lenses, {0.2, 0.0, 0.0}).norm() / near, 8.0, 0.4);
  EXPECT_NEAR(error_at(lenses, {-0.1, 0.0, 0.0}).norm() / near, 1.0, 1e-6);
  EXPECT_NEAR(error_at(lenses, {0.0, 0.1, 0.0}).norm() / near, 1.0, 1e-6);
  const Eigen::Vector3d outwards = error_at(lenses, {0.6, 0.6, 1.0});
  EXPECT_GT(outwards.x(), 1e-4);
  EXPECT_NEAR(outwards.x(), outwards.y(), 1e-9);
  // Twice off is twice as much.
  Scenario twice = quiet(0.1);
  hide("camera_bow", {{"off", 0.04}}, twice);
  EXPECT_NEAR(error_at(twice, {0.6, 0.6, 1.0}).norm() / outwards.norm(), 2.0, 0.02);
}

TEST(HiddenSensorsPoses, ASkinSlidesWithTheCurvatureUnderIt) {
  // Without gravity, bent and come to rest: nearly an arc.
  Scenario bent = quiet(2.0);
  bent.gravity_m_s2 = 0.0;
  bent.payload.schedule.clear();
  bent.pressures.random.reset();
  bent.pressures.schedule = {{0.0, {30e3, 0.0, 0.0}}};
  bent.pressures.settle_s = bent.pressures.ramp_s = 0.2;
  Scenario sleeve = bent, patch = bent, all = bent;
  hide("skin_marker", {{"body", 2}, {"way_m2", 2e-4}, {"tilt_rad_m", 2e-3}}, sleeve);
  hide("skin_marker", {{"body", 2}, {"way_m2", 2e-4}, {"side_deg", 30.0}, {"patch_m", 0.02}}, patch, "patch");
  hide("skin_marker", {{"way_m2", 2e-4}, {"saturates_per_m", 5.0}}, all);
  const Sample shifted = samples_of(sleeve).back(), slid = samples_of(patch).back(),
               saturated = samples_of(all).back();
  // Nearly that between rings.
  const Pose first = true_pose(sleeve, shifted, 1), second = true_pose(sleeve, shifted, 2),
             third = true_pose(sleeve, shifted, 3);
  const Eigen::Vector3d bend = turn_between(first, third) / (0.7 * sleeve.arm.length_m());
  const Eigen::Vector3d inside(bend.y(), -bend.x(), 0.0);
  ASSERT_GT(inside.norm(), 0.5);
  const Eigen::Vector3d across = second.q.conjugate() * error_m(sleeve, shifted, 2);
  EXPECT_LT((across - 2e-4 * inside).norm(), 0.1 * across.norm());
  // It is the side on which the other rings are.
  EXPECT_GT((second.q * across).dot(0.5 * (first.p + third.p) - second.p), 0.0);
  EXPECT_LT((turn_between(second, *shifted.bodies[2]) - 2e-3 * bend).norm(), 0.1 * 2e-3 * bend.norm());
  EXPECT_LT(error_m(sleeve, shifted, 1).norm(), 1e-12);

  const Eigen::Vector3d along = second.q.conjugate() * error_m(patch, slid, 2);
  const double on_side = inside.dot(Eigen::Vector3d(std::cos(M_PI / 6.0), 0.5, 0.0));
  EXPECT_NEAR(along.z(), 2e-4 * on_side, 0.1 * std::abs(2e-4 * on_side));
  EXPECT_LT(along.head<2>().norm(), 1e-12);

  const double half = 1.0 / (1.0 + inside.norm() / 5.0);
  EXPECT_NEAR(error_m(all, saturated, 2).norm(), half * across.norm(), 0.1 * across.norm());
  EXPECT_GT(error_m(all, saturated, 1).norm(), 1e-5);
  EXPECT_LT(error_m(all, saturated, 0).norm(), 1e-12);
}

}  // namespace
}  // namespace softarm::rig
