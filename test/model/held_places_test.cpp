// Walls, however stiff: the forces that hold places of an arm, found together with its shape.
#include "model/held_places.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "effects/catalogue.h"
#include "effects/drive_trials.h"
#include "model/instant_solver.h"

namespace softarm::model {
namespace {

constexpr double kDistance_m = 0.013, kMostPressure_pa = 45e3;
constexpr double kSame_m = 1e-5;

constexpr double kAzimuth_rad = 0.09;
/// @param place_m of the arm, that the wall touches
/// @param extent_m half of the stretch about it that touches
Present wall(double stiffness_n_per_m, double place_m, double friction = 0.0, double extent_m = 0.0) {
  return {effects::find("contact"),
          (Values(7) << stiffness_n_per_m, place_m, kAzimuth_rad, kDistance_m, friction, 0.0, extent_m)
              .finished()};
}
Eigen::Vector3d towards_wall() {
  return {std::cos(kAzimuth_rad), std::sin(kAzimuth_rad), 0.0};
}

/// Gauss and Legendre's five points over a length of 1, from its middle, and their weights: by their roots.
struct FivePoints {
  FivePoints() {
    const double near = std::sqrt(5.0 - 2.0 * std::sqrt(10.0 / 7.0)) / 6.0,
                 far = std::sqrt(5.0 + 2.0 * std::sqrt(10.0 / 7.0)) / 6.0,
                 of_near = (322.0 + 13.0 * std::sqrt(70.0)) / 1800.0,
                 of_far = (322.0 - 13.0 * std::sqrt(70.0)) / 1800.0;
    at << -far, -near, 0.0, near, far;
    weight << of_far, of_near, 64.0 / 225.0, of_near, of_far;
  }
  Eigen::Matrix<double, 5, 1> at, weight;
};

/// An arm beside a wall, at one instant after the other.
class Arm {
 public:
  explicit Arm(const std::vector<Present>& kinds = {wall(1.0, 0.1)})
      : arm_(effects::testing::shipped_arm("online_200mm")), solver_(arm_, Mesh::of(kinds, 1e-7)) {}

  /// @param from_before its last shape is where to begin; else it is solved from nothing
  bool settle(const Present& present, const Eigen::Vector3d& pressures_pa, const Eigen::Vector3d& gravity,
              bool from_before) {
    return settle(std::vector<Present>{present}, pressures_pa, gravity, from_before);
  }
  bool settle(const std::vector<Present>& all, const Eigen::Vector3d& pressures_pa,
              const Eigen::Vector3d& gravity, bool from_before) {
    static const Dynamics kStill{false, 0.0};
    static const Motion kNoMotion;
    now_.instant.inputs = now_.instant.moment_inputs = pressures_pa;
    now_.instant.gravity_base = gravity;
    const InstantSolver::Context context{arm_, memories_, kStill, kNoMotion, feedback_};
    const Shape before = now_.shape;
    const Eigen::Quaterniond tip = now_.q_tip;
    memories_.resize(all.size());
    if (!solver_.settle(context, all, from_before ? &tip : nullptr, from_before ? &before : nullptr, now_))
      return false;
    for (std::size_t i = 0; i < all.size(); ++i)
      all[i].effect->remember(arm_, solver_.fine, all[i].values, now_.instant, now_.shape, memories_[i]);
    return true;
  }
  /// Empty where places were not held by forces, or not for long.
  const Eigen::MatrixXd& compliance_m_per_n() const { return feedback_.compliance_m_per_n; }
  Eigen::Vector3d tip_m() const { return now_.shape.stations.back().p; }
  /// Of the wall at the shape that was found, at each of its places, and what the rod bears there instead.
  Eigen::Matrix3Xd forces_n(const Present& present) const {
    const std::vector<Present> alone{present};
    const HeldPlaces places(solver_.fine, alone, memories_);
    return in_columns(places.forces_n(places.positions_m(solver_.rod, now_.shape)));
  }
  Eigen::Vector3d force_n(const Present& present) const { return forces_n(present).rowwise().sum(); }
  Eigen::Matrix3Xd places_m(const Present& present) const {
    const std::vector<Present> alone{present};
    return in_columns(HeldPlaces(solver_.fine, alone, memories_).positions_m(solver_.rod, now_.shape));
  }
  /// What the first effect remembers.
  const Memory& memory() const { return memories_.front(); }
  Eigen::Vector3d borne_n() const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = FineRod::kFirstStation; i < solver_.rod.loads.size(); ++i)
      sum += solver_.rod.loads[i].force_n;
    return sum;
  }

