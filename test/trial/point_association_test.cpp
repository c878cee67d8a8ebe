// Unlabelled points of a moving arm among ghosts: never another body's point, however much is missing.
#include "trial/point_association.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <utility>

#include "trial/assignment.h"

namespace softarm {
namespace {

using Points = std::vector<Eigen::Vector3d>;
using Outcome = trial::PointAssociator::Outcome;

constexpr double kLengthM = 0.2;
constexpr double kNoiseM = 3e-4;

/// A hanging arm with rings at equal distances.
arm::Arm hanging_arm(int rings) {
  arm::Arm arm;
  arm.name = "points";
  arm.base.fixed_pose.translation() = Eigen::Vector3d(0.3, 0.1, 1.0);
  arm.base.fixed_pose.linear() = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix();
  arm.segments.resize(1);
  arm.segments[0].length_m = kLengthM;
  for (int i = 1; i <= rings; ++i) {
    arm::MeasuredBody body;
    body.name = "ring_" + std::to_string(i);
    body.arclength_m = kLengthM * i / rings;
    body.position_sd_m = kNoiseM;
    arm.bodies.push_back(body);
  }
  return arm;
}

/// Section frame of a constant-curvature arm that bends, turns, stretches: 2.2 rad at most, tip up to 0.8
/// m/s.
Eigen::Isometry3d section(const arm::Arm& arm, double s, double t) {
  const double bend = 0.2 + 2.0 * std::pow(std::sin(2.0 * M_PI * 0.35 * t), 2);
  const double azimuth = 1.7 * t;
  const double length = s * (1.08 + 0.08 * std::sin(2.0 * t));
  const double angle = bend * s / kLengthM;
  const double radius = length / std::max(angle, 1e-9);
  Eigen::Isometry3d pose = arm.base.fixed_pose;
  pose.rotate(Eigen::AngleAxisd(azimuth, Eigen::Vector3d::UnitZ()));
  pose.translate(Eigen::Vector3d(radius * (1.0 - std::cos(angle)), 0.0, radius * std::sin(angle)));
  pose.rotate(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()));
  return pose;
}

struct Faults {
  double lost = 0.0;                 // share of samples of each body
  int ghosts = 0;                    // wandering about the arm
  double ghost_flicker = 0.0;        // share of instants in which a ghost is somewhere else
  int lost_from = -1, lost_to = -1;  // frames without the second body
};

/// Draws in an order that is the same for every compiler: that of a call's arguments is not.
Eigen::Vector3d draw(std::mt19937& random, std::normal_distribution<double>& distribution) {
  Eigen::Vector3d v;
  for (int i = 0; i < 3; ++i) v[i] = distribution(random);
  return v;
}

struct Score {
  int right = 0, absent = 0, wrong = 0, longest_wrong = 0;
  double worst_m = 0.0, worst_at_start_m = 0.0;  // after the first two instants, and in them
};

/// Feeds shuffled points and compares with the truth.
Score run(const arm::Arm& arm, trial::PointAssociator& associator, const Faults& faults, double rate_hz,
          int frames, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, kNoiseM);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  Score score;
  std::vector<Eigen::Vector4d> phases;
  for (int g = 0; g < faults.ghosts; ++g) {
    Eigen::Vector4d phase;
    for (int i = 0; i < 4; ++i) phase[i] = i < 3 ? 6.0 * unit(random) : 0.5 + unit(random);
    phases.push_back(phase);
  }
  std::vector<int> wrong_in_a_row(arm.bodies.size(), 0);
  for (int k = 0; k < frames; ++k) {
    const double t = k / rate_hz;
    Points truth, points;
    for (std::size_t i = 0; i < arm.bodies.size(); ++i) {
      truth.push_back(section(arm, arm.bodies[i].arclength_m, t).translation());
      const bool gone = unit(random) < faults.lost || (i == 1 && k >= faults.lost_from && k < faults.lost_to);
      if (!gone) points.push_back(truth.back() + draw(random, noise));
    }
    for (const Eigen::Vector4d& phase : phases) {
      const double jump = unit(random) < faults.ghost_flicker ? 10.0 * unit(random) : 0.0;
      points.emplace_back(0.3 + 0.15 * std::sin(phase[3] * t + phase[0] + jump),
                          0.1 + 0.15 * std::sin(0.7 * phase[3] * t + phase[1] + jump),
                          0.88 + 0.15 * std::sin(0.9 * phase[3] * t + phase[2] + jump));
    }
    std::shuffle(points.begin(), points.end(), random);
    const auto found = associator.update(100.0 + t, points);
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const double error_m = found[i] ? (*found[i] - truth[i]).norm() : 0.0;
      const bool wrong = error_m > 6.0 * kNoiseM;
      wrong_in_a_row[i] = wrong ? wrong_in_a_row[i] + 1 : 0;
      score.longest_wrong = std::max(score.longest_wrong, wrong_in_a_row[i]);
      double& worst_m = k < 2 ? score.worst_at_start_m : score.worst_m;
      worst_m = std::max(worst_m, error_m);
      (!found[i] ? score.absent : wrong ? score.wrong : score.right) += 1;
    }
  }
  return score;
}

