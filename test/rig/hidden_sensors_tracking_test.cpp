// Tracking: lost, hidden, frozen, flipped, swapped and jumping bodies.
#include <gtest/gtest.h>

#include <cmath>

#include "rig/hidden_sensors.h"

namespace softarm::rig {
namespace {

TEST(HiddenSensorsTracking, BurstsHaveTheirShareAndMeanLength) {
  Scenario s = resting(600.0);
  s.mocap.rate_hz = 50.0;
  s.numerics.max_step_s = 0.05;
  hide("dropout_bursts", {{"body", 1}, {"share", 0.1}, {"mean_length_s", 0.2}}, s);
  Simulator simulator(s);
  int lost = 0, frames = 0, stretches = 0;
  bool was_lost = false;
  while (const std::optional<Sample> sample = simulator.next()) {
    const bool is_lost = !sample->bodies[1];
    EXPECT_TRUE(sample->bodies[2]);
    lost += is_lost;
    stretches += is_lost && !was_lost;
    was_lost = is_lost;
    ++frames;
  }
  EXPECT_EQ(simulator.dropouts(), static_cast<std::size_t>(lost));
  // 300 stretches of 10 frames are expected.
  EXPECT_NEAR(static_cast<double>(lost) / frames, 0.1, 0.025);
  ASSERT_GT(stretches, 200);
  EXPECT_NEAR(static_cast<double>(lost) / stretches, 10.0, 2.0);
}

TEST(HiddenSensorsTracking, ARingIsHiddenExactlyWhileBentTooFarThatWay) {
  Scenario s = quiet(10.0);
  // Across the direction in which it bends most, so that some of the bending is this way and some is not.
  double most = 0.0, towards = 0.0;
  for (const Sample& sample : samples_of(s)) {
    const Eigen::Vector3d z = sample.truth.rings_base[2].q * Eigen::Vector3d::UnitZ();
    if (z.head<2>().norm() <= most) continue;
    most = z.head<2>().norm();
    towards = std::atan2(z.y(), z.x()) + M_PI / 2.0;
  }
  const double beyond = 0.3 * std::asin(most);
  constexpr double kDeg = 180.0 / M_PI;
  hide("occlusion",
       {{"body", 3}, {"beyond_deg", kDeg * beyond}, {"towards_deg", kDeg * towards}, {"within_deg", 90.0}},
       s);
  int lost = 0, seen_bent = 0;
  for (const Sample& sample : samples_of(s)) {
    const Eigen::Vector3d z = sample.truth.rings_base[2].q * Eigen::Vector3d::UnitZ();
    const bool bent = std::acos(z.z()) > beyond;
    const bool that_way =
        std::abs(std::remainder(std::atan2(z.y(), z.x()) - towards, 2.0 * M_PI)) <= M_PI / 2.0;
    EXPECT_EQ(!sample.bodies[3], bent && that_way) << sample.stamp_s;
    EXPECT_TRUE(sample.bodies[2] && sample.bodies[0]);
    lost += !sample.bodies[3];
    seen_bent += bent && !that_way;
  }
  EXPECT_GT(lost, 20);
  EXPECT_GT(seen_bent, 20);
}

TEST(HiddenSensorsTracking, AFrozenBodyRepeatsItsLastPoseExactly) {
  Scenario s = quiet(6.0);
  s.mocap.ring_noise = {1e-3, 0.01};
  hide("frozen_body", {{"body", 2}, {"from_s", 2.0}, {"for_s", 1.0}, {"repeat_s", 2.5}}, s);
  hide("dropout_bursts", {{"body", 2}, {"share", 0.2}, {"mean_length_s", 0.05}}, s);
  std::optional<Pose> last;
  int frozen = 0;
  for (const Sample& sample : samples_of(s)) {
    const double t = sample.stamp_s;
    const bool is_frozen = (t >= 2.0 && t < 3.0) || (t >= 4.5 && t < 5.5);
    const std::optional<Pose>& now = sample.bodies[2];
    if (is_frozen) {
      ASSERT_TRUE(now && last) << t;  // sent though it is lost
      EXPECT_TRUE(now->p == last->p && now->q.coeffs() == last->q.coeffs()) << t;
      ++frozen;
    } else if (now && last) {
      EXPECT_FALSE(now->p == last->p) << t;
    }
    if (now) last = now;
  }
  EXPECT_EQ(frozen, 200);
}

TEST(HiddenSensorsTracking, FlipsAreHalfATurnInTheirIntervals) {
  const std::pair<const char*, Eigen::Vector3d> forms[] = {{"about_x", Eigen::Vector3d::UnitX()},
                                                           {"about_y", Eigen::Vector3d::UnitY()},
                                                           {"about_z", Eigen::Vector3d::UnitZ()}};
  for (const auto& [form, axis] : forms) {
    Scenario s = quiet(3.0);
    hide("flipped_body", {{"body", 3}, {"from_s", 1.0}, {"for_s", 0.5}}, s, form);
    for (const Sample& sample : samples_of(s)) {
      const Pose truth = true_pose(s, sample, 3);
      const bool flipped = sample.stamp_s >= 1.0 && sample.stamp_s < 1.5;
      const Eigen::Vector3d turn = turn_between(truth, *sample.bodies[3]);
      EXPECT_NEAR(turn.norm(), flipped ? M_PI : 0.0, 1e-6);
      if (flipped) {
        EXPECT_NEAR(std::abs(turn.normalized().dot(axis)), 1.0, 1e-9);
      }
      EXPECT_LT((sample.bodies[3]->p - truth.p).norm(), 1e-12);
    }
  }
  Scenario s = quiet(2.0);
  const std::vector<Sample> plain = samples_of(s);
  hide("flipped_body", {{"body", 3}, {"from_s", 1.0}}, s, "sign");
  const std::vector<Sample> turned = samples_of(s);
  for (std::size_t k = 0; k < plain.size(); ++k) {
    const double sign = plain[k].stamp_s < 1.0 ? 1.0 : -1.0;
    EXPECT_EQ(turned[k].bodies[3]->q.coeffs(), sign * plain[k].bodies[3]->q.coeffs());
  }
}

TEST(HiddenSensorsTracking, SwappedBodiesCarryEachOthersNames) {
  Scenario s = quiet(3.0);
  const std::vector<Sample> plain = samples_of(s);
  hide("swapped_bodies", {{"body", 1}, {"other_body", 3}, {"from_s", 1.0}, {"for_s", 1.0}}, s);
  const std::vector<Sample> swapped = samples_of(s);
  for (std::size_t k = 0; k < plain.size(); ++k) {
    const bool is_swapped = plain[k].stamp_s >= 1.0 && plain[k].stamp_s < 2.0;
    for (std::size_t body = 0; body < 4; ++body) {
      const std::size_t from = is_swapped && (body == 1 || body == 3) ? 4 - body : body;
      EXPECT_EQ(swapped[k].bodies[body]->p, plain[k].bodies[from]->p);
      EXPECT_EQ(swapped[k].bodies[body]->q.coeffs(), plain[k].bodies[from]->q.coeffs());
    }
  }
}

TEST(HiddenSensorsTracking, JumpsAreSingleFramesOfTheStatedSize) {
  Scenario s = resting(300.0);
  s.mocap.rate_hz = 50.0;
  s.numerics.max_step_s = 0.05;
  hide("jumps", {{"body", 2}, {"probability", 0.02}, {"size_m", 0.03}, {"turn_deg", 40.0}}, s);
  int jumps = 0, frames = 0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Sample& sample : samples_of(s)) {
    const Pose truth = true_pose(s, sample, 2);
    const Eigen::Vector3d error = sample.bodies[2]->p - truth.p;
    ++frames;
    if (error.norm() < 1e-12) continue;
    ++jumps;
    mean += error;
    EXPECT_NEAR(error.norm(), 0.03, 1e-12);
    EXPECT_NEAR(turn_between(truth, *sample.bodies[2]).norm(), 40.0 * M_PI / 180.0, 1e-6);
  }
  EXPECT_NEAR(jumps, 0.02 * frames, 4.0 * std::sqrt(0.02 * frames));
  EXPECT_LT((mean / jumps).norm(), 4.0 * 0.03 / std::sqrt(static_cast<double>(jumps)));
}

}  // namespace
}  // namespace softarm::rig