 private:
  static Eigen::Matrix3Xd in_columns(const Eigen::VectorXd& all) {
    return Eigen::Map<const Eigen::Matrix3Xd>(all.data(), 3, all.size() / 3);
  }

  arm::Arm arm_;
  InstantSolver solver_;
  Feedback feedback_;
  std::vector<Memory> memories_;
  Predicted now_;
};

class Random {
 public:
  Eigen::Vector3d pressures_pa() { return {draw_(engine_), draw_(engine_), draw_(engine_)}; }

 private:
  std::mt19937 engine_{3};
  std::uniform_real_distribution<double> draw_{0.0, kMostPressure_pa};
};

TEST(HeldPlaces, AWallThatIsSuddenlyThereHoldsTheArmAsOneThatGrowsStiff) {
  int touched = 0;
  for (const double stiffness : {50.0, 200.0, 2000.0}) {
    for (const double place : {0.06, 0.1, 0.2}) {
      Random random;
      for (int k = 0; k < 24; ++k) {
        SCOPED_TRACE(std::to_string(stiffness) + " N/m at " + std::to_string(place) + " m, " +
                     std::to_string(k));
        const Eigen::Vector3d pressures = random.pressures_pa(), gravity(0.0, 0.0, k % 2 == 0 ? 9.81 : -9.81);
        Arm slowly, suddenly;
        ASSERT_TRUE(slowly.settle(wall(0.0, place), pressures, gravity, false));
        const Eigen::Vector3d free_m = slowly.tip_m();
        for (double share = 1e-4; share < 1.0; share *= 1.25)
          ASSERT_TRUE(slowly.settle(wall(share * stiffness, place), pressures, gravity, true));
        ASSERT_TRUE(slowly.settle(wall(stiffness, place), pressures, gravity, true));
        ASSERT_TRUE(suddenly.settle(wall(stiffness, place), pressures, gravity, false));
        EXPECT_LT((suddenly.tip_m() - slowly.tip_m()).norm(), kSame_m);
        touched += (slowly.tip_m() - free_m).norm() > 1e-3;
      }
    }
  }
  EXPECT_GT(touched, 30);
}

TEST(HeldPlaces, WhatTheRodBearsIsWhatTheWallMakesOfItsShape) {
  Random random;
  int held = 0;
  Arm arm;
  const Present rough = wall(300.0, 0.2, 0.3);
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  for (int k = 0; k < 40; ++k) {
    const Eigen::Vector3d next = random.pressures_pa();
    for (int i = 1; i <= 4; ++i) {
      ASSERT_TRUE(arm.settle(rough, last + 0.25 * i * (next - last), {0.0, 0.0, 9.81}, k + i > 1)) << k;
      // 0.1 um of a wall of 300 N/m; friction pulls by a share of it.
      EXPECT_LT((arm.force_n(rough) - arm.borne_n()).norm(), 1e-4) << k;
      held += arm.borne_n().norm() > 0.1;
    }
    last = next;
  }
  EXPECT_GT(held, 20);
}