double total_cost(const Eigen::MatrixXd& cost, const std::vector<int>& column_of_row) {
  double sum = 0.0;
  for (std::size_t i = 0; i < column_of_row.size(); ++i)
    sum += cost(static_cast<Eigen::Index>(i), column_of_row[i]);
  return sum;
}

/// Least cost of all assignments; of those in which a row does not have a column, where one is given.
double least_of_all(const Eigen::MatrixXd& cost, int row = -1, int column = -1) {
  std::vector<int> order(static_cast<std::size_t>(cost.cols()));
  std::iota(order.begin(), order.end(), 0);
  double least = std::numeric_limits<double>::infinity();
  do {
    if (row >= 0 && order[static_cast<std::size_t>(row)] == column) continue;
    least = std::min(least, total_cost(cost, {order.begin(), order.begin() + cost.rows()}));
  } while (std::next_permutation(order.begin(), order.end()));
  return least;
}

Eigen::MatrixXd random_costs(std::mt19937& random, int trial) {
  std::uniform_real_distribution<double> unit(0.0, 10.0);
  const int rows = 1 + trial % 5, columns = rows + trial % 3;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return std::floor(unit(random)); });
}

TEST(Assignment, IsTheBestOfAllPermutations) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::MatrixXd cost = random_costs(random, trial);
    EXPECT_EQ(total_cost(cost, trial::cheapest_assignment(cost).column_of_row), least_of_all(cost));
  }
}

TEST(Assignment, SaysWhatDoingWithoutAPairCosts) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::mt19937 random(4);
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::MatrixXd cost = random_costs(random, trial);
    const trial::Assignment best = trial::cheapest_assignment(cost);
    const double least = least_of_all(cost);
    for (int row = 0; row < static_cast<int>(cost.rows()); ++row) {
      const int column = best.column_of_row[static_cast<std::size_t>(row)];
      const double rise = least_of_all(cost, row, column) - least;
      EXPECT_EQ(trial::rise_without(cost, best, row, kInfinity), rise) << cost << "\nrow " << row;
      EXPECT_EQ(trial::rise_without(cost, best, row, 3.0) < 3.0, rise < 3.0) << cost << "\nrow " << row;
    }
  }
}

TEST(PointAssociation, FollowsAMovingArmFromItsFirstInstant) {
  for (int rings : {1, 3, 4, 8}) {
    for (double rate_hz : {50.0, 120.0, 240.0}) {
      const arm::Arm arm = hanging_arm(rings);
      trial::PointAssociator associator(arm);
      const Score score = run(arm, associator, {}, rate_hz, static_cast<int>(8 * rate_hz), 1);
      EXPECT_EQ(score.wrong, 0) << rings << " rings at " << rate_hz;
      EXPECT_EQ(score.absent, 0) << rings << " rings at " << rate_hz;
      EXPECT_EQ(associator.points_unused(), 0u);
      EXPECT_EQ(associator.restarts(), 0u);
    }
  }
}

TEST(PointAssociation, GhostsAndLossesSwapNothing) {
  constexpr double kRateHz = 120.0, kLongestWrongS = 0.1, kFurthestM = 0.03;
  int right = 0, wrong = 0, absent = 0, wrong_at_start = 0;
  constexpr unsigned kSeeds = 100;
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    const arm::Arm arm = hanging_arm(4);
    trial::PointAssociator associator(arm);
    const Faults faults{0.05, 4, 0.02};
    const Score score = run(arm, associator, faults, kRateHz, 2400, seed);
    right += score.right, wrong += score.wrong, absent += score.absent;
    EXPECT_LT(score.longest_wrong, kLongestWrongS * kRateHz) << seed;
    EXPECT_LT(score.worst_m, kFurthestM) << seed;
    // Nothing is predicted before it was seen twice: in the first two instants the arm's geometry is all that
    // is known. Where a ring is lost just then and a ghost would do in its place, nothing distinguishes them
    // before the ring is there again; over 1200 seeds it happened in 4.
    if (score.worst_at_start_m > kFurthestM) ++wrong_at_start;
    EXPECT_GT(associator.points_unused(), 9000u);
  }
  EXPECT_LE(wrong_at_start, 0.02 * kSeeds);
  EXPECT_GT(right, 0.93 * (right + wrong + absent));  // 5 % were never sent
  EXPECT_LT(wrong, 0.0005 * right);
}

