// Effects on inputs look as the catalogue describes them.
#include <optional>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "drive_trials.h"

namespace softarm::effects::testing {
namespace {

constexpr int kVacuum = 3;

model::Series driven(const std::string& id, const model::Values& values, const model::TrialData& trial) {
  model::Series series = trial.series;
  find(id)->drive(arm(), values, series);
  return series;
}

/// By how much more of `acting` there is while `commanded` falls through a level than while it rises, and its
/// mean there.
struct Loop {
  double width = 0.0, mean = 0.0;
};
Loop loop_at(const Eigen::RowVectorXd& commanded, const Eigen::RowVectorXd& acting, double level) {
  double sums[2] = {0.0, 0.0};
  int counts[2] = {0, 0};
  for (Eigen::Index i = commanded.size() / 4; i + 1 < commanded.size(); ++i) {
    const double a = commanded[i] - level, b = commanded[i + 1] - level;
    if (a == b || (a < 0.0) == (b < 0.0)) continue;
    const int falls = b < a ? 1 : 0;
    sums[falls] += acting[i] + a / (a - b) * (acting[i + 1] - acting[i]);
    ++counts[falls];
  }
  EXPECT_GT(std::min(counts[0], counts[1]), 0);
  const double up = sums[0] / counts[0], down = sums[1] / counts[1];
  return {down - up, 0.5 * (up + down)};
}

Loop pressure_loop(const std::string& id, const model::Values& values, double period_s) {
  const model::TrialData trial =
      made_up(arm(), 4.0 * period_s + 1.0, triangles(arm(), kChamber1, 30e3, period_s));
  return loop_at(trial.series.inputs.row(kChamber1), driven(id, values, trial).moment_inputs.row(kChamber1),
                 15e3);
}

TEST(Hysteresis, IsTheSameLoopAtEverySpeedAndOfItsWidth) {
  for (const double period_s : {2.0, 6.0, 20.0}) {
    const Loop loop = pressure_loop("hysteresis", Eigen::Vector4d(1.0, 2500.0, 0.0, 0.0), period_s);
    EXPECT_NEAR(loop.width, 2500.0, 5.0) << period_s;
    EXPECT_NEAR(loop.mean, 15e3, 5.0) << period_s;
    EXPECT_NEAR(pressure_loop("hysteresis", Eigen::Vector4d(0.3, 2500.0, 0.0, 0.0), period_s).width, 750.0,
                2.0);
  }
}

TEST(Hysteresis, OfPressuresLeavesTheVacuumAndOfTensionsHasItsOwnUnit) {
  const model::TrialData trial = made_up(arm(), 6.0, triangles(arm(), kVacuum, 60e3, 5.0));
  const model::Series series = driven("hysteresis", Eigen::Vector4d(1.0, 2500.0, 0.0, 0.0), trial);
  EXPECT_EQ(series.inputs, trial.series.inputs);
  const arm::Arm with_tendons = tendon_arm();
  const model::TrialData pulled = made_up(with_tendons, 21.0, triangles(with_tendons, 0, 6.0, 5.0));
  model::Series tensions = pulled.series;
  find("hysteresis")->drive(with_tendons, Eigen::Vector4d(1.0, 2500.0, 2.0, 0.0), tensions);
  EXPECT_NEAR(loop_at(pulled.series.inputs.row(0), tensions.moment_inputs.row(0), 3.0).width, 0.2, 0.002);
}

TEST(Hysteresis, OfOneChamberLeavesTheOthers) {
  const model::TrialData trial = made_up(arm(), 9.0, [](double t_s) {
    const double p = 15e3 - 15e3 * std::cos(t_s);
    return Eigen::Vector4d(p, p, p, 6e4);
  });
  const Eigen::Vector4d of_all(1.0, 2500.0, 0.0, 0.0), of_second(1.0, 2500.0, 0.0, 2.0);
  const model::Series all = driven("hysteresis", of_all, trial),
                      second = driven("hysteresis", of_second, trial);
  EXPECT_GT((second.inputs.row(1) - trial.series.inputs.row(1)).cwiseAbs().maxCoeff(), 1.2e3);
  EXPECT_EQ(second.inputs.row(1), all.inputs.row(1));
  EXPECT_EQ(second.moment_inputs.row(1), all.moment_inputs.row(1));
  for (const Eigen::Index row : {0, 2, 3}) {
    EXPECT_EQ(second.inputs.row(row), trial.series.inputs.row(row)) << row;
    EXPECT_EQ(second.moment_inputs.row(row), trial.series.moment_inputs.row(row)) << row;
  }
  // Nor does it begin with the loops of the others.
  EXPECT_EQ(find("hysteresis")->starts(arm(), of_all).size(), 3u);
  const std::vector<model::StartNumber> starts = find("hysteresis")->starts(arm(), of_second);
  ASSERT_EQ(starts.size(), 1u);
  EXPECT_EQ(starts[0].name, arm().inputs.scalars[1].name);
}

TEST(Hysteresis, IsLookedForInAllChambersInEachAndInTheMaterial) {
  model::ExtendedModel model(arm());
  const model::Effect& loop = *find("hysteresis");
  std::set<std::pair<double, double>> places;
  for (const model::Values& values : loop.grid(arm(), model.rod())) places.emplace(values[2], values[3]);
  EXPECT_EQ(places, (std::set<std::pair<double, double>>{
                        {0.0, 0.0}, {0.0, 1.0}, {0.0, 2.0}, {0.0, 3.0}, {1.0, 0.0}}));
  EXPECT_TRUE(loop.has_parameter(arm(), 3));
  // Without pressures there is no chamber to number.
  const arm::Arm with_tendons = tendon_arm();
  model::ExtendedModel pulled(with_tendons);
  for (const model::Values& values : loop.grid(with_tendons, pulled.rod())) EXPECT_EQ(values[3], 0.0);
  EXPECT_FALSE(loop.has_parameter(with_tendons, 3));
}

TEST(FlowLimit, LetsSlowRampsPassAndCutsFastOnes) {
  const Eigen::Vector4d values(1.0, 10e3, 0.5, 0.0);
  const model::TrialData slow = made_up(arm(), 41.0, triangles(arm(), kChamber1, 30e3, 20.0)),
                         fast = made_up(arm(), 5.0, triangles(arm(), kChamber1, 30e3, 4.0));
  // 3 kPa/s up and down.
  EXPECT_EQ(driven("flow_limit", values, slow).moment_inputs, slow.series.moment_inputs);
  // 15 kPa/s: up at 10, down at 5.
  const model::Series series = driven("flow_limit", values, fast);
  double steepest = 0.0, fall = 0.0;
  for (Eigen::Index i = 1; i < series.t_s.size(); ++i) {
    const double rate =
        (series.inputs(kChamber1, i) - series.inputs(kChamber1, i - 1)) / (series.t_s[i] - series.t_s[i - 1]);
    steepest = std::max(steepest, rate);
    fall = std::min(fall, rate);
  }
  EXPECT_NEAR(steepest, 10e3, 1.0);
  EXPECT_NEAR(fall, -5e3, 1.0);
  EXPECT_EQ(series.inputs.row(kVacuum), fast.series.inputs.row(kVacuum));
}

TEST(FlowLimit, OfOneSourceIsSharedByWhatRises) {
  // From 1 s on chambers 1 and 2 are told 20 and 5 kPa, 3 is vented.
  const model::TrialData trial = made_up(arm(), 8.0, [](double t_s) {
    const bool told = t_s > 0.995;
    return Eigen::Vector4d(told ? 20e3 : 0.0, told ? 5e3 : 0.0, told ? 0.0 : 8e3, 40e3);
  });
  const model::Series series = driven("flow_limit", Eigen::Vector4d(1.0, 5e3, 2.0, 1.0), trial);
  const auto at = [&](Eigen::Index row, double t_s) {
    return series.inputs(row, static_cast<Eigen::Index>(t_s * 50.0));
  };
  // Together they rise at 5 kPa/s, the one that is farther behind faster, until all 25 kPa are there.
  for (const double t_s : {1.5, 3.0, 5.0})
    EXPECT_NEAR(at(kChamber1, t_s) + at(kChamber1 + 1, t_s), 5e3 * (t_s - 0.98), 1.0) << t_s;
  EXPECT_NEAR(at(kChamber1, 1.1) / at(kChamber1 + 1, 1.1), 2.0, 0.05);
  EXPECT_LT(at(kChamber1 + 1, 4.0), 5e3);
  EXPECT_NEAR(at(kChamber1, 6.1), 20e3, 1.0);
  EXPECT_NEAR(at(kChamber1 + 1, 6.1), 5e3, 1.0);
  // Vents are their own.
  EXPECT_NEAR(at(kChamber1 + 2, 1.48), 8e3 - 10e3 * 0.5, 1.0);
  EXPECT_EQ(series.inputs.row(kVacuum), trial.series.inputs.row(kVacuum));
}

TEST(SupplySag, TakesFromAllWhatTheyDrawTogether) {
  // Chamber 1 rises at 5 kPa/s from 1 to 4 s and holds; 2 stands at 10 kPa, 3 falls and draws nothing.
  const model::TrialData trial = made_up(arm(), 30.0, [](double t_s) {
    Eigen::VectorXd u = Eigen::VectorXd::Zero(4);
    u << 5e3 * std::clamp(t_s - 1.0, 0.0, 3.0), 10e3, 15e3 - 5e3 * std::clamp(t_s - 1.0, 0.0, 3.0), 40e3;
    return u;
  });
  const auto sag = [](double time_s, double returned, double refill_pa_per_s = 0.0, double bends = 0.0) {
    model::Values values(5);
    values << 0.2, time_s, returned, refill_pa_per_s, bends;
    return values;
  };
  const model::Series flow = driven("supply_sag", sag(0.5, 0.0), trial);
  const auto at = [](const model::Series& series, Eigen::Index row, double t_s) {
    return series.inputs(row, static_cast<Eigen::Index>(t_s * 50.0));
  };
  // Flow times time: 2.5 kPa, of which a twentieth of 0.2 is lost. In the hold it comes back.
  EXPECT_NEAR(at(flow, 1, 3.9), 10e3 * (1.0 - 0.2 * 2.5 / 50.0), 10e3 * 0.2 * 0.05 * 0.02);
  EXPECT_NEAR(at(flow, 0, 3.9), 14.5e3 * (1.0 - 0.2 * 2.5 / 50.0), 1.0);
  EXPECT_NEAR(at(flow, 1, 29.0), 10e3, 1e-6);
  // Of a source that is not filled again it is what all have risen since the beginning, but for what is
  // taken for noise; what one vents is lost, or another has it.
  const model::Series sum = driven("supply_sag", sag(1000.0, 0.0), trial);
  EXPECT_NEAR(at(sum, 1, 20.0), 10e3 * (1.0 - 0.2 * 14.5 / 50.0), 15.0);
  const model::Series line = driven("supply_sag", sag(1000.0, 1.0), trial);
  EXPECT_NEAR(at(line, 1, 20.0), 10e3, 1.0);
  // A pump makes up for it at its rate, and what is lost comes to an end.
  const model::Series pumped = driven("supply_sag", sag(1000.0, 0.0, 1e3), trial);
  EXPECT_NEAR(at(pumped, 1, 10.0), 10e3 * (1.0 - 0.2 * (14.5 - 8.9) / 50.0), 15.0);
  EXPECT_NEAR(at(pumped, 1, 29.0), 10e3, 1e-6);
  // A sensor's noise is no air.
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0.0, 300.0);
  const model::TrialData rests =
      made_up(arm(), 30.0, [&](double) { return Eigen::VectorXd::Constant(4, 10e3 + noise(random)).eval(); });
  const model::Series still = driven("supply_sag", sag(60.0, 0.0), rests);
  EXPECT_LT((still.inputs.row(1) - rests.series.inputs.row(1)).cwiseAbs().maxCoeff(),
            11e3 * 0.2 * 1e3 / 50e3);
  const model::Series bent = driven("supply_sag", sag(1000.0, 0.0, 0.0, 2.0), trial);
  EXPECT_NEAR(at(bent, 1, 20.0), 10e3 * (1.0 - 0.2 * 0.29 / (1.0 + 2.0 * 0.29)), 15.0);
  EXPECT_EQ(sum.inputs.row(kVacuum), trial.series.inputs.row(kVacuum));
  EXPECT_EQ(sum.inputs.topRows(3), sum.moment_inputs.topRows(3));
}

TEST(TendonSlack, IsLostOnBothSides) {
  const arm::Arm wound = shipped_arm("cable_235mm");
  model::Series series = made_up(wound, 21.0, triangles(wound, 0, 0.6, 20.0)).series;
  const Eigen::RowVectorXd before = series.inputs.row(0);
  series.moment_inputs.rightCols(series.t_s.size() / 2) *= -1.0;
  const Eigen::RowVectorXd commanded = series.moment_inputs.row(0);
  find("tendon_slack")->drive(wound, Eigen::Vector2d(0.1, 0.1), series);
  for (Eigen::Index i = 0; i < commanded.size(); ++i)
    EXPECT_NEAR(series.moment_inputs(0, i),
                std::copysign(std::max(0.0, std::abs(commanded[i]) - 0.1), commanded[i]), 1e-12);
  EXPECT_EQ(series.inputs.row(0), before);
}

/// Servos held at some angles, no weight.
model::TrialData held_weightless(const arm::Arm& wound, const Eigen::Vector4d& angles_rad) {
  model::TrialData trial = made_up(wound, 1.0, [&](double) { return angles_rad; });
  for (model::Block& block : trial.blocks) block.gravity_base.setZero();
  return trial;
}

/// Curvatures of the pieces of a segment that is bent alike all along, towards x and y of the section.
Eigen::Vector2d bent_alike_per_m(const model::FineRod& fine, const model::Predicted& now, int segment) {
  std::optional<Eigen::Vector2d> bent;
  for (std::size_t j = 0; j < fine.pieces().size(); ++j) {
    if (fine.pieces()[j].segment != segment) continue;
    const Eigen::Vector3d& u = now.shape.middles.at(j).u;
    if (!bent) bent = Eigen::Vector2d(u.y(), -u.x());
    EXPECT_LT((*bent - Eigen::Vector2d(u.y(), -u.x())).norm(), 1e-6);
  }
  return bent.value();
}

TEST(TendonLength, BendsASegmentBackByWhatTheOneBeforeIsBent) {
  const arm::Arm wound = arm_in_sections();
  const model::TrialData trial = held_weightless(wound, {0.6, 0.3, 0.2, 0.0});
  model::ExtendedModel model(wound);
  const Eigen::Vector2d first(0.6, 0.3), second(0.2, 0.0);
  for (const double share : {0.4, 1.0, -0.5}) {
    const model::Present present{find("tendon_length"), Eigen::VectorXd::Constant(1, share)};
    for (const model::Predicted& now : predict(model, wound, {present}, trial)) {
      ASSERT_TRUE(now.solved);
      EXPECT_LT((bent_alike_per_m(model.rod(), now, 0) - kSectionGain * first).norm(), 1e-5);
      EXPECT_LT((bent_alike_per_m(model.rod(), now, 1) - kSectionGain * (second - share * first)).norm(),
                1e-5);
    }
  }
}

TEST(TendonLength, HoldsWhereItsCablesPullHoweverManyThereAre) {
  const Eigen::Vector2d first(0.6, 0.3);
  const auto back = [&](const std::vector<double>& azimuths_deg) {
    arm::Arm wound = arm_in_sections();
    wound.segments[1].cables.clear();
    for (const double azimuth_deg : azimuths_deg)
      wound.segments[1].cables.push_back({"servo_4", azimuth_deg * M_PI / 180.0, kSectionGain});
    model::ExtendedModel model(wound);
    const model::Present present{find("tendon_length"), Eigen::VectorXd::Constant(1, 0.5)};
    const std::vector<model::Predicted> path =
        predict(model, wound, {present}, held_weightless(wound, {first.x(), first.y(), 0.0, 0.0}));
    return Eigen::Vector2d(-bent_alike_per_m(model.rod(), path.back(), 1) / (0.5 * kSectionGain));
  };
  EXPECT_LT((back({0.0, 120.0, 240.0}) - first).norm(), 1e-5);
  EXPECT_LT((back({10.0, 70.0}) - first).norm(), 1e-5);
  EXPECT_LT((back({0.0}) - Eigen::Vector2d(0.6, 0.0)).norm(), 1e-5);
  EXPECT_LT((back({90.0, 270.0}) - Eigen::Vector2d(0.0, 0.3)).norm(), 1e-5);
}

TEST(TendonLength, GoesByWhatLoadsBendAsWell) {
  const arm::Arm wound = arm_in_sections();
  model::TrialData trial = held_weightless(wound, Eigen::Vector4d::Zero());
  for (model::Block& block : trial.blocks) block.gravity_base = {9.80665, 0.0, 0.0};
  trial.series.payload_kg.setConstant(0.02);
  model::ExtendedModel model(wound);
  const model::Present present{find("tendon_length"), Eigen::VectorXd::Constant(1, 1.0)};
  const std::vector<model::Predicted> with = predict(model, wound, {present}, trial),
                                      without = predict(model, wound, {}, trial);
  const std::vector<model::Piece>& pieces = model.rod().pieces();
  Eigen::Vector2d bend = Eigen::Vector2d::Zero();
  for (std::size_t j = 0; j < pieces.size(); ++j)
    if (pieces[j].segment == 0)
      bend += (pieces[j].s_to_m - pieces[j].s_from_m) * with[0].shape.middles[j].u.head<2>();
  EXPECT_GT(bend.norm(), 0.2);
  for (std::size_t k = 0; k < model.rod().parameters().size(); ++k) {
    const rod::Parameter& parameter = model.rod().parameters()[k];
    if (parameter.kind != rod::ParameterKind::kRestCurvature || parameter.component == 2) continue;
    const bool distal = pieces[static_cast<std::size_t>(parameter.index)].segment == 1;
    EXPECT_NEAR(with[0].values[static_cast<Eigen::Index>(k)],
                distal ? -bend[parameter.component] / wound.segments[1].length_m : 0.0, 1e-3);
  }
  // Held against what the weights bend.
  EXPECT_LT(tip_x(with)[0], 0.9 * tip_x(without)[0]);
}

TEST(PressureLag, WidensItsLoopWithTheSpeed) {
  const Eigen::Vector4d values(0.2, 0.2, 1.0, 0.0);
  const double slow = pressure_loop("pressure_lag", values, 40.0).width;
  const double fast = pressure_loop("pressure_lag", values, 10.0).width;
  // 2 x delay x rate
  EXPECT_NEAR(slow, 0.4 * 30e3 / 20.0, 0.02 * slow);
  EXPECT_NEAR(fast, 4.0 * slow, 0.02 * fast);
}

TEST(PressureLag, IsALineOfFirstOrderWhereDelayAndTimeConstantAgree) {
  const model::TrialData trial = made_up(arm(), 4.0, [](double t_s) {
    Eigen::VectorXd u = Eigen::VectorXd::Zero(4);
    u[kChamber1] = t_s >= 1.0 ? 20e3 : 0.0;
    u[kVacuum] = u[kChamber1];
    return u;
  });
  const model::Series whole = driven("pressure_lag", Eigen::Vector4d(0.3, 0.3, 1.0, 0.0), trial);
  const model::Series half = driven("pressure_lag", Eigen::Vector4d(0.15, 0.3, 1.0, 0.0), trial);
  for (Eigen::Index i = 60; i < whole.t_s.size(); ++i) {
    // The step is a line between two frames of 20 ms.
    const double left = std::exp(-(whole.t_s[i] - 0.99) / 0.3);
    EXPECT_NEAR(whole.inputs(kChamber1, i), 20e3 * (1.0 - left), 5.0);
    EXPECT_NEAR(half.inputs(kChamber1, i), 20e3 * (1.0 - 0.5 * left), 5.0);
  }
  EXPECT_EQ(whole.inputs.row(kVacuum), trial.series.inputs.row(kVacuum));
  EXPECT_EQ(whole.inputs.row(kChamber1), whole.moment_inputs.row(kChamber1));
}

TEST(PressureLag, MayBeOfOneChamber) {
  const model::TrialData trial = made_up(arm(), 3.0, [](double t_s) {
    const double p = t_s >= 1.0 ? 20e3 : 0.0;
    return Eigen::Vector4d(p, p, p, 0.0);
  });
  const model::Series all = driven("pressure_lag", Eigen::Vector4d(0.3, 0.3, 1.0, 0.0), trial);
  const model::Series third = driven("pressure_lag", Eigen::Vector4d(0.3, 0.3, 1.0, 3.0), trial);
  EXPECT_EQ(third.inputs.row(2), all.inputs.row(2));
  EXPECT_EQ(third.moment_inputs.row(2), all.moment_inputs.row(2));
  EXPECT_EQ(third.inputs.topRows(2), trial.series.inputs.topRows(2));
  EXPECT_EQ(third.moment_inputs.topRows(2), trial.series.moment_inputs.topRows(2));
}

TEST(PressureLag, MayFallMoreSlowlyThanItRises) {
  const model::TrialData trial = made_up(arm(), 6.0, [](double t_s) {
    return Eigen::Vector4d(t_s >= 1.0 && t_s < 4.0 ? 20e3 : 0.0, 0.0, 0.0, 0.0);
  });
  const model::Series series = driven("pressure_lag", Eigen::Vector4d(0.2, 0.2, 2.0, 0.0), trial);
  for (Eigen::Index i = 0; i < series.t_s.size(); ++i) {
    const double t_s = series.t_s[i];
    if (t_s > 1.1 && t_s < 3.9) {
      EXPECT_NEAR(series.inputs(0, i), 20e3 * (1.0 - std::exp(-(t_s - 0.99) / 0.2)), 10.0);
    } else if (t_s > 4.1) {
      EXPECT_NEAR(series.inputs(0, i), 20e3 * std::exp(-(t_s - 3.99) / 0.4), 60.0);
    }
  }
}

TEST(ClockOffset, ShiftsAllInputsAtAnySpeed) {
  const model::TrialData trial = made_up(arm(), 6.0, [](double t_s) {
    return Eigen::Vector4d(10e3 * std::sin(t_s), 5e3 * std::sin(3.0 * t_s), 0.0, 1e3 * t_s);
  });
  for (const double offset_s : {0.13, -0.07}) {
    const model::Series series = driven("clock_offset", Eigen::Vector2d(offset_s, 0.0), trial);
    for (Eigen::Index i = 20; i < 280; ++i) {
      const double then_s = series.t_s[i] - offset_s;
      EXPECT_NEAR(series.inputs(0, i), 10e3 * std::sin(then_s), 3.0);
      EXPECT_NEAR(series.moment_inputs(1, i), 5e3 * std::sin(3.0 * then_s), 5.0);
      EXPECT_NEAR(series.inputs(3, i), 1e3 * then_s, 1e-6);
    }
    EXPECT_EQ(series.inputs(0, offset_s > 0.0 ? 0 : 299), trial.series.inputs(0, offset_s > 0.0 ? 0 : 299));
  }
}

TEST(ClockOffset, ShiftsOneInputAlone) {
  const model::TrialData trial = made_up(arm(), 6.0, [](double t_s) {
    return Eigen::Vector4d(10e3 * std::sin(t_s), 5e3 * std::sin(3.0 * t_s), 0.0, 1e3 * t_s);
  });
  const model::Series series = driven("clock_offset", Eigen::Vector2d(0.13, 2.0), trial);
  for (Eigen::Index i = 20; i < 280; ++i) {
    EXPECT_NEAR(series.inputs(1, i), 5e3 * std::sin(3.0 * (series.t_s[i] - 0.13)), 5.0);
    EXPECT_NEAR(series.moment_inputs(1, i), 5e3 * std::sin(3.0 * (series.t_s[i] - 0.13)), 5.0);
  }
  for (const Eigen::Index row : {0, 2, 3}) {
    EXPECT_EQ(series.inputs.row(row), trial.series.inputs.row(row)) << row;
    EXPECT_EQ(series.moment_inputs.row(row), trial.series.moment_inputs.row(row)) << row;
  }
}

TEST(ClockDrift, ShiftsAllInputsTheMoreTheLaterInTheSession) {
  model::TrialData trial = made_up(
      arm(), 6.0, [](double t_s) { return Eigen::Vector4d(2e3 * t_s, 9e3 - 1e3 * t_s, 5e3, 40.0 * t_s); });
  int compared = 0;
  for (const double session_s : {0.0, 90.0}) {
    trial.series.session_s = session_s;
    for (const auto& [rate, offset_s] : {std::pair(0.02, 0.0), std::pair(-0.003, 0.4)}) {
      const model::Series series = driven("clock_drift", Eigen::Vector2d(rate, offset_s), trial);
      for (Eigen::Index i = 0; i < 300; ++i) {
        // What was before the trial, or will be after it, is held.
        const double then_s =
            std::clamp(series.t_s[i] - offset_s - rate * (session_s + series.t_s[i]), 0.0, series.t_s[299]);
        EXPECT_NEAR(series.inputs(0, i), 2e3 * then_s, 1e-6);
        EXPECT_NEAR(series.moment_inputs(1, i), 9e3 - 1e3 * then_s, 1e-6);
        EXPECT_NEAR(series.inputs(2, i), 5e3, 1e-6);
        EXPECT_NEAR(series.inputs(3, i), 40.0 * then_s, 1e-6);
        compared += then_s > 0.0 && then_s < series.t_s[299];
      }
    }
  }
  EXPECT_GT(compared, 900);
}

TEST(ClockDrift, SaysNothingOfTrialsAnHourAndMoreLater) {
  model::TrialData trial =
      made_up(arm(), 2.0, [](double t_s) { return Eigen::Vector4d(2e3 * t_s, 0.0, 0.0, 0.0); });
  for (const double session_s : {100.0, 3500.0, 4000.0, 90000.0}) {
    trial.series.session_s = session_s;
    const model::Series series = driven("clock_drift", Eigen::Vector2d(1e-4, 0.0), trial);
    EXPECT_EQ(series.inputs != trial.series.inputs, session_s < 3600.0) << session_s;
  }
}

TEST(ClockDrift, OfNoRateDoesNothingHoweverLate) {
  model::TrialData trial =
      made_up(arm(), 2.0, [](double t_s) { return Eigen::Vector4d(2e3 * t_s, 0.0, 0.0, 0.0); });
  trial.series.session_s = 1e4;
  const model::Series series = driven("clock_drift", model::Values::Zero(2), trial);
  EXPECT_EQ(series.inputs, trial.series.inputs);
  EXPECT_EQ(series.moment_inputs, trial.series.moment_inputs);
}

TEST(ClockDrift, ReachesTheInstantsOfATrial) {
  model::ExtendedModel model(arm());
  model::TrialData trial =
      made_up(arm(), 3.0, [](double t_s) { return Eigen::Vector4d(2e3 * t_s, 0.0, 0.0, 0.0); });
  trial.series.session_s = 50.0;
  const model::Present drift{find("clock_drift"), Eigen::Vector2d(0.01, 0.0)};
  for (const model::Predicted& now : predict(model, arm(), {drift}, trial)) {
    EXPECT_DOUBLE_EQ(now.instant.session_s, 50.0 + now.instant.t_s);
    if (now.instant.t_s > 0.7) {
      EXPECT_NEAR(now.instant.inputs[kChamber1], 2e3 * (now.instant.t_s - 0.01 * now.instant.session_s),
                  1e-6);
    }
  }
}

TEST(PressureDeadZone, IsFlatNearZeroPressureAndMissesAConstantBeyond) {
  const model::TrialData trial = made_up(arm(), 11.0, triangles(arm(), kChamber1, 30e3, 10.0));
  const model::Series series = driven("pressure_dead_zone", Eigen::Vector3d(3000.0, 3000.0, 0.0), trial);
  EXPECT_EQ(series.inputs, trial.series.inputs);
  for (Eigen::Index i = 0; i < series.t_s.size(); ++i)
    EXPECT_NEAR(series.moment_inputs(kChamber1, i), std::max(0.0, series.inputs(kChamber1, i) - 3000.0),
                1e-9);
  // The arm itself does not move there.
  model::ExtendedModel model(arm());
  const model::Present present{find("pressure_dead_zone"), Eigen::Vector3d(3000.0, 3000.0, 0.0)};
  const std::vector<model::Predicted> without = predict(model, arm(), {}, trial);
  const std::vector<model::Predicted> with = predict(model, arm(), {present}, trial);
  const auto bend = [](const model::Predicted& p) { return p.shape.middles[5].u.head<2>().norm(); };
  for (std::size_t k = 0; k < with.size(); ++k) {
    const double p_pa = without[k].instant.inputs[kChamber1];
    if (p_pa < 2900.0) {
      EXPECT_LT(bend(with[k]), 1e-6);
    }
    if (p_pa > 3100.0) {
      EXPECT_LT(bend(with[k]), bend(without[k]) - 0.1);
    }
  }
}

TEST(PressureDeadZone, OfOneChamberTakesItsPressureAndLeavesTheOthers) {
  const model::TrialData trial =
      made_up(arm(), 2.0, [](double t_s) { return Eigen::Vector4d(8e3, 2e3 + 4e3 * t_s, 9e3, 6e4); });
  const model::Series series = driven("pressure_dead_zone", Eigen::Vector3d(3000.0, 3000.0, 2.0), trial);
  for (Eigen::Index i = 0; i < series.t_s.size(); ++i) {
    const double left = std::max(0.0, trial.series.inputs(1, i) - 3000.0);
    EXPECT_NEAR(series.inputs(1, i), left, 1e-9);
    EXPECT_NEAR(series.moment_inputs(1, i), left, 1e-9);
  }
  for (const Eigen::Index row : {0, 2, 3}) {
    EXPECT_EQ(series.inputs.row(row), trial.series.inputs.row(row)) << row;
    EXPECT_EQ(series.moment_inputs.row(row), trial.series.moment_inputs.row(row)) << row;
  }
}

TEST(PressureDeadZone, IsLookedForInAllChambersAndInEach) {
  model::ExtendedModel model(arm());
  std::set<double> chambers;
  for (const model::Values& values : find("pressure_dead_zone")->grid(arm(), model.rod()))
    chambers.insert(values[2]);
  EXPECT_EQ(chambers, (std::set<double>{0.0, 1.0, 2.0, 3.0}));
}

TEST(GainNonlinearity, IsConvexAgainstThePressure) {
  const model::TrialData trial = made_up(arm(), 11.0, triangles(arm(), kChamber1, 50e3, 10.0));
  const model::Series series = driven("gain_nonlinearity", Eigen::VectorXd::Constant(1, 0.2), trial);
  EXPECT_EQ(series.inputs, trial.series.inputs);
  for (Eigen::Index i = 0; i < series.t_s.size(); ++i) {
    const double p = series.inputs(kChamber1, i);
    EXPECT_NEAR(series.moment_inputs(kChamber1, i), p * (1.0 + 0.2 * p / 50e3), 1e-8);
  }
}

TEST(ChamberMismatch, IsOneChambersGain) {
  const model::TrialData trial =
      made_up(arm(), 2.0, [](double) { return Eigen::Vector4d(1e4, 2e4, 3e4, 6e4); });
  const model::Series series = driven("chamber_mismatch", Eigen::Vector2d(0.05, 2.0), trial);
  EXPECT_TRUE(series.moment_inputs.col(9).isApprox(Eigen::Vector4d(1e4, 2.1e4, 3e4, 6e4), 1e-12));
  EXPECT_EQ(series.inputs, trial.series.inputs);
}

TEST(PressureOffset, IsASizeForEverySensorOfPressure) {
  const model::TrialData trial =
      made_up(arm(), 2.0, [](double) { return Eigen::Vector4d(1e4, 2e4, 3e4, 6e4); });
  model::Values values = model::Values::Zero(8);
  values.head<5>() << 100.0, -200.0, 300.0, 400.0, 500.0;
  const model::Series series = driven("pressure_offset", values, trial);
  // A vacuum is what is below ambient: a sensor that reads too high hides some of it.
  EXPECT_TRUE(series.inputs.col(9).isApprox(Eigen::Vector4d(9900.0, 20200.0, 29700.0, 60400.0), 1e-12));
  EXPECT_EQ(series.inputs, series.moment_inputs);
}

TEST(PressureLeak, IsSteadyOrGrowsInHolds) {
  // Stairs between frames, as of a slower regulator, and noise.
  const model::TrialData trial = made_up(
      arm(), 20.0,
      [](double t_s) {
        const double t = std::floor(t_s * 50.0) / 50.0;
        const double up = std::clamp(t - 3.0, 0.0, 2.0), down = std::clamp(t - 15.0, 0.0, 2.0);
        const double noise = 8.0 * std::sin(12345.6 * t_s);
        return Eigen::Vector4d(2e4 + 5e3 * (up - down) + noise, 2e4, 0.0, 0.0);
      },
      0.0, 120.0, 0.05);
  const model::Series steady = driven("pressure_leak", Eigen::Vector4d(0.05, 1.0, 0.0, 5.0), trial);
  EXPECT_TRUE(steady.inputs.row(0).isApprox(0.95 * trial.series.inputs.row(0), 1e-12));
  EXPECT_EQ(steady.inputs.row(1), trial.series.inputs.row(1));
  const model::Series all = driven("pressure_leak", Eigen::Vector4d(0.05, 0.0, 0.0, 5.0), trial);
  EXPECT_TRUE(all.inputs.topRows(3).isApprox(0.95 * trial.series.inputs.topRows(3), 1e-12));

  const model::Series in_holds = driven("pressure_leak", Eigen::Vector4d(0.05, 1.0, 1.0, 2.0), trial);
  const auto lost = [&](double t_s) {
    const auto i = static_cast<Eigen::Index>(t_s * 120.0);
    return 1.0 - in_holds.inputs(0, i) / trial.series.inputs(0, i);
  };
  EXPECT_NEAR(lost(2.5), 0.05, 1e-4);  // long settled
  EXPECT_NEAR(lost(4.5), 0.0, 2e-4);   // made up for while it moves
  EXPECT_NEAR(lost(5.15 + 2.0), 0.05 * (1.0 - std::exp(-1.0)), 3e-3);
  EXPECT_NEAR(lost(14.5), 0.05, 1e-3);
  EXPECT_NEAR(lost(16.5), 0.0, 2e-4);
}

TEST(StiffnessAndLength, FollowTheMeanPressureAndTheVacuum) {
  model::ExtendedModel model(arm());
  const model::TrialData trial =
      made_up(arm(), 1.0, [](double) { return Eigen::Vector4d(15e3, 30e3, 30e3, 40e3); });
  const std::vector<model::Predicted> without = predict(model, arm(), {}, trial);
  const auto ratio = [&](const std::string& id, double size, rod::ParameterKind kind) {
    const std::vector<model::Predicted> with =
        predict(model, arm(), {{find(id), Eigen::VectorXd::Constant(1, size)}}, trial);
    for (std::size_t k = 0; k < model.rod().parameters().size(); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      const rod::Parameter& parameter = model.rod().parameters()[k];
      if (parameter.kind == kind && parameter.index == 4 &&
          parameter.component == (kind == rod::ParameterKind::kMoment))
        return with[0].values[i] / without[0].values[i];
    }
    return 0.0;
  };
  using rod::ParameterKind;
  EXPECT_NEAR(ratio("pressure_stiffening", 0.2, ParameterKind::kBendingCompliance), 1.0 / 1.1, 1e-9);
  EXPECT_NEAR(ratio("radial_expansion", 0.2, ParameterKind::kBendingCompliance), 1.0 / 1.21, 1e-9);
  EXPECT_NEAR(ratio("pressure_elongation", 0.04, ParameterKind::kLength), 1.02, 1e-9);
  EXPECT_NEAR(ratio("vacuum_shortening", 0.03, ParameterKind::kLength), 0.98, 1e-9);
  EXPECT_NEAR(ratio("vacuum_gain", 0.3, ParameterKind::kMoment), 0.8, 1e-9);
  for (const char* id :
       {"pressure_stiffening", "radial_expansion", "pressure_elongation", "vacuum_shortening"})
    EXPECT_NEAR(ratio(id, 0.2, ParameterKind::kMoment), 1.0, 1e-12) << id;
}

TEST(RadialExpansion, MovesMarkersOnTheSkinOutwards) {
  arm::Arm with_marker = arm();
  arm::MeasuredBody marker = with_marker.bodies[0];
  marker.kind = arm::BodyKind::kSkinMarker;
  marker.angle_rad = 0.7;
  marker.radius_m = 0.02;
  with_marker.bodies.push_back(marker);
  model::ExtendedModel model(with_marker);
  const model::TrialData trial =
      made_up(with_marker, 1.0, [](double) { return Eigen::Vector4d(25e3, 25e3, 25e3, 0.0); });
  const std::vector<model::Predicted> with =
      predict(model, with_marker, {{find("radial_expansion"), Eigen::VectorXd::Constant(1, 0.1)}}, trial);
  const Eigen::Vector3d out = with[0].p.col(3) - with[0].p.col(0);
  EXPECT_NEAR(out.norm(), 0.02 * 1.05, 1e-9);
}

TEST(OfTheInputs, ActInTheCataloguesOrderWhateverTheirs) {
  model::ExtendedModel model(arm());
  const model::TrialData trial = made_up(arm(), 3.0, triangles(arm(), kChamber1, 20e3, 1.0));
  const model::Present lag{find("pressure_lag"), Eigen::Vector4d(0.2, 0.2, 1.0, 0.0)};
  const model::Present zone{find("pressure_dead_zone"), Eigen::Vector3d(4000.0, 4000.0, 0.0)};
  const std::vector<model::Predicted> a = predict(model, arm(), {lag, zone}, trial);
  const std::vector<model::Predicted> b = predict(model, arm(), {zone, lag}, trial);
  EXPECT_EQ(positions(a), positions(b));
}

}  // namespace
}  // namespace softarm::effects::testing