TEST(HeldPlaces, ALimpArmIsHeldByTheLawWhereItThenIs) {
  const FineRod fine(effects::testing::shipped_arm("online_200mm"));
  const std::vector<Present> stiff{wall(2000.0, 0.2)};
  const std::vector<Memory> memories(1);
  const HeldPlaces places(fine, stiff, memories);
  // 25 mm inside of a wall, yielding by 0.1 m/N: (k d) / (1 + k c) holds it.
  const Eigen::Vector3d towards(std::cos(0.09), std::sin(0.09), 0.0);
  const Eigen::VectorXd position = (kDistance_m + 0.025) * towards;
  const Eigen::VectorXd step =
      places.step_n(position, Eigen::VectorXd::Zero(3), 0.1 * Eigen::MatrixXd::Identity(3, 3));
  EXPECT_LT((step + 2000.0 * 0.025 / (1.0 + 2000.0 * 0.1) * towards).norm(), 1e-6);
  // Outside it lets go of what it was held by.
  const Eigen::VectorXd force = -0.01 * towards, outside = (kDistance_m - 0.01) * towards;
  EXPECT_LT((places.step_n(outside, force, 0.1 * Eigen::MatrixXd::Identity(3, 3)) + force).norm(), 1e-9);
  // 6 mm outside by a force that holds it back by 30 mm: 24 mm inside without. Of the kink's other side, so
  // much limper than the wall, a search along the first direction must find the few hundredths of a mm.
  const Eigen::MatrixXd limp = 0.62 * Eigen::MatrixXd::Identity(3, 3);
  const Eigen::VectorXd pushed = -0.030 / 0.62 * towards, aside = (kDistance_m - 0.006) * towards;
  const double held_n = 2000.0 * 0.024 / (1.0 + 2000.0 * 0.62);
  EXPECT_LT((places.step_n(aside, pushed, limp) + pushed + held_n * towards).norm(), 1e-6);
}

TEST(HeldPlaces, OfAWallThatTouchesAtOnePlaceThereIsOneAtTheLawsForce) {
  const FineRod fine(effects::testing::shipped_arm("online_200mm"));
  const Present one = wall(80.0, 0.15, 0.3);
  EXPECT_EQ(one.effect->held_places_m(fine, one.values), std::vector<double>{0.15});
  const Eigen::Vector3d n = towards_wall(), along(0.0, 0.0, 1.0);
  const Eigen::Vector3d at = (kDistance_m + 0.004) * n + 0.14 * along;
  EXPECT_LT((one.effect->holding_force_n(fine, one.values, 0, at, {}) + 80.0 * 0.004 * n).norm(), 1e-12);
  // Held 1 mm back along the face; further than friction holds, by 0.3 of the depth.
  for (const double back_m : {1e-3, 5e-3}) {
    const Eigen::Vector3d from = kDistance_m * n + (0.14 - back_m) * along;
    const Eigen::Vector3d held_n =
        one.effect->holding_force_n(fine, one.values, 0, at, Memory(from.data(), from.data() + 3));
    EXPECT_LT((held_n + 80.0 * (0.004 * n + std::min(back_m, 0.0012) * along)).norm(), 1e-12) << back_m;
  }
}

TEST(HeldPlaces, AStretchHasFivePlacesAsFarAsTheArmGoes) {
  const FineRod fine(effects::testing::shipped_arm("online_200mm"));
  const FivePoints points;
  const Eigen::Vector3d at = (kDistance_m + 0.004) * towards_wall() + Eigen::Vector3d(0.0, 0.0, 0.1);
  for (const double middle_m : {0.02, 0.1, 0.16}) {
    const Present spread = wall(80.0, middle_m, 0.0, 0.06);
    const double from_m = std::max(0.0, middle_m - 0.06), to_m = std::min(0.2, middle_m + 0.06);
    const double share = (to_m - from_m) / 0.12;  // of the wall that is beside the arm
    const std::vector<double> places_m = spread.effect->held_places_m(fine, spread.values);
    ASSERT_EQ(places_m.size(), 5u);
    for (std::size_t i = 0; i < 5; ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      EXPECT_NEAR(places_m[i], 0.5 * (from_m + to_m) + points.at[k] * (to_m - from_m), 1e-12);
      const Eigen::Vector3d force_n = spread.effect->holding_force_n(fine, spread.values, i, at, {});
      EXPECT_LT((force_n + points.weight[k] * share * 80.0 * 0.004 * towards_wall()).norm(), 1e-12);
    }
  }
}

