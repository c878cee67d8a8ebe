// Effects with memory look as the catalogue describes them.
#include <array>

#include "drive_trials.h"

namespace softarm::effects::testing {
namespace {

using Eigen::Vector4d;

constexpr double kEI = 0.027, kGain = 6.1e-6, kPerJamming = 1.3e-6;

/// No weight: moment and curvature are the same all along.
model::TrialData weightless(const arm::Arm& of, double duration_s, const InputsAt& inputs,
                            double block_s = 0.1) {
  model::TrialData trial = made_up(of, duration_s, inputs, 0.0, 50.0, block_s);
  for (model::Block& block : trial.blocks) block.gravity_base.setZero();
  return trial;
}

/// Curvature in the middle of a piece, towards x.
double curvature(const model::Predicted& p, std::size_t piece = 5) {
  EXPECT_TRUE(p.solved);
  return p.shape.middles[piece].u.y();
}

/// How much further the arm is bent at a pressure while it falls than while it rises, by the last cycles.
double loop_width(const std::string& id, const model::Values& values, double period_s) {
  model::ExtendedModel model(arm());
  const model::TrialData trial =
      weightless(arm(), 3.0 * period_s + 1.0, triangles(arm(), kChamber1, 40e3, period_s), 0.04);
  const std::vector<model::Predicted> path = predict(model, arm(), {{find(id), values}}, trial);
  std::array<double, 2> at{};
  for (std::size_t k = 1; k < path.size(); ++k) {
    const auto pressure = [&](std::size_t i) {
      const model::Block& block = trial.blocks[i];
      return trial.series.inputs
          .block(kChamber1, static_cast<Eigen::Index>(block.first), 1,
                 static_cast<Eigen::Index>(block.last - block.first))
          .mean();
    };
    const double a = pressure(k - 1) - 20e3, b = pressure(k) - 20e3;
    if (a == b || (a < 0.0) == (b < 0.0)) continue;
    at[b < a ? 1 : 0] = curvature(path[k - 1]) + a / (a - b) * (curvature(path[k]) - curvature(path[k - 1]));
  }
  return at[1] - at[0];
}

TEST(Hysteresis, OfTheMaterialIsTheSameLoopAtEverySpeed) {
  // 2500 Pa are 1 / m; a share of 0.1 of that, less what the loop's own stiffness takes.
  const Vector4d values(0.1, 2500.0, 1.0, 0.0);
  const double slow = loop_width("hysteresis", values, 20.0), fast = loop_width("hysteresis", values, 2.0);
  EXPECT_NEAR(slow, 0.1, 0.005);
  EXPECT_NEAR(fast, slow, 0.003);
}

TEST(Creep, WidensItsLoopWhenSlowAndNotAtEverySpeedTheSame) {
  const Vector4d values(0.1, 2.0, 0.0, 0.0);
  const double fast = loop_width("creep", values, 0.8), middle = loop_width("creep", values, 8.0);
  EXPECT_GT(middle, 1.5 * fast);
  EXPECT_GT(fast, 0.0);
}

TEST(Creep, DriftsInHoldsByItsShareAndTimeConstant) {
  model::ExtendedModel model(arm());
  const model::TrialData trial =
      weightless(arm(), 30.0, [](double t_s) { return Vector4d(t_s < 1.0 ? 0.0 : 20e3, 0.0, 0.0, 0.0); });
  const std::vector<model::Predicted> without = predict(model, arm(), {}, trial);
  for (const auto& [time_s, driven] : {std::pair(0.5, 0.0), {4.0, 0.0}, {4.0, 0.4}, {4.0, 1.0}}) {
    const std::vector<model::Predicted> with =
        predict(model, arm(), {{find("creep"), Vector4d(0.2, time_s, 0.0, driven)}}, trial);
    EXPECT_EQ(with[5].shape.middles[5].u, without[5].shape.middles[5].u);
    for (std::size_t k = 11; k < with.size(); ++k) {
      // The step is a line between two instants.
      const double held_s = with[k].instant.t_s - 0.99;
      const double grown = 1.0 + 0.2 * (1.0 - std::exp(-held_s / time_s));
      EXPECT_NEAR(curvature(with[k]) / curvature(without[k]), grown, 2e-3)
          << time_s << " " << driven << " " << held_s;
    }
  }
}

/// Against the mean of the exponentials over a level spectrum: exponential integrals.
TEST(Creep, OfASpectrumOfTimesGrowsAsItsIntegral) {
  model::ExtendedModel model(arm());
  const model::TrialData trial =
      weightless(arm(), 60.0, [](double t_s) { return Vector4d(t_s < 1.0 ? 0.0 : 20e3, 0.0, 0.0, 0.0); });
  const std::vector<model::Predicted> without = predict(model, arm(), {}, trial);
  for (const double decades : {1.0, 3.0}) {
    const double time_s = 5.0, fastest_s = time_s * std::pow(10.0, -0.5 * decades),
                 slowest_s = time_s * std::pow(10.0, 0.5 * decades);
    const std::vector<model::Predicted> with =
        predict(model, arm(), {{find("creep"), Vector4d(0.2, time_s, decades, 0.0)}}, trial);
    for (std::size_t k = 12; k < with.size(); k += 7) {
      const double held_s = with[k].instant.t_s - 0.99;
      const double left = (std::expint(-held_s / fastest_s) - std::expint(-held_s / slowest_s)) /
                          std::log(slowest_s / fastest_s);
      EXPECT_NEAR(curvature(with[k]) / curvature(without[k]), 1.0 + 0.2 * (1.0 - left), 2e-3)
          << decades << " " << held_s;
    }
  }
}

/// An arm that comes to lie across gravity bends on under its weight, unless only what drives it creeps.
TEST(Creep, OfTheDrivesLeavesWeightAlone) {
  model::ExtendedModel model(arm());
  model::TrialData trial = made_up(arm(), 20.0, [](double) -> Eigen::VectorXd { return Vector4d::Zero(); });
  for (std::size_t k = 10; k < trial.blocks.size(); ++k) trial.blocks[k].gravity_base = {9.80665, 0.0, 0.0};
  const auto last = [&](double driven) {
    return predict(model, arm(), {{find("creep"), Vector4d(0.2, 2.0, 0.0, driven)}}, trial).back();
  };
  const double without = curvature(predict(model, arm(), {}, trial).back());
  ASSERT_GT(std::abs(without), 0.1);
  EXPECT_NEAR(curvature(last(1.0)), without, 1e-9 * std::abs(without));
  EXPECT_GT(curvature(last(0.0)) / without, 1.15);
  const double half = curvature(last(0.5)) / without;
  EXPECT_GT(half, 1.07);
  EXPECT_LT(half, 1.13);
}

TEST(Creep, HasLongHappenedToAnArmThatIsHeldAtTheBeginning) {
  model::ExtendedModel model(arm());
  const model::TrialData trial = weightless(arm(), 3.0, [](double) { return Vector4d(20e3, 0.0, 0.0, 0.0); });
  const std::vector<model::Predicted> without = predict(model, arm(), {}, trial);
  for (const double driven : {0.0, 0.3, 1.0}) {
    const std::vector<model::Predicted> with =
        predict(model, arm(), {{find("creep"), Vector4d(0.2, 1.0, 2.0, driven)}}, trial);
    for (const model::Predicted& p : with) EXPECT_NEAR(curvature(p), 1.2 * curvature(without[0]), 1e-9);
  }
}

TEST(Mullins, IsStifferInTheFirstCycleAlone) {
  model::ExtendedModel model(arm());
  const double period_s = 6.0;
  const auto cycles = triangles(arm(), kChamber1, 20e3, period_s);
  const model::TrialData trial = weightless(arm(), 1.0 + 4.0 * period_s, [&](double t_s) -> Eigen::VectorXd {
    // Further in the fourth cycle.
    return (t_s > 1.0 + 3.0 * period_s ? 1.5 : 1.0) * cycles(t_s);
  });
  const std::vector<model::Predicted> without = predict(model, arm(), {}, trial);
  const std::vector<model::Predicted> with =
      predict(model, arm(), {{find("mullins"), Eigen::Vector3d(0.2, 0.0, 1.0)}}, trial);
  const auto ratio = [&](double t_s) {
    const auto k = static_cast<std::size_t>(10.0 * t_s);
    return curvature(with[k]) / curvature(without[k]);
  };
  EXPECT_NEAR(ratio(1.0 + 1.5), 1.0 / 1.2, 1e-3);                   // up for the first time
  EXPECT_NEAR(ratio(1.0 + 4.5), 1.0, 1e-3);                         // down
  EXPECT_NEAR(ratio(1.0 + period_s + 1.5), 1.0, 1e-3);              // up again
  EXPECT_NEAR(ratio(1.0 + 3.0 * period_s + 2.7), 1.0 / 1.2, 2e-3);  // further than ever
}

TEST(JammingMemory, KeepsTheShapeInWhichTheVacuumWasApplied) {
  model::ExtendedModel model(arm());
  // Bent, jammed, let go, released.
  const model::TrialData trial = weightless(arm(), 12.0, [](double t_s) {
    return Vector4d(t_s > 1.0 && t_s < 6.0 ? 20e3 : 0.0, 0.0, 0.0, t_s > 3.0 && t_s < 9.0 ? 60e3 : 0.0);
  });
  const model::Values share = Eigen::VectorXd::Constant(1, 0.6);
  const std::vector<model::Predicted> with = predict(model, arm(), {{find("jamming_memory"), share}}, trial);
  const std::vector<model::Predicted> without = predict(model, arm(), {}, trial);
  const auto at = [](const std::vector<model::Predicted>& path, double t_s) {
    return curvature(path[static_cast<std::size_t>(10.0 * t_s)]);
  };
  EXPECT_NEAR(at(with, 2.5), at(without, 2.5), 1e-9);  // nothing without vacuum
  // Jammed while bent: the core begins without moment where it was bent when the vacuum came.
  const double core = kPerJamming * 60e3, bent = at(without, 2.5);
  EXPECT_NEAR(at(without, 8.0), 0.0, 1e-9);
  EXPECT_GT(at(with, 5.0), at(without, 5.0) + 1.0);
  // Let go, it stays bent by its share of the stiffness.
  const double kept = at(with, 8.0) * (kEI + core) / (0.6 * core);
  EXPECT_GT(kept, 0.7 * bent);
  EXPECT_LT(kept, 1.01 * bent);
  EXPECT_NEAR(at(with, 11.0), 0.0, 1e-9);
}

TEST(JammingYield, SoftensAtLargeCurvatureUnderVacuumAndKeepsWhatSlipped) {
  model::ExtendedModel model(arm());
  const double vacuum = 60e3, core = kPerJamming * vacuum, yield = 1.0;
  const model::TrialData trial = weightless(
      arm(), 21.0,
      [=](double t_s) { return Vector4d(triangles(arm(), kChamber1, 40e3, 20.0)(t_s)[0], 0.0, 0.0, vacuum); },
      0.04);
  const std::vector<model::Predicted> with =
      predict(model, arm(), {{find("jamming_yield"), Eigen::Vector3d(1.0, yield, 0.0)}}, trial);
  const std::vector<model::Predicted> without = predict(model, arm(), {}, trial);
  bool slipped = false;
  for (std::size_t k = 30; k < with.size(); ++k) {
    const double p = with[k].instant.inputs[0];
    const double ei = kEI + core + kPerJamming * p / 3.0;
    if (!slipped && curvature(without[k]) < 0.98 * yield) {
      EXPECT_NEAR(curvature(with[k]), curvature(without[k]), 1e-9);
    } else if (with[k].instant.t_s < 10.9 && curvature(without[k]) > 1.05 * yield) {
      slipped = true;
      EXPECT_NEAR(curvature(with[k]), (kGain * p - core * yield) / (ei - core), 0.02);
    }
  }
  ASSERT_TRUE(slipped);
  EXPECT_GT(curvature(with[with.size() - 1]), 0.5);  // though the pressure is gone
  // Without vacuum there is nothing to slip.
  const model::TrialData loose = weightless(arm(), 5.0, triangles(arm(), kChamber1, 40e3, 4.0));
  const model::Present yields{find("jamming_yield"), Eigen::Vector3d(1.0, yield, 0.0)};
  EXPECT_LT((positions(predict(model, arm(), {yields}, loose)) - positions(predict(model, arm(), {}, loose)))
                .norm(),
            1e-7);
}

// Yields that are exponentially distributed make the moment 1 - exp(-u / yield) when it is first bent.
TEST(JammingYield, SpreadYieldsSlipOneAfterTheOther) {
  model::ExtendedModel model(arm());
  const double vacuum = 60e3, core = kPerJamming * vacuum, yield = 1.0;
  const model::TrialData trial = weightless(
      arm(), 10.5,
      [=](double t_s) { return Vector4d(triangles(arm(), kChamber1, 40e3, 20.0)(t_s)[0], 0.0, 0.0, vacuum); },
      0.04);
  const std::vector<model::Predicted> with =
      predict(model, arm(), {{find("jamming_yield"), Eigen::Vector3d(1.0, yield, 1.0)}}, trial);
  double most = 0.0;
  for (const model::Predicted& now : with) {
    if (now.instant.t_s > 9.9) break;
    const double p = now.instant.inputs[0], u = curvature(now), ei = kEI + core + kPerJamming * p / 3.0;
    const double held = core * yield * (1.0 - std::exp(-u / yield));
    // Five elements follow the exponential to 7.4 % of what it comes to.
    ASSERT_NEAR((ei - core) * u + held, kGain * p, 0.08 * core * yield) << now.instant.t_s;
    most = std::max(most, u);
  }
  EXPECT_GT(most, 2.0 * yield);
}

TEST(AxialMemory, TheLengthFollowsInHolds) {
  model::ExtendedModel model(arm());
  const double share = 0.4, time_s = 3.0;
  // Up within a second, then held.
  const model::TrialData trial = weightless(
      arm(), 15.0, [](double t_s) { return Vector4d(20e3 * std::clamp(t_s - 1.0, 0.0, 1.0), 0.0, 0.0, 0.0); },
      0.05);
  const std::vector<model::Predicted> without = predict(model, arm(), {}, trial);
  const std::vector<model::Predicted> with =
      predict(model, arm(), {{find("axial_memory"), Eigen::Vector3d(share, time_s, 0.0)}}, trial);
  const auto late_m = [&](std::size_t k) {
    return without[k].rest.lengths_m.sum() - with[k].rest.lengths_m.sum();
  };
  const double grown_m = without.back().rest.lengths_m.sum() - without.front().rest.lengths_m.sum();
  ASSERT_GT(grown_m, 1e-3);
  EXPECT_NEAR(late_m(0), 0.0, 1e-12);
  for (std::size_t k = 0; k < with.size(); ++k) {
    const double t_s = with[k].instant.t_s;
    if (t_s < 2.1) continue;
    // Of a ramp of a second.
    const double left = share * time_s * (std::exp(1.0 / time_s) - 1.0) * std::exp(-(t_s - 1.0) / time_s);
    EXPECT_NEAR(late_m(k), left * grown_m, 0.01 * grown_m) << t_s;
  }
}

TEST(Drift, IsMonotoneInTheTimeOfTheSession) {
  model::ExtendedModel model(arm());
  model::TrialData trial = weightless(
      arm(), 60.0, [](double) { return Vector4d(20e3, 0.0, 0.0, 0.0); }, 1.0);
  const std::vector<model::Predicted> without = predict(model, arm(), {}, trial);
  const auto ratio = [&](double gain, double stiffness, double fading_per_min, std::size_t k) {
    const model::Present drift{find("drift"), Eigen::Vector3d(gain, stiffness, fading_per_min)};
    return curvature(predict(model, arm(), {drift}, trial)[k]) / curvature(without[k]);
  };
  const double minutes = without[50].instant.t_s / 60.0;
  EXPECT_NEAR(ratio(-0.06, 0.0, 0.0, 50), 1.0 - 0.06 * minutes, 1e-6);
  EXPECT_NEAR(ratio(0.0, -0.06, 0.0, 50), 1.0 / (1.0 - 0.06 * minutes), 1e-6);
  EXPECT_NEAR(ratio(-0.06, 0.0, 1.0, 50), 1.0 - 0.06 * (1.0 - std::exp(-minutes)), 1e-6);
  trial.series.session_s = 600.0;
  EXPECT_NEAR(ratio(-0.06, 0.0, 0.0, 50), 1.0 - 0.06 * (10.0 + minutes), 1e-5);
}

TEST(Temperature, SwingsWithTheTimeOfTheSession) {
  model::ExtendedModel model(arm());
  model::TrialData trial = weightless(
      arm(), 30.0, [](double) { return Vector4d(20e3, 0.0, 0.0, 0.0); }, 1.0);
  const std::vector<model::Predicted> without = predict(model, arm(), {}, trial);
  model::Values values(5);
  values << 0.04, -0.02, 0.003, 0.002, 10.0;
  const model::Present swing{find("temperature"), values};
  for (const double session_s : {0.0, 300.0}) {
    trial.series.session_s = session_s;
    const model::Predicted with = predict(model, arm(), {swing}, trial)[20];
    const double angle = 2.0 * M_PI * (session_s + with.instant.t_s) / 600.0;
    EXPECT_NEAR(curvature(with) / curvature(without[20]),
                1.0 / (1.0 + 0.04 * std::sin(angle) - 0.02 * std::cos(angle)), 1e-6);
    EXPECT_NEAR(with.rest.lengths_m.sum() / without[20].rest.lengths_m.sum(),
                1.0 + 0.003 * std::sin(angle) + 0.002 * std::cos(angle), 1e-9);
  }
}

TEST(Drift, OfStiffnessLeavesWhatServosWindUp) {
  const arm::Arm wound = shipped_arm("cable_235mm");
  model::ExtendedModel model(wound);
  const auto rows = static_cast<Eigen::Index>(wound.inputs.scalars.size());
  const model::TrialData trial = weightless(
      wound, 10.0, [=](double) { return Eigen::VectorXd::Constant(rows, 0.5); }, 1.0);
  const std::vector<model::Predicted> without = predict(model, wound, {}, trial);
  const std::vector<model::Predicted> with =
      predict(model, wound, {{find("drift"), Eigen::Vector3d(0.0, -0.5, 0.0)}}, trial);
  EXPECT_GT(without.back().shape.middles[5].u.norm(), 0.1);
  EXPECT_LT((with.back().shape.middles[5].u - without.back().shape.middles[5].u).norm(), 1e-6);
}

TEST(TendonFriction, LowersThePullAlongTheArmAndComesBackLate) {
  const arm::Arm pulled = tendon_arm();
  model::ExtendedModel model(pulled);
  const double coefficient = 0.3;
  const model::TrialData trial = weightless(
      pulled, 21.0,
      [&](double t_s) -> Eigen::VectorXd {
        return Vector4d::Constant(0.5).array() + triangles(pulled, 0, 8.0, 20.0)(t_s).array();
      },
      0.04);
  const model::Present friction{find("tendon_friction"), Eigen::Vector3d(coefficient, coefficient, 0.0)};
  const std::vector<model::Predicted> with = predict(model, pulled, {friction}, trial);
  const std::vector<model::Predicted> without = predict(model, pulled, {}, trial);
  const std::size_t rising = 150, falling = 399;  // the same tension
  EXPECT_NEAR(with[rising].instant.inputs[0], with[falling].instant.inputs[0], 0.05);
  // Of a pull that rises e^(-mu angle) arrives; the antagonist's 0.5 N has its own.
  EXPECT_NEAR(curvature(with[rising], 0) / curvature(without[rising], 0), 1.0, 0.03);
  double angle = 0.0;
  for (std::size_t j = 0; j < 12; ++j) {
    const double bent = curvature(with[rising], j) * 0.2 / 12.0;
    const double here = angle + 0.5 * bent;
    angle += bent;
    const double tension = with[rising].instant.inputs[0];
    // 0.5 N on the other side has not moved.
    const double moment = 0.012 * (tension * std::exp(-coefficient * here) - 0.5);
    EXPECT_NEAR(curvature(with[rising], j) * kEI, moment, 0.02 * moment) << j;
    if (j > 0) {
      EXPECT_LT(curvature(with[rising], j), curvature(with[rising], j - 1));
    }
  }
  EXPECT_GT(angle, 0.3);
  EXPECT_GT(curvature(with[falling], 11), 1.05 * curvature(with[rising], 11));
  // Led around something before the base, all of the arm lacks it.
  const model::Present led{find("tendon_friction"), Eigen::Vector3d(coefficient, coefficient, 1.0)};
  EXPECT_LT(curvature(predict(model, pulled, {led}, trial)[rising], 0), 0.85 * curvature(without[rising], 0));
}

}  // namespace
}  // namespace softarm::effects::testing
