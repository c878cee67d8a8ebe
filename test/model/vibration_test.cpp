// How an arm swings: against closed forms, an integration of its own, and the virtual rig's dynamics.
#include "model/vibration.h"

#include <gtest/gtest.h>

#include <cmath>

#include "diagnose/recorded_case.h"
#include "effects/body_fixture.h"
#include "math/statistics.h"

namespace softarm::model {
namespace {

namespace body_testing = effects::body_testing;

/// Runge and Kutta's fourth order, in many steps.
Oscillator::State integrated(Oscillator::State at, double stiffness, double damping, double g0, double g1,
                             double dt_s) {
  constexpr int kSteps = 200000;
  const double h = dt_s / kSteps;
  const auto rate = [&](const Oscillator::State& s, double t) {
    const double g = g0 + (g1 - g0) * t / dt_s;
    return Oscillator::State{s.rate, -damping * s.rate - stiffness * (s.x - g)};
  };
  const auto along = [](const Oscillator::State& s, const Oscillator::State& k, double by) {
    return Oscillator::State{s.x + by * k.x, s.rate + by * k.rate};
  };
  for (int i = 0; i < kSteps; ++i) {
    const double t = i * h;
    const Oscillator::State a = rate(at, t), b = rate(along(at, a, h / 2), t + h / 2),
                            c = rate(along(at, b, h / 2), t + h / 2), d = rate(along(at, c, h), t + h);
    at.x += h / 6 * (a.x + 2 * b.x + 2 * c.x + d.x);
    at.rate += h / 6 * (a.rate + 2 * b.rate + 2 * c.rate + d.rate);
  }
  return at;
}

TEST(Oscillator, IsExact) {
  struct Of {
    double stiffness, damping, dt_s;
  };
  for (const Of& of : {Of{300.0, 0.0, 0.1}, Of{300.0, 6.0, 0.1}, Of{300.0, 2.0 * std::sqrt(300.0), 0.1},
                       Of{300.0, 80.0, 0.1}, Of{1e4, 4e3, 0.05}, Of{4.0, 0.1, 3.0}}) {
    const Oscillator::State begin{0.7, -3.0};
    const Oscillator::State expected = integrated(begin, of.stiffness, of.damping, -0.4, 1.1, of.dt_s);
    const Oscillator::State now = Oscillator(of.stiffness, of.damping, of.dt_s).step(begin, -0.4, 1.1);
    EXPECT_NEAR(now.x, expected.x, 1e-9) << of.stiffness << " " << of.damping;
    EXPECT_NEAR(now.rate, expected.rate, 1e-7) << of.stiffness << " " << of.damping;
  }
}

struct Straight {
  Modes modes;
  Rest rest;
};

/// The arm without weight, its payload at its tip.
Straight straight(const arm::Arm& arm, double payload_kg, const Eigen::Quaterniond& q_base) {
  ExtendedModel model(arm);
  TrialData trial = body_testing::trial_of(
      arm,
      {{Eigen::VectorXd::Zero(static_cast<Eigen::Index>(arm.inputs.scalars.size())), payload_kg, q_base}});
  for (Block& block : trial.blocks) block.gravity_base.setZero();
  const auto path = body_testing::predict(model, arm, {}, trial);
  const TrialModes modes = model.modes(arm, {}, {false, 0.0}, trial, path);
  if (modes.at(0) == nullptr) throw std::runtime_error("no modes");
  return {*modes[0], path[0].rest};
}

TEST(Modes, AreEulerAndBernoullisOfACantilever) {
  const arm::Arm arm = body_testing::shipped("online_200mm");
  const arm::Segment& segment = arm.segments[0];
  const double length_m = segment.length_m;
  const double unit =
      segment.bending_stiffness.base_nm2 / (segment.mass_per_length_kg_m * std::pow(length_m, 4));  // 1/s^2
  const Modes modes = straight(arm, 0.0, body_testing::hanging()).modes;
  ASSERT_EQ(modes.stiffness.size(), 4);
  // Masses at twelve stations stand for the rod.
  for (const int first : {3, 2})
    EXPECT_NEAR(modes.stiffness[first], std::pow(1.875104, 4) * unit, 0.02 * std::pow(1.875104, 4) * unit);
  for (const int second : {1, 0})
    EXPECT_NEAR(modes.stiffness[second], std::pow(4.694091, 4) * unit, 0.06 * std::pow(4.694091, 4) * unit);
  // Nothing but the wall brings it back.
  for (Eigen::Index m = 0; m < 4; ++m)
    EXPECT_NEAR(modes.elastic[m], modes.stiffness[m], (m < 2 ? 0.05 : 0.01) * modes.stiffness[m]);
  // A mass at the tip that is heavy against the arm: a spring 3 EI / L^3, and 33 / 140 of the arm's mass.
  constexpr double kPayload_kg = 1.0;
  const Modes heavy = straight(arm, kPayload_kg, body_testing::hanging()).modes;
  const double expected = 3.0 * segment.bending_stiffness.base_nm2 / std::pow(length_m, 3) /
                          (kPayload_kg + 33.0 / 140.0 * segment.mass_per_length_kg_m * length_m);
  EXPECT_NEAR(heavy.stiffness[3], expected, 0.005 * expected);
  // However it is mounted.
  const Modes turned = straight(arm, 0.0, body_testing::horizontal()).modes;
  EXPECT_LT((turned.stiffness - modes.stiffness).norm(), 1e-6 * modes.stiffness.norm());
}

TEST(Modes, AreScaledToAnotherArmOfTheSameShapes) {
  const arm::Arm arm = body_testing::shipped("online_200mm");
  const Straight here = straight(arm, 0.1, body_testing::hanging());
  arm::Arm stiffer = arm;
  stiffer.segments[0].bending_stiffness.base_nm2 *= 1.1;
  for (const auto& [other, payload_kg] : {std::pair{stiffer, 0.1}, std::pair{arm, 0.11}}) {
    const Straight there = straight(other, payload_kg, body_testing::hanging());
    const Modes::Springs springs = here.modes.springs_of(there.rest, {0.0, 0.5});
    for (const int first : {2, 3}) {
      EXPECT_GT(std::abs(there.modes.stiffness[first] / here.modes.stiffness[first] - 1.0), 0.05);
      EXPECT_NEAR(springs.stiffness[first], there.modes.stiffness[first],
                  0.005 * there.modes.stiffness[first]);
      EXPECT_NEAR(springs.damping[first], 0.5 * there.modes.elastic[first],
                  0.005 * there.modes.elastic[first]);
    }
  }
  // As much again that moves along.
  Rest limp = here.rest;
  limp.compliance *= 1e3;
  const Modes::Springs held = here.modes.springs_of(limp, {0.0, -0.5});
  EXPECT_GT(held.stiffness.minCoeff(), 0.0);
  EXPECT_GE(held.damping.minCoeff(), 0.0);
  const Modes::Springs heavier = here.modes.springs_of(here.rest, {1.0, 0.0});
  EXPECT_NEAR(heavier.stiffness[3], 0.5 * here.modes.stiffness[3], 1e-9 * here.modes.stiffness[3]);
  // Twice as long, of half the density: an eighth of the stiffness.
  Rest stretched = here.rest;
  stretched.lengths_m *= 2.0;
  EXPECT_NEAR(here.modes.springs_of(stretched, {}).stiffness[3], here.modes.stiffness[3] / 8.0,
              0.02 * here.modes.stiffness[3] / 8.0);
}

TEST(Modes, AHangingPendulumHasItsWeightForASpring) {
  arm::Arm arm = body_testing::shipped("online_200mm");
  constexpr double kPayload_kg = 1.0;
  ExtendedModel model(arm);
  const TrialData trial = body_testing::trial_of(
      arm, {{Eigen::VectorXd::Zero(static_cast<Eigen::Index>(arm.inputs.scalars.size())), kPayload_kg,
             body_testing::hanging()}});
  const auto path = body_testing::predict(model, arm, {}, trial);
  const auto modes = model.modes(arm, {}, {false, 0.0}, trial, path).at(0);
  ASSERT_NE(modes, nullptr);
  EXPECT_LT(modes->elastic[3], 0.6 * modes->stiffness[3]);
  EXPECT_GT(modes->stiffness[3] - modes->elastic[3], 9.8 / arm.total_length_m());
}

/// A path of one number: two masses on springs would do as well.
struct OneNumber {
  TrialData trial;
  TrialModes modes;
  std::vector<Rest> rest;
};

OneNumber one_number(int blocks, double stiffness, double elastic) {
  OneNumber out;
  auto modes = std::make_shared<Modes>();
  modes->stiffness = Eigen::VectorXd::Constant(1, stiffness);
  modes->elastic = Eigen::VectorXd::Constant(1, elastic);
  modes->lengths_m = Eigen::VectorXd::Ones(1);
  modes->shape = Eigen::MatrixXd::Identity(3, 1);
  modes->curvature = std::sqrt(elastic) * modes->shape;
  for (int k = 0; k < blocks; ++k) {
    Block block;
    block.begins = k == 0;
    out.trial.blocks.push_back(block);
    out.modes.push_back(modes);
    Rest rest;
    rest.t_s = 0.1 * k;
    rest.stations.emplace_back(0.0, 0.0, 0.0);
    rest.masses_kg = rest.lengths_m = rest.compliance = Eigen::VectorXd::Ones(1);
    out.rest.push_back(rest);
  }
  return out;
}

TEST(SwingOfChange, OfAPathThatMovesFromTheBeginningOnIsNone) {
  const OneNumber of = one_number(60, 200.0, 200.0);
  Eigen::MatrixXd ramp(1, 60);
  for (int k = 0; k < 60; ++k) ramp(0, k) = 0.3 * k;
  const Eigen::MatrixXd beyond = SwingOfChange(of.modes, of.trial, of.rest, {0.0, 0.02}).beyond(ramp, ramp);
  // But for the wall's lag.
  EXPECT_LT((beyond.rightCols(59).array() + 0.02 * 3.0).abs().maxCoeff(), 1e-12);
}

TEST(SwingOfChange, StaysWithWhatStaysAndIsFreshAfterAPause) {
  OneNumber of = one_number(60, 200.0, 200.0);
  of.trial.blocks[50].begins = true;
  const SwingOfChange swing(of.modes, of.trial, of.rest, {0.0, 0.02});
  const Eigen::MatrixXd constant = Eigen::MatrixXd::Constant(1, 60, 1.5);
  EXPECT_LT(swing.beyond(constant, constant).lpNorm<Eigen::Infinity>(), 1e-12);
  Eigen::MatrixXd step = Eigen::MatrixXd::Zero(1, 60);
  step.rightCols(55).setConstant(1.0);  // within a block
  const Eigen::MatrixXd beyond = swing.beyond(step, step);
  EXPECT_DOUBLE_EQ(beyond(0, 4), 0.0);
  EXPECT_LT(beyond(0, 5), -0.2);          // it is late,
  EXPECT_GT(beyond.maxCoeff(), 0.3);      // overshoots,
  EXPECT_NEAR(beyond(0, 49), 0.0, 1e-3);  // and comes to rest
  EXPECT_DOUBLE_EQ(beyond(0, 50), 0.0);
}

TEST(FreeSwing, IsTheOscillatorsFromWhereItBeginsToAHand) {
  OneNumber of = one_number(60, 200.0, 200.0);
  auto modes = std::make_shared<Modes>(*of.modes[0]);
  modes->project = modes->shape.transpose();
  modes->bodies = Eigen::MatrixXd::Constant(6, 1, 2.0);
  for (auto& block : of.modes) block = modes;
  of.trial.blocks[40].set_aside = true;
  const std::vector<Eigen::MatrixXd> by = free_swing(of.modes, of.trial, of.rest, {0.0, 0.02}, 10);
  ASSERT_EQ(by.size(), 30U);
  const Oscillator whole(200.0, 4.0, 2.0);  // from block 10 to block 30
  EXPECT_NEAR(by[20](0, 0), 2.0 * whole.step({1.0, 0.0}, 0.0, 0.0).x, 1e-12);
  EXPECT_NEAR(by[20](0, 1), 2.0 * whole.step({0.0, 1.0}, 0.0, 0.0).x, 1e-12);
  EXPECT_DOUBLE_EQ(by[0](0, 0), 2.0);
  EXPECT_DOUBLE_EQ(by[0](0, 1), 0.0);
}

TEST(Swing, OfASlowPathIsWhatFollowsIt) {
  arm::Arm arm = body_testing::shipped("online_200mm");
  arm.segments[0].bending_stiffness.per_min_pressure_nm2_per_pa = 0.0;  // its kinks are not slow
  std::vector<body_testing::Condition> conditions;
  for (int k = 0; k < 300; ++k) {
    const double t = 0.1 * k;
    Eigen::VectorXd inputs(static_cast<Eigen::Index>(arm.inputs.scalars.size()));
    for (int chamber = 0; chamber < 3; ++chamber)
      inputs[chamber] = 2e4 * (1.0 + std::sin(0.5 * t + 2.0 * M_PI / 3.0 * chamber));
    conditions.push_back({inputs, 0.0, body_testing::hanging()});
  }
  const TrialData trial = body_testing::trial_of(arm, conditions, true);
  for (const double lag_s : {0.01, 0.02}) {
    ExtendedModel model(arm);
    std::vector<Predicted> following, swinging;
    model.predict(arm, {}, {true, lag_s}, trial, nullptr, following);
    const TrialModes modes = model.modes(arm, {}, {true, lag_s}, trial, following);
    model.predict(arm, {}, {true, lag_s, &modes}, trial, &following, swinging);
    double most_m = 0.0, inertial_m = 0.0;
    // Once what the beginning left has died away.
    for (std::size_t k = 50; k + 1 < following.size(); ++k) {
      most_m = std::max(most_m, (swinging[k].p - following[k].p).colwise().norm().maxCoeff());
      inertial_m = std::max(inertial_m, following[k].inertial_m);
    }
    EXPECT_GT(inertial_m, 5e-5);
    EXPECT_LT(most_m, 0.1 * inertial_m) << lag_s;
  }
}

/// Distances of the bodies from where they were seen while inertia moves the arm by more than `least_m`.
std::vector<double> distances(const TrialData& trial, const std::vector<Predicted>& path,
                              const std::vector<Predicted>& moved, double least_m) {
  std::vector<double> list;
  for (std::size_t k = 0; k < path.size(); ++k) {
    if (trial.blocks[k].set_aside || !path[k].solved || moved[k].inertial_m < least_m) continue;
    for (std::size_t i = 0; i < trial.blocks[k].bodies.size(); ++i)
      list.push_back((path[k].p.col(static_cast<Eigen::Index>(i)) - trial.blocks[k].bodies[i].p_base).norm());
  }
  return list;
}

TEST(Swing, IsWhatTheVirtualRigDoes) {
  rig::Scenario scenario = diagnose::testing::fast_demo();
  scenario.mocap.ring_noise = {2e-5, 1e-3};
  const arm::Arm arm = body_testing::shipped("online_200mm");
  const Prepared prepared = prepare(arm, {diagnose::testing::record(arm, scenario, "fast")});
  const TrialData& trial = prepared.trials.at(0);
  ExtendedModel model(arm);
  std::vector<Predicted> following, swinging;
  const double lag_s = scenario.arm.segments.at(0).retardation_s;
  model.predict(arm, {}, {true, lag_s}, trial, nullptr, following);
  const TrialModes modes = model.modes(arm, {}, {true, lag_s}, trial, following);
  model.predict(arm, {}, {true, lag_s, &modes}, trial, &following, swinging);
  constexpr double kLeast_m = 0.004;
  const std::vector<double> before = distances(trial, following, swinging, kLeast_m),
                            after = distances(trial, swinging, swinging, kLeast_m);
  ASSERT_GT(after.size(), 60U);
  EXPECT_GT(math::median(before), 2e-3);
  EXPECT_LT(math::median(after), 0.15 * math::median(before));
  EXPECT_LT(math::median(after), 5e-4);
}

}  // namespace
}  // namespace softarm::model