TEST(HeldPlaces, OfAWallThatGoesOnBeyondTheTipTheArmTouchesThePartBesideIt) {
  const FineRod fine(effects::testing::shipped_arm("online_200mm"));
  // A quarter of it is there: as a wall of that length with a quarter of the stiffness.
  const Present beyond = wall(80.0, 0.23, 0.3, 0.06), there = wall(20.0, 0.185, 0.3, 0.015);
  const std::vector<double> places_m = beyond.effect->held_places_m(fine, beyond.values);
  const std::vector<double> same_m = there.effect->held_places_m(fine, there.values);
  ASSERT_EQ(places_m.size(), same_m.size());
  const Eigen::Vector3d at = (kDistance_m + 0.004) * towards_wall() + Eigen::Vector3d(0.0, 0.0, 0.19);
  Eigen::Vector3d sum_n = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < places_m.size(); ++i) {
    EXPECT_NEAR(places_m[i], same_m[i], 1e-12);
    const Eigen::Vector3d force_n = beyond.effect->holding_force_n(fine, beyond.values, i, at, {});
    EXPECT_LT((force_n - there.effect->holding_force_n(fine, there.values, i, at, {})).norm(), 1e-12);
    sum_n += force_n;
  }
  EXPECT_LT((sum_n + 0.25 * 80.0 * 0.004 * towards_wall()).norm(), 1e-12);
  // Nothing of one that begins beyond it.
  const Present past = wall(80.0, 0.3, 0.3, 0.06);
  for (std::size_t i = 0; i < 5; ++i)
    EXPECT_TRUE(past.effect->holding_force_n(fine, past.values, i, at, {}).isZero());
  // One place is one of the arm.
  const Present one = wall(80.0, 0.21);
  EXPECT_EQ(one.effect->held_places_m(fine, one.values), std::vector<double>{fine.length_m()});
  EXPECT_LT((one.effect->holding_force_n(fine, one.values, 0, at, {}) + 80.0 * 0.004 * towards_wall()).norm(),
            1e-12);
}

/// At the tip half of it is beyond the arm.
TEST(HeldPlaces, AShortStretchHoldsTheArmAsOnePlaceDoes) {
  for (const double place_m : {0.1, 0.2}) {
    const double whole = place_m < 0.2 ? 200.0 : 400.0;
    Arm at_one, spread;
    int touched = 0;
    for (const Eigen::Vector3d& pressures :
         {Eigen::Vector3d(0.0, 0.0, 0.0), Eigen::Vector3d(2e4, 0.0, 0.0), Eigen::Vector3d(3e4, 0.0, 0.0),
          Eigen::Vector3d(3e4, 3e3, 0.0), Eigen::Vector3d(3e4, 0.0, 3e3), Eigen::Vector3d(1e3, 0.0, 0.0)}) {
      SCOPED_TRACE(pressures.transpose());
      const bool begun = !pressures.isZero();
      const Eigen::Vector3d weightless = Eigen::Vector3d::Zero();
      ASSERT_TRUE(at_one.settle(wall(200.0, place_m, 0.3), pressures, weightless, begun));
      ASSERT_TRUE(spread.settle(wall(whole, place_m, 0.3, 1e-6), pressures, weightless, begun));
      EXPECT_LT((at_one.tip_m() - spread.tip_m()).norm(), kSame_m);
      touched += at_one.borne_n().norm() > 0.1;
    }
    EXPECT_EQ(touched, 4) << place_m;
  }
}