TEST(PointAssociation, AGhostThatPassesAHiddenRingIsNotTheRing) {
  const arm::Arm arm = hanging_arm(4);
  constexpr int kHidden = 60, kFrames = 120;
  constexpr double kRateHz = 120.0;
  for (double beside_m : {0.0, 0.001, 0.003, 0.005}) {
    trial::PointAssociator associator(arm);
    const auto place = [&](int i, int k) {
      return Eigen::Vector3d(section(arm, kLengthM * i / 4, k / kRateHz).translation());
    };
    for (int k = 0; k < kFrames; ++k) {
      Points points{place(3, kHidden) + Eigen::Vector3d(0.0, beside_m, 0.3 * (k - kHidden) / kRateHz)};
      for (int i = 1; i <= 4; ++i) {
        if (i != 3 || k != kHidden) points.push_back(place(i, k));
      }
      const auto found = associator.update(k / kRateHz, points);
      for (int i = 1; i <= 4; ++i) {
        const auto& p = found[static_cast<std::size_t>(i - 1)];
        EXPECT_TRUE(!p || *p == place(i, k)) << beside_m << " ring " << i << " frame " << k;
        EXPECT_TRUE(p || (i == 3 && std::abs(k - kHidden) < 12))
            << beside_m << " ring " << i << " frame " << k;
      }
    }
  }
}

/// Of a lattice of 25 mm those nearest to the arm, but none so near to where a ring is in these seconds.
Points ghosts_about(const arm::Arm& arm, std::size_t count, double from_s, double to_s) {
  constexpr double kApartM = 0.025;
  Points paths;
  for (double t = from_s; t <= to_s; t += 0.01)
    for (const arm::MeasuredBody& body : arm.bodies)
      paths.push_back(section(arm, body.arclength_m, t).translation());
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& p : paths) middle += p / static_cast<double>(paths.size());
  Points ghosts;
  for (int i = 0; i < 17 * 17 * 17; ++i) {
    const Eigen::Vector3d ghost =
        middle + kApartM * Eigen::Vector3d(i % 17 - 8.0, i / 17 % 17 - 8.0, i / 289 - 8.0);
    const bool is_clear = std::all_of(
        paths.begin(), paths.end(), [&](const Eigen::Vector3d& p) { return (p - ghost).norm() >= kApartM; });
    if (is_clear) ghosts.push_back(ghost);
  }
  std::stable_sort(ghosts.begin(), ghosts.end(), [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return (a - middle).norm() < (b - middle).norm();
  });
  ghosts.resize(count);
  return ghosts;
}

TEST(PointAssociation, NoneOfSixtyGhostsIsAHiddenRing) {
  constexpr double kRateHz = 120.0;
  constexpr int kFrames = 240, kGhostsEnter = 12;  // the arm is known by then
  const arm::Arm arm = hanging_arm(4);
  std::mt19937 random(6);
  std::normal_distribution<double> noise(0.0, kNoiseM);
  // For so short a time that it is predicted, and for so long that it is looked for.
  for (const auto& [hidden, period] : {std::pair(6, 20), std::pair(30, 60)}) {
    for (double from_s : {0.0, 0.5, 1.0, 1.5}) {
      const Points ghosts = ghosts_about(arm, 60, from_s, from_s + kFrames / kRateHz);
      trial::PointAssociator associator(arm);
      for (int k = 0; k < kFrames; ++k) {
        const double t = k / kRateHz;
        const int hidden_ring = k % period >= period - hidden ? k / period % 4 : -1;
        Points truth, points;
        for (int i = 0; i < 4; ++i) {
          truth.push_back(section(arm, kLengthM * (i + 1) / 4, from_s + t).translation());
          if (i != hidden_ring) points.push_back(truth.back() + draw(random, noise));
        }
        for (std::size_t g = 0; g < ghosts.size() && k >= kGhostsEnter; ++g) {
          const double phase = static_cast<double>(g);
          points.push_back(ghosts[g] + 0.002 * Eigen::Vector3d(std::sin(2.0 * t + phase),
                                                               std::cos(2.0 * t + phase),
                                                               std::sin(1.3 * t + 2.0 * phase)));
        }
        std::shuffle(points.begin(), points.end(), random);
        const auto found = associator.update(100.0 + t, points);
        for (int i = 0; i < 4; ++i) {
          const auto& p = found[static_cast<std::size_t>(i)];
          ASSERT_EQ(p.has_value(), i != hidden_ring) << hidden << " " << from_s << " " << k << " " << i;
          EXPECT_TRUE(!p || (*p - truth[static_cast<std::size_t>(i)]).norm() < 6.0 * kNoiseM)
              << k << " " << i;
        }
      }
      EXPECT_EQ(associator.restarts(), 0u);
    }
  }
}

