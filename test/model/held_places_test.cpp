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

/// @param place_m of the arm, that the wall touches
Present wall(double stiffness_n_per_m, double place_m, double friction = 0.0) {
  return {effects::find("contact"),
          (Values(6) << stiffness_n_per_m, place_m, 0.09, kDistance_m, friction, 0.0).finished()};
}

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
  /// Of the wall at the shape that was found, and what the rod bears there instead.
  Eigen::Vector3d force_n(const Present& present) const {
    return HeldPlaces(solver_.fine, {present}, memories_)
        .forces_n(HeldPlaces(solver_.fine, {present}, memories_).positions_m(solver_.rod, now_.shape));
  }
  Eigen::Vector3d borne_n() const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = FineRod::kFirstStation; i < solver_.rod.loads.size(); ++i)
      sum += solver_.rod.loads[i].force_n;
    return sum;
  }

 private:
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