/// The few points of a stretch against many walls that touch at one place each: a beam of the same stiffness
/// is off by 4 % of the force and 1 % of the way of its tip at most.
TEST(HeldPlaces, AStretchHoldsTheArmAsManyPlacesDo) {
  constexpr int kMany = 24;
  const double middle_m = 0.12, half_m = 0.08;
  for (const double stiffness : {30.0, 300.0}) {
    const Present spread = wall(stiffness, middle_m, 0.0, half_m);
    std::vector<Present> many;
    for (int i = 0; i < kMany; ++i)
      many.push_back(wall(stiffness / kMany, middle_m + half_m * ((2.0 * i + 1.0) / kMany - 1.0)));
    for (const double pressure_pa : {2e4, 3e4}) {
      SCOPED_TRACE(std::to_string(stiffness) + " N/m, " + std::to_string(pressure_pa) + " Pa");
      const Eigen::Vector3d pressures(pressure_pa, 0.0, 0.0), weightless = Eigen::Vector3d::Zero();
      Arm by_few, by_many, free;
      ASSERT_TRUE(free.settle(wall(0.0, middle_m), pressures, weightless, false));
      ASSERT_TRUE(by_few.settle(spread, pressures, weightless, false));
      ASSERT_TRUE(by_many.settle(many, pressures, weightless, false));
      const double moved_m = (by_many.tip_m() - free.tip_m()).norm(), borne_n = by_many.borne_n().norm();
      EXPECT_GT(moved_m, 5e-3);
      EXPECT_LT((by_few.tip_m() - by_many.tip_m()).norm(), 0.03 * moved_m);
      EXPECT_LT((by_few.borne_n() - by_many.borne_n()).norm(), 0.06 * borne_n);
      // In equilibrium with what the law makes of where each of its places is.
      const FivePoints points;
      const Eigen::Matrix3Xd at = by_few.places_m(spread), forces_n = by_few.forces_n(spread);
      ASSERT_EQ(at.cols(), 5);
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (Eigen::Index i = 0; i < at.cols(); ++i) {
        const double depth_m = std::max(0.0, towards_wall().dot(at.col(i)) - kDistance_m);
        const Eigen::Vector3d expected_n = -stiffness * points.weight[i] * depth_m * towards_wall();
        EXPECT_LT((forces_n.col(i) - expected_n).norm(), 1e-9) << i;
        sum += expected_n;
      }
      EXPECT_LT((sum - by_few.borne_n()).norm(), 1e-4);
    }
  }
}

TEST(HeldPlaces, EachPlaceOfAStretchIsHeldFromWhereItTouched) {
  const double friction = 0.3;
  const Present rough = wall(60.0, 0.12, friction, 0.08);
  const Eigen::Vector3d n = towards_wall(), weightless = Eigen::Vector3d::Zero();
  Arm arm;
  ASSERT_TRUE(arm.settle(rough, {0.0, 0.0, 0.0}, weightless, false));
  EXPECT_TRUE(arm.memory().empty()) << "nothing touches";
  ASSERT_TRUE(arm.settle(rough, {3e4, 0.0, 0.0}, weightless, true));
  const Memory first = arm.memory();
  ASSERT_EQ(first.size(), 15u);
  const Eigen::Map<const Eigen::Matrix3Xd> anchors(first.data(), 3, 5);
  const Eigen::Matrix3Xd pressed = arm.places_m(rough);
  int off = 0, touching = 0;
  for (Eigen::Index i = 0; i < 5; ++i) {
    const bool touches = n.dot(pressed.col(i)) > kDistance_m;
    off += !touches;
    touching += touches;
    if (touches) {
      EXPECT_LT((anchors.col(i) - pressed.col(i)).norm(), 1e-12) << i;
    } else {
      EXPECT_FALSE(anchors.col(i).allFinite()) << i;
    }
  }
  EXPECT_GE(off, 1);
  EXPECT_GE(touching, 2);
  // Drawn along the face: each is held by what it has come from its own anchor, or slips.
  ASSERT_TRUE(arm.settle(rough, {3e4, 5e3, 0.0}, weightless, true));
  const Memory second = arm.memory();
  ASSERT_EQ(second.size(), 15u);
  const Eigen::Map<const Eigen::Matrix3Xd> next(second.data(), 3, 5);
  const Eigen::Matrix3Xd drawn = arm.places_m(rough);
  std::vector<double> held_m;
  for (Eigen::Index i = 0; i < 5; ++i) {
    const double depth_m = n.dot(drawn.col(i)) - kDistance_m;
    if (depth_m <= 0.0 || !anchors.col(i).allFinite()) continue;
    Eigen::Vector3d way = drawn.col(i) - anchors.col(i);
    way -= n.dot(way) * n;
    const double most_m = friction * depth_m;
    if (way.norm() > most_m) way *= most_m / way.norm();
    EXPECT_LT((next.col(i) - (drawn.col(i) - way)).norm(), 1e-9) << i;
    held_m.push_back(way.norm());
  }
  ASSERT_GE(held_m.size(), 2u);
  EXPECT_GT(std::abs(held_m[0] - held_m[1]), 1e-5);
  // And back off the wall nothing is left.
  ASSERT_TRUE(arm.settle(rough, {0.0, 0.0, 0.0}, weightless, true));
  EXPECT_TRUE(arm.memory().empty());
}