TEST(PointAssociation, ABodyThatWasLongLostReturnsAsItself) {
  for (int ghosts : {0, 3}) {
    const arm::Arm arm = hanging_arm(4);
    trial::PointAssociator associator(arm);
    Faults faults;
    faults.ghosts = ghosts;
    faults.lost_from = 100;
    faults.lost_to = 700;
    const Score score = run(arm, associator, faults, 240.0, 1400, 5);
    EXPECT_EQ(score.longest_wrong, 0);
    EXPECT_LE(score.absent, 600 + (ghosts > 0 ? 60 : 1));
    EXPECT_EQ(associator.restarts(), 0u);
  }
}

TEST(PointAssociation, StartWithMissingAndStrangePoints) {
  const arm::Arm arm = hanging_arm(4);
  const auto place = [&](int i) {
    return Eigen::Vector3d(section(arm, kLengthM * i / 4, 1.0).translation());
  };
  const Eigen::Vector3d far(1.5, 0.0, 0.4);
  {  // three of four: which is missing follows from the spacing
    trial::PointAssociator associator(arm);
    const auto found = associator.update(1.0, {place(4), far, place(1), place(3)});
    EXPECT_TRUE(found[0] && found[2] && found[3] && !found[1]);
    EXPECT_NEAR((*found[2] - place(3)).norm(), 0.0, 1e-12);
    EXPECT_EQ(associator.outcomes()[1], Outcome::kNoPoint);
    EXPECT_EQ(associator.outcomes()[0], Outcome::kFound);
    EXPECT_EQ(associator.points_unused(), 1u);
  }
  {  // two points for the tip: it is absent, the others are not
    trial::PointAssociator associator(arm);
    const Eigen::Vector3d beside = place(4) + Eigen::Vector3d(0.006, 0.004, 0.0);
    const auto found = associator.update(1.0, {place(4), beside, place(1), place(3), place(2)});
    EXPECT_TRUE(found[0] && found[1] && found[2] && !found[3]);
    EXPECT_EQ(associator.outcomes()[3], Outcome::kAmbiguous);
  }
  {  // nothing but rubbish
    trial::PointAssociator associator(arm);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const auto& p : associator.update(1.0, {far, {nan, 0, 0}, -far})) EXPECT_FALSE(p);
    for (const auto& p : associator.update(1.1, {})) EXPECT_FALSE(p);
    for (const auto& p : associator.update(1.2, Points(200, far))) EXPECT_FALSE(p);
    Points crowd;
    for (int i = 0; i < 200; ++i) crowd.emplace_back(0.3 + 1e-3 * i, 0.1, 0.9);
    for (const auto& p : associator.update(1.3, crowd)) EXPECT_FALSE(p);
  }
  {  // the cloud of a depth camera, on the wrong topic: each pair of its points would take minutes
    trial::PointAssociator associator(arm);
    Points cloud;
    for (int i = 0; i < 300000; ++i) cloud.emplace_back(1e-3 * (i % 640), 1e-3 * (i / 640), 0.9);
    for (const auto& p : associator.update(1.0, cloud)) EXPECT_FALSE(p);
    EXPECT_EQ(associator.points_unused(), cloud.size());
    EXPECT_EQ(associator.outcomes()[0], Outcome::kAmbiguous);
  }
}