TEST(HeldPlaces, AStretchThatIsSuddenlyTouchedIsHeldAsOneThatGrowsStiff) {
  int touched = 0;
  for (const double stiffness : {50.0, 2000.0}) {
    const auto spread = [&](double share) { return wall(share * stiffness, 0.12, 0.0, 0.08); };
    Random random;
    for (int k = 0; k < 8; ++k) {
      SCOPED_TRACE(std::to_string(stiffness) + " N/m, " + std::to_string(k));
      const Eigen::Vector3d pressures = random.pressures_pa(), gravity(0.0, 0.0, k % 2 == 0 ? 9.81 : -9.81);
      Arm slowly, suddenly;
      ASSERT_TRUE(slowly.settle(spread(0.0), pressures, gravity, false));
      const Eigen::Vector3d free_m = slowly.tip_m();
      for (double share = 1e-4; share < 1.0; share *= 1.25)
        ASSERT_TRUE(slowly.settle(spread(share), pressures, gravity, true));
      ASSERT_TRUE(slowly.settle(spread(1.0), pressures, gravity, true));
      ASSERT_TRUE(suddenly.settle(spread(1.0), pressures, gravity, false));
      EXPECT_LT((suddenly.tip_m() - slowly.tip_m()).norm(), kSame_m);
      touched += (slowly.tip_m() - free_m).norm() > 1e-3;
    }
  }
  EXPECT_GT(touched, 3);
}

/// Off the wall its force is none, and what moves the place is the other's doing.
TEST(HeldPlaces, BesideAnEffectThatAnswersToTheShapeThePlaceIsHeldByForcesToo) {
  const Present stiffens{effects::find("strain_stiffening"), (Values(1) << 0.02).finished()};
  Arm both({wall(1.0, 0.1), stiffens}), alone({wall(1.0, 0.1), stiffens});
  int off = 0, held = 0;
  for (const double pressure : {0.0, 1e3, 2e3, 3e4, 4e4, 1e3}) {
    SCOPED_TRACE(pressure);
    const Eigen::Vector3d pressures(pressure, 0.0, 0.0), gravity(0.0, 0.0, 9.81);
    const bool begun = both.compliance_m_per_n().size() > 0;
    ASSERT_TRUE(both.settle({wall(300.0, 0.2), stiffens}, pressures, gravity, begun));
    ASSERT_TRUE(alone.settle({wall(0.0, 0.2), stiffens}, pressures, gravity, false));
    ASSERT_EQ(both.compliance_m_per_n().rows(), 3) << "mixed instead";
    EXPECT_TRUE(both.compliance_m_per_n().allFinite());
    EXPECT_LT((both.force_n(wall(300.0, 0.2)) - both.borne_n()).norm(), 1e-3);
    const bool touches = both.borne_n().norm() > 0.0;
    if (!touches) {
      EXPECT_LT((both.tip_m() - alone.tip_m()).norm(), kSame_m);
    }
    off += !touches;
    held += touches;
  }
  EXPECT_GT(off, 1);
  EXPECT_GT(held, 1);
}

}  // namespace
}  // namespace softarm::model