TEST(PointAssociation, WithoutTheBaseNothingIsGuessed) {
  arm::Arm arm = hanging_arm(4);
  arm.base.body = "base";
  const Eigen::Isometry3d base = arm.base.fixed_pose;
  trial::PointAssociator associator(arm);
  const auto points = [&](double t) {
    Points all;
    for (int i = 4; i > 0; --i) all.push_back(section(arm, kLengthM * i / 4, t).translation());
    return all;
  };
  for (const auto& p : associator.update(1.0, points(1.0))) EXPECT_FALSE(p);
  for (double t : {1.01, 1.02}) {
    for (const auto& p : associator.update(t, points(t), base)) EXPECT_TRUE(p);
  }
  const auto found = associator.update(1.03, points(1.03));  // known already: the base is not needed
  for (std::size_t i = 0; i < 4; ++i) {
    ASSERT_TRUE(found[i]);
    EXPECT_NEAR((*found[i] - points(1.03)[3 - i]).norm(), 0.0, 1e-12);
  }
}

TEST(PointAssociation, TwoPointsForOneBodyAreNone) {
  const arm::Arm arm = hanging_arm(4);
  trial::PointAssociator associator(arm);
  for (int k = 0; k < 60; ++k) {
    const double t = k / 240.0;
    Points points;
    for (int i = 1; i <= 4; ++i) points.push_back(section(arm, kLengthM * i / 4, t).translation());
    if (k > 30) points.push_back(points[2] + Eigen::Vector3d(0.0, 0.0015, 0.0));
    const auto found = associator.update(t, points);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(found[i].has_value(), k <= 30 || i != 2) << k << " " << i;
    if (k > 30) {
      EXPECT_EQ(associator.outcomes()[2], Outcome::kAmbiguous) << k;
    }
  }
}

TEST(PointAssociation, AnArmThatWasMovedOrATimeThatJumpedStartsAfreshAndSaysSo) {
  const arm::Arm arm = hanging_arm(4);
  trial::PointAssociator associator(arm);
  run(arm, associator, {}, 120.0, 240, 1);
  EXPECT_EQ(associator.restarts(), 0u);
  const Score again = run(arm, associator, {}, 120.0, 240, 2);  // a bag that starts again
  EXPECT_EQ(associator.restarts(), 1u);
  EXPECT_EQ(again.wrong + again.absent, 0);
}

TEST(PointAssociation, CirclesOfMarkersGiveTheirCentres) {
  arm::Arm arm = hanging_arm(3);
  for (arm::MeasuredBody& body : arm.bodies) {
    body.markers = 4;
    body.marker_cluster_radius_m = 0.025;
  }
  trial::PointAssociator associator(arm);
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 1e-4);
  int right = 0, hidden = 0;
  for (int k = 0; k < 480; ++k) {
    const double t = k / 120.0;
    Points points;
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Isometry3d ring = section(arm, arm.bodies[i].arclength_m, t);
      for (int m = 0; m < 4; ++m) {
        if (i == 1 && m == 2 && k > 100) continue;             // one is enough to lose ...
        if (i == 2 && m < 2 && k >= 200 && k < 260) continue;  // ... and two are too many
        const double angle = 0.3 * static_cast<double>(i) + m * M_PI / 2.0;
        const Eigen::Vector3d at(0.025 * std::cos(angle), 0.025 * std::sin(angle), 0.0);
        points.push_back(ring * Eigen::Vector3d(at + draw(random, noise)));
      }
    }
    std::shuffle(points.begin(), points.end(), random);
    const auto found = associator.update(t, points);
    for (std::size_t i = 0; i < 3; ++i) {
      if (!found[i]) {
        ++hidden;
        EXPECT_TRUE(i == 2 && k >= 200 && k < 262) << i << " " << k;
        continue;
      }
      ++right;
      EXPECT_LT((*found[i] - section(arm, arm.bodies[i].arclength_m, t).translation()).norm(), 1e-3);
    }
  }
  EXPECT_GE(hidden, 60);
  EXPECT_LE(hidden, 64);
  EXPECT_EQ(right + hidden, 3 * 480);
}

TEST(PointAssociation, IsFastEnoughForEveryFrameOfALiveStream) {
  const arm::Arm arm = hanging_arm(8);
  trial::PointAssociator associator(arm);
  const auto start = std::chrono::steady_clock::now();
  run(arm, associator, {0.02, 12, 0.1}, 240.0, 2400, 1);
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
  EXPECT_LT(spent.count() / 2400, 0.004) << "s per instant";  // 240 Hz; a generous bound for a loaded machine
}

}  // namespace
}  // namespace softarm
